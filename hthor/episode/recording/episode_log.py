"""The log of one trial, from which its record and its metrics are made."""

from msgspec import Struct

from hthor.types.events import Event, JournalEntry, Voided


class Fault(Struct, frozen=True, kw_only=True):
    """The failure of an agent at ``tick``; the trial went on without it. ``detail`` has its traceback or its error."""

    seat: str
    kind: str
    tick: int
    detail: str


class EpisodeLog(Struct, frozen=True, kw_only=True):
    """The log of one trial.

    Attributes:
        events: what happened, in order; docs/logs.md lists the kinds of events.
        paths: for each seat, (x, y, yaw) every `rules.LOG_EVERY_TICKS` ticks from tick 0, house frame, in whole
            millimetres and milliradians.
        ticks: the trial's length, with all its phases; `hthor.episode.task_part` is the task itself.
        met: whether the goal was met.
        ratings: each person's rating of trust in the robots, 1 to 7, by seat; None without a robot.
        faults: failures of agents.
        progress: the share of the goal that is met at the end, from 0 to 1; None for task kinds without partial goals.
            Every change of it is an event "progress" with the new ``value``.
        idle: for how many ticks of the task itself each seat's body carried out no motion, or only waited.
        journal: entries from the human's recorder and model: stick, pitch, attempts, glimpses and choices, see
            `hthor.types.events.journal`.
    """

    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    ticks: int
    met: bool
    ratings: dict[str, int | None]
    faults: tuple[Fault, ...]
    progress: float | None = None
    idle: dict[str, int] = {}
    journal: tuple[JournalEntry, ...] = ()

    @property
    def voided(self) -> str:
        """Why the trial was voided and does not count; empty if it counts."""
        last = self.events[-1] if self.events else None
        return last.reason if isinstance(last, Voided) else ""
