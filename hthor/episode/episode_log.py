"""What one trial leaves behind; a trial's record and its metrics are made from it."""

from msgspec import Struct

from hthor.types import Event


class Fault(Struct, frozen=True, kw_only=True):
    """An agent failed at ``tick``, and the trial went on without it. ``detail`` is its traceback or what it did."""

    seat: str
    kind: str
    tick: int
    detail: str


class EpisodeLog(Struct, frozen=True, kw_only=True):
    """What one trial leaves behind.

    Attributes:
        events: what happened, in order; docs/logs.md lists the kinds of events.
        paths: for each seat and every `rules.LOG_EVERY_TICKS` ticks from tick 0, (x, y, yaw) in the house's frame, in
            whole millimetres and milliradians.
        ticks: the trial's length.
        met: the goal was met.
        trust: the participant's rating, None without a robot.
        faults: failures of agents.
        progress: the share of the goal that is met in the end, from 0 to 1; None where the task kind counts no parts.
            Whenever it changes there is an event "progress" with its ``value``.
        idle: for how many ticks each seat's body carried out no motion, or only waited.
        journal: what the human's recorder and model add: stick, pitch, attempts, glimpses and choices, as
            `hthor.humans.core.behaviour_log` lists them.
    """

    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    ticks: int
    met: bool
    trust: int | None
    faults: tuple[Fault, ...]
    progress: float | None = None
    idle: dict[str, int] = {}
    journal: tuple[Event, ...] = ()
