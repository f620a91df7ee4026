"""One participant's session in the simulated world, of which only the outcomes are kept.

A person is drawn from the population at a point of the prior's cube, as `hthor.humans.population.participant` draws
people, and does ten tasks one after the other with the robot of a condition, or without one.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import msgspec
from msgspec import Struct

from hthor import plugins, rules
from hthor.episode import EpisodeLog, task_part
from hthor.errors import HthorError
from hthor.eval.runner.messages import TrialOutcome
from hthor.humans.models.proxy import Model
from hthor.humans.population import parameter_registry
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant, add_random_effects, participant_root
from hthor.tasks import Suite
from hthor.trials import Participants, Sources, TrialRunner
from hthor.trials.sessions import StudySetup, make_setup
from hthor.types import HUMAN, TrialSpec
from hthor.types.events import Picked, Sent

CODE_ROOT = "sessions"

_FIRST = ("sent", "shown", "accepted", "declined", "picked")
OUTCOMES = ("task", "met", "ticks", *_FIRST, "messages", "adopted", "trust")
"""The outcomes that are kept of a trial, in order; see `hthor.calibration.simulation.trial_table.Table`."""

OutcomeRow = tuple[int, ...]


class SessionSpec(Struct, frozen=True, kw_only=True):
    """A session to run: person ``participant`` of the study with this seed, from the population at a ``point``.

    ``key`` is a hash of everything that decides its course; ``condition`` is 0 none, 1 frontier, 2 oracle; ``tasks``
    are the tasks' numbers in the suite, in the order of the trials.
    """

    key: str
    seed: int
    participant: int
    point: tuple[float, ...]
    condition: int
    tasks: tuple[int, ...]

    @property
    def number(self) -> int:
        """The session's number, by which workers report it: the participant's."""
        return self.participant


class SessionOutcome(Struct, frozen=True, kw_only=True):
    """The outcome of a session: a row of `OUTCOMES` per trial. Without a key, it reports a single trial."""

    key: str = ""
    rows: tuple[OutcomeRow, ...]
    met: bool = False
    faults: tuple[str, ...] = ()


def make_session_runner(
    suite: Suite, agents: Sequence[str], robot: str
) -> Callable[[SessionSpec], Iterator[TrialOutcome]]:
    """A function that runs sessions in a worker, with each condition's agent: it reports each trial, then the session.

    The function is called in the worker; it keeps worlds for later sessions.
    """
    kinds = sorted({task.kind for task in suite.tasks})
    setups = [make_setup(kinds, agent=agent, robot=robot) for agent in agents]
    runner = TrialRunner(Sources(houses=str(suite.houses.folder or "")))

    def run(spec: SessionSpec) -> Iterator[TrialOutcome]:
        rows = []
        for row in run_session(spec, suite, setups[spec.condition], runner):
            rows.append(row)
            yield _message(SessionOutcome(rows=(row,)))
        yield _message(SessionOutcome(key=spec.key, rows=tuple(rows)))

    return run


def _message(outcome: Any) -> TrialOutcome:
    """A worker's message; it is only encoded, so its ``record`` may be something other than a trial's record."""
    return TrialOutcome(record=outcome)


def run_session(spec: SessionSpec, suite: Suite, setup: StudySetup, runner: TrialRunner) -> Iterator[OutcomeRow]:
    """Run a session from its first trial to its last; yields a row of `OUTCOMES` per trial."""
    setup = msgspec.structs.replace(setup, seed=spec.seed)
    trials = setup.session(spec.participant, [suite.tasks[number] for number in spec.tasks]).trials
    logs = run_trials(trials, parameter_registry.parameters_at(spec.point), runner)
    for number, trial, log in zip(spec.tasks, trials, logs, strict=True):
        if log.faults:
            raise HthorError(f"the {log.faults[0].seat} failed in {trial.task.id}: {log.faults[0].detail.strip()}")
        yield outcome_row(number, trial, log)


def run_trials(trials: Sequence[TrialSpec], population: Parameters, runner: TrialRunner) -> Iterator[EpisodeLog]:
    """Run the trials of one session with a person drawn from the population; yields the log of each."""
    seed, participant = trials[0].seed, trials[0].humans[0].participant
    traits = add_random_effects(population, participant_root(seed, participant))
    human = Model(Participant(seed=seed, number=participant, traits=traits))
    participants = Participants({HUMAN: human}, trials[0].robots, lambda seat: plugins.load("agent", seat.agent.name)())
    for trial in trials:
        yield runner.run(participants, trial).log


def outcome_row(number: int, trial: TrialSpec, log: EpisodeLog) -> OutcomeRow:
    """The `OUTCOMES` of a trial; ``number`` is the number of its task in the suite."""
    log = task_part(log)
    first: dict[str, int] = {}
    messages, target = 0, trial.task.goal.target
    for event in log.events:
        messages += isinstance(event, Sent)
        if not isinstance(event, Picked) or (event.seat == HUMAN and event.object == target):
            first.setdefault(event.kind, event.tick)
    ticks = log.ticks if log.met else round(trial.task.time_limit / rules.TICK_S)
    ticks_of_first = [first.get(kind, -1) for kind in _FIRST]
    return (number, int(log.met), ticks, *ticks_of_first, messages, int("accepted" in first), log.ratings[HUMAN] or 0)
