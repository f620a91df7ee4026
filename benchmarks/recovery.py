"""``python -m benchmarks.recovery``: are people's parameters found again in their logs? Some ten minutes of one core.

Populations are drawn from the prior; of each, a dozen simulated people do ten tasks that are logged as usual, a third
of them without a robot, a third with the frontier robot, a third with the oracle. The estimators read their logs.
Printed is how true and estimated values correlate, and how many of the 90 % intervals held the truth.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct

from hthor import code_identity, seeds, tasks
from hthor.calibration.from_logs import estimate_all, trial_features
from hthor.calibration.from_logs.estimate_all import READING
from hthor.calibration.from_logs.models import priors
from hthor.calibration.from_logs.models.priors import to_scale
from hthor.calibration.simulation import design_points
from hthor.calibration.simulation.session_simulation import run_trials
from hthor.calibration.simulation.trial_table import AGENTS
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.population import parameter_registry
from hthor.humans.population.parameters import Parameters
from hthor.tasks import Suite
from hthor.trials import Sources, TrialRunner
from hthor.trials.sessions import make_sessions

BARS = {"v_pace": 0.8, "omega": 0.8, "t_manip": 0.8, "mu0": 0.8, READING: 0.6, "a0": 0.6}
"""The least correlation between true and estimated values, over populations drawn from the prior."""


class Dataset(Struct, frozen=True, kw_only=True):
    """A population of the prior and the estimates of its parameters, on the scale of their errors."""

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


def run_recovery(
    count: int, *, people: int = 12, seed: int = 0, suite: str = "paper", first: int = 0
) -> Iterator[Dataset]:
    """Simulate datasets and estimate each."""
    played = tasks.load_suite(suite)
    runner = TrialRunner(Sources(houses=str(played.houses.folder or "")))
    points = design_points.sobol_points(
        first + count, len(parameter_registry.free_parameter_names()), seed, "recovery"
    )[first:]
    for number, point in enumerate(points, first):
        population = parameter_registry.parameters_at(tuple(map(float, point)))
        records = simulate_logs(population, played, runner, seeds.derive(seed, "dataset", number), people)
        yield estimate_dataset(population, records)


def simulate_logs(
    population: Parameters, suite: Suite, runner: TrialRunner, seed: int, people: int
) -> list[TrialRecord]:
    """The records of some people of a population."""
    sessions = {agent: make_sessions(suite, agent=agent, seed=seed, participants=people) for agent in AGENTS}
    records: list[TrialRecord] = []
    for number in range(people):
        trials = sessions[AGENTS[number % len(AGENTS)]][number].trials
        logs = run_trials(trials, population, runner)
        records += [trial_record.make_record(trial, log) for trial, log in zip(trials, logs, strict=True)]
    return records


def estimate_dataset(population: Parameters, records: Sequence[TrialRecord]) -> Dataset:
    """The estimates from these records, and the truth."""
    prior = priors.prior_beliefs()
    estimates = estimate_all.estimate_parameters(trial_features.sessions_of(records), prior)
    truth = {name: float(to_scale(getattr(population, name), belief.scale)) for name, belief in prior.items()}
    truth[READING] = float(np.log(population.t_notice + population.t_read))
    return Dataset(
        truth=truth, found={one.name: one.at for one in estimates}, errors={one.name: one.se for one in estimates}
    )


def summarize_recovery(datasets: Sequence[Dataset]) -> tuple[Recovered, ...]:
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


def main() -> None:
    """Simulate, estimate, print; exit code 1 when a bar is missed."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.recovery", description=__doc__.splitlines()[0])
    options.add_argument("--datasets", type=int, default=32, help="how many populations (%(default)s)")
    options.add_argument(
        "--first", type=int, default=0, help="number of the first, for several processes (%(default)s)"
    )
    options.add_argument("--people", type=int, default=12, help="people of each (%(default)s)")
    options.add_argument("--suite", default="paper", help="the tasks they do (%(default)s)")
    options.add_argument("--seed", type=int, default=0)
    given = options.parse_args()
    code_identity.keep_compiled()
    datasets = []
    for dataset in run_recovery(
        given.datasets, people=given.people, seed=given.seed, suite=given.suite, first=given.first
    ):
        datasets.append(dataset)
        print(f"{len(datasets)} of {given.datasets} datasets", file=sys.stderr)
    rows = summarize_recovery(datasets)
    print(f"{'parameter':12} {'r':>6} {'covered':>8} {'datasets':>9}  bar")
    for row in rows:
        verdict = "" if row.bar is None else f"{row.bar:.1f} {'met' if row.passed else 'MISSED'}"
        print(f"{row.name:12} {row.r:6.3f} {row.covered:8.2f} {row.datasets:9d}  {verdict}")
    if not all(row.passed for row in rows):
        sys.exit(1)


if __name__ == "__main__":
    main()
