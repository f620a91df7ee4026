"""One person's session in the real world, played for its outcomes alone.

A person is drawn from the population at a point of the prior's cube, as `hthor.humans.population.random_effects`
draws people, and plays ten tasks one after the other with the robot of a condition, or without one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from msgspec import Struct

from hthor import plugins, rules
from hthor.episode import EpisodeLog, run_episode
from hthor.errors import HthorError
from hthor.eval.runner.messages import TrialOutcome
from hthor.eval.runner.sources import Sources
from hthor.eval.runner.trial_runner import TrialRunner
from hthor.humans.models.proxy import Model
from hthor.humans.population import parameter_registry, random_effects
from hthor.humans.population.participant import Participant, participant_root
from hthor.tasks import Suite
from hthor.types import HUMAN, RobotSeat, TaskSpec, TrialSpec

OUTCOMES = (
    "task",
    "met",
    "ticks",
    "sent",
    "shown",
    "confirmed",
    "declined",
    "picked",
    "messages",
    "adopted",
    "trust",
)

CODE_ROOT = "sessions"
"""What is kept of a trial, in order; see `hthor.calibration.simulation.trial_table.Table`."""

Row = tuple[int, ...]


class SessionSpec(Struct, frozen=True, kw_only=True):
    """A session to be played.

    Attributes:
        key: its name, a hash of all that decides its course.
        seed: of the study whose participant number ``participant`` the person is.
        point: of the prior's unit cube: the population that the person comes from.
        condition: 0 none, 1 frontier, 2 oracle. tasks: numbers in the suite, in the order of the trials.
    """

    key: str
    seed: int
    participant: int
    point: tuple[float, ...]
    condition: int
    tasks: tuple[int, ...]


class SessionOutcome(Struct, frozen=True, kw_only=True):
    """A session that was played: a row of `OUTCOMES` for each trial. One without a key tells of a single trial."""

    key: str = ""
    rows: tuple[Row, ...]
    met: bool = False
    faults: tuple[str, ...] = ()


def player(suite: Suite, seats: tuple[tuple[RobotSeat, ...], ...]) -> Callable[[SessionSpec], Iterator[TrialOutcome]]:
    """What a worker does with each sitting: tell of each trial, and in the end of the session.

    Called in the worker; keeps worlds for later sittings.

    Args:
        seats: the robots of each condition.
    """
    stage = TrialRunner(Sources(houses=str(suite.houses.folder or "")))

    def perform(sitting: SessionSpec) -> Iterator[TrialOutcome]:
        rows = []
        for row in sit(sitting, suite, seats[sitting.condition], stage):
            rows.append(row)
            yield _outcome(SessionOutcome(rows=(row,)))
        yield _outcome(SessionOutcome(key=sitting.key, rows=tuple(rows)))

    return perform


def _outcome(session: Any) -> TrialOutcome:
    """What workers send; they only encode it, so it need not be a trial's record."""
    return TrialOutcome(record=session)


def sit(sitting: SessionSpec, suite: Suite, seats: tuple[RobotSeat, ...], stage: TrialRunner) -> Iterator[Row]:
    """Play a session from its first trial to its last; a row of `OUTCOMES` for each."""
    chances = participant_root(sitting.seed, sitting.participant)
    traits = random_effects.add_random_effects(parameter_registry.parameters_at(sitting.point), chances)
    human = Model(Participant(seed=sitting.seed, number=sitting.participant, traits=traits))
    minds = {seat.seat: plugins.load("agent", seat.agent.name)() for seat in seats}
    for index, number in enumerate(sitting.tasks):
        trial = _trial(sitting, suite.tasks[number], seats, index)
        log = run_episode(trial, stage.world(trial), human, minds)
        if log.faults:
            raise HthorError(f"the {log.faults[0].seat} failed in {trial.task.id}: {log.faults[0].detail.strip()}")
        yield _row(number, trial, log)


def _trial(sitting: SessionSpec, task: TaskSpec, seats: tuple[RobotSeat, ...], index: int) -> TrialSpec:
    return TrialSpec(
        task=task,
        robots=seats,
        human="proxy",
        human_sha256="",
        participant=sitting.participant,
        index=index,
        seed=sitting.seed,
        suite_sha256="",
        rules_sha256="",
        code_sha256="",
    )


def _row(number: int, trial: TrialSpec, log: EpisodeLog) -> Row:
    first: dict[str, int] = {}
    messages, target = 0, trial.task.goal.target
    for event in log.events:
        kind = event.kind
        messages += kind == "sent"
        if kind != "picked" or (event.seat == HUMAN and event.data.get("object") == target):
            first.setdefault(kind, event.tick)
    ticks = log.ticks if log.met else round(trial.task.time_limit / rules.TICK_S)
    known = [first.get(kind, -1) for kind in ("sent", "shown", "confirmed", "declined", "picked")]
    return (number, int(log.met), ticks, *known, messages, int("confirmed" in first), log.trust or 0)
