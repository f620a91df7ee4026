"""Do the estimators find what is known? ParticipantSource of known parameters, their logs, and what is read off these.

Each dataset is one population drawn from the prior and some of its people, a third of them without a robot, a third
with the frontier robot, a third with the oracle; everybody does ten tasks in the real world and leaves a real log.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct

from hthor import plugins, seeds, tasks
from hthor.calibration.from_logs import estimate_all, load_sessions
from hthor.calibration.from_logs.estimate_all import READING
from hthor.calibration.from_logs.models import priors
from hthor.calibration.from_logs.models.priors import on
from hthor.calibration.simulation import design_points
from hthor.calibration.simulation.trial_table import AGENTS
from hthor.episode import run_episode
from hthor.eval.config.sessions import Session
from hthor.eval.config.sessions import make_sessions as deal
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import trial_runner
from hthor.eval.runner.sources import Sources
from hthor.humans.models.proxy import Model
from hthor.humans.population import parameter_registry, random_effects
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant, participant_root
from hthor.tasks import Suite

BARS = {"v_pace": 0.8, "omega": 0.8, "t_manip": 0.8, "mu0": 0.8, READING: 0.6, "a0": 0.6}
"""The least correlation between true and estimated values, over populations drawn from the prior."""


class Dataset(Struct, frozen=True, kw_only=True):
    """A population of the prior and what was estimated of it, on the scale of each parameter's errors."""

    truth: dict[str, float]
    found: dict[str, float]
    errors: dict[str, float]


class Recovered(Struct, frozen=True, kw_only=True):
    """One parameter over many datasets: the correlation ``r`` of true and estimated values, how many of the 90 %
    intervals held the truth (``covered``), and the ``bar`` for r, None where there is none.
    """

    name: str
    r: float
    covered: float
    datasets: int
    bar: float | None = None

    @property
    def passed(self) -> bool:
        """Whether the bar was met."""
        return self.bar is None or self.r >= self.bar


def run(count: int, *, people: int = 12, seed: int = 0, suite: str = "paper", first: int = 0) -> Iterator[Dataset]:
    """Simulate datasets and estimate each."""
    held = tasks.load_suite(suite)
    stage = trial_runner.TrialRunner(Sources(houses=str(held.houses.folder or "")))
    cube = design_points.spread(first + count, len(parameter_registry.free_parameter_names()), seed, "recovery")[first:]
    for number, point in enumerate(cube, first):
        population = parameter_registry.parameters_at(tuple(map(float, point)))
        yield estimated(population, logs(population, held, stage, seeds.derive(seed, "dataset", number), people))


def logs(
    population: Parameters, suite: Suite, stage: trial_runner.TrialRunner, seed: int, people: int
) -> list[TrialRecord]:
    """The records of some people of a population."""
    dealt = {agent: deal(suite, agent=agent, seed=seed, participants=people) for agent in AGENTS}
    played: list[TrialRecord] = []
    for number in range(people):
        played += _session(population, dealt[AGENTS[number % len(AGENTS)]][number], stage, seed)
    return played


def estimated(population: Parameters, records: Sequence[TrialRecord]) -> Dataset:
    """What the estimators make of these records, beside the truth."""
    prior = priors.of_registry()
    estimates = estimate_all.everything(load_sessions.of(records), prior)
    truth = {name: float(on(getattr(population, name), belief.scale)) for name, belief in prior.items()}
    truth[READING] = float(np.log(population.t_notice + population.t_read))
    return Dataset(
        truth=truth,
        found={one.name: one.at for one in estimates},
        errors={one.name: one.se for one in estimates},
    )


def summary(datasets: Sequence[Dataset]) -> tuple[Recovered, ...]:
    """How well each parameter was recovered."""
    found = []
    for name in datasets[0].truth:
        pairs = [(d.truth[name], d.found[name], d.errors[name]) for d in datasets if name in d.found]
        if len(pairs) > 2:
            truth, value, error = np.array(pairs).T
            r = float(np.corrcoef(truth, value)[0, 1]) if value.std() > 0.0 else 0.0
            covered = float(np.mean(np.abs(value - truth) <= 1.6449 * error))
            found.append(Recovered(name=name, r=r, covered=covered, datasets=len(pairs), bar=BARS.get(name)))
    return tuple(found)


def _session(
    population: Parameters, session: Session, stage: trial_runner.TrialRunner, seed: int
) -> Iterator[TrialRecord]:
    traits = random_effects.add_random_effects(population, participant_root(seed, session.participant))
    human = Model(Participant(seed=seed, number=session.participant, traits=traits))
    minds = {seat.seat: plugins.load("agent", seat.agent.name)() for seat in session.trials[0].robots}
    for trial in session.trials:
        yield trial_record.make_record(trial, run_episode(trial, stage.world(trial), human, minds))
