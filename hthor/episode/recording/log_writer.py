"""Writes the log of a trial while it runs: events, paths, rest times, and what people's recorders see."""

from collections.abc import Collection, Mapping, Sequence

from msgspec import Struct

from hthor import rules
from hthor.episode.recording.episode_log import EpisodeLog, Fault
from hthor.episode.recording.rest_time import RestState, RestTime
from hthor.episode.trial_world import TrialWorld
from hthor.humans.core.behaviour_log import BehaviourRecorder, RecorderState
from hthor.humans.core.recorded_inputs import InputRecorder, InputState
from hthor.types import HUMAN, BodySpec, Motion, Pose, is_person
from hthor.types.events import Acted, Event, JournalEntry, Success, Timeout, Voided

_THOUSAND = 1000.0
"""Millimetres in a metre, milliradians in a radian."""


class LogState(Struct, frozen=True, kw_only=True):
    """A copy of everything that was written, from `LogWriter.save_state`."""

    events: tuple[Event, ...]
    faults: tuple[Fault, ...]
    paths: dict[str, tuple[tuple[int, int, int], ...]]
    rest: RestState
    recorders: dict[str, RecorderState]
    inputs: dict[str, InputState]


class LogWriter:
    """The log of one trial as far as it has come.

    Args:
        bodies: those of the seats that take part.
        robots: the robots whose actions belong in the journal, because deciding takes them time that no log repeats.

    Attributes:
        events, faults: as in `EpisodeLog`; the episode appends to them. rest: how long each body has rested.
    """

    def __init__(self, bodies: Mapping[str, BodySpec], robots: Collection[str] = ()) -> None:
        self.events: list[Event] = []
        self.faults: list[Fault] = []
        self.rest = RestTime(bodies)
        self._paths: dict[str, list[tuple[int, int, int]]] = {seat: [] for seat in bodies}
        self._traced: dict[str, Pose] = {}  # where each body was when it was traced last
        self._recorders = {
            seat: BehaviourRecorder(seat, body, rules.TICK_S) for seat, body in bodies.items() if is_person(seat)
        }
        self._inputs = {seat: InputRecorder(seat) for seat in bodies if is_person(seat) or seat in robots}

    def trace(self, world: TrialWorld) -> None:
        """Add the bodies' poses to their paths, every `rules.LOG_EVERY_TICKS` ticks."""
        if world.tick % rules.LOG_EVERY_TICKS:
            return
        for seat, path in self._paths.items():
            pose = world.pose(seat)
            if pose is self._traced.get(seat):  # the body has not moved
                path.append(path[-1])
                continue
            self._traced[seat] = pose
            path.append((round(pose.x * _THOUSAND), round(pose.y * _THOUSAND), round(pose.gaze * _THOUSAND)))
            if (recorder := self._recorders.get(seat)) is not None:
                recorder.head(world.tick, pose.pitch)

    def note_motion(self, tick: int, step: int, seat: str, motion: Motion, *, started: bool) -> None:
        """Note a motion that begins at a step of a tick; ``started`` is false if the body is still free after it."""
        if (recorder := self._recorders.get(seat)) is not None:
            recorder.motion(tick, motion)
        if (inputs := self._inputs.get(seat)) is not None:
            inputs.motion(tick, step, motion)
        self.rest.note_motion(tick, seat, motion, started=started)

    def note_action(self, acted: Acted) -> None:
        """Note an action of a seat whose actions are recorded."""
        self._inputs[acted.seat].action(acted)

    def records(self, seat: str) -> bool:
        """Whether the seat's actions are recorded."""
        return seat in self._inputs

    def log(
        self,
        tick: int,
        end: Event | None,
        progress: float | None,
        ratings: Mapping[str, int | None],
        journals: Mapping[str, Sequence[JournalEntry]],
    ) -> EpisodeLog:
        """The log up to this tick, with the last event ``end`` if the trial is over."""
        events = (*self.events, *(() if end is None else (end,)))
        journal: list[JournalEntry] = []
        for seat, inputs in self._inputs.items():
            if (recorder := self._recorders.get(seat)) is None:
                journal += inputs.entries()
            else:
                journal += recorder.journal(journals.get(seat, ()), events, inputs.entries() if inputs.drove else ())
        return EpisodeLog(
            events=events,
            paths={seat: list(path) for seat, path in self._paths.items()},
            ticks=tick,
            met=isinstance(end, Success),
            ratings=dict(ratings),
            faults=tuple(self.faults),
            progress=progress,
            idle=self.rest.totals(tick),
            journal=tuple(journal),
        )

    def save_state(self) -> LogState:
        """A copy of everything that was written."""
        return LogState(
            events=tuple(self.events),
            faults=tuple(self.faults),
            paths={seat: tuple(path) for seat, path in self._paths.items()},
            rest=self.rest.save_state(),
            recorders={seat: recorder.save_state() for seat, recorder in self._recorders.items()},
            inputs={seat: recorder.save_state() for seat, recorder in self._inputs.items()},
        )

    def load_state(self, state: LogState) -> None:
        """Continue from a copy."""
        self.events[:], self.faults[:] = state.events, state.faults
        self._paths = {seat: list(path) for seat, path in state.paths.items()}
        self._traced = {}
        self.rest.load_state(state.rest)
        for seat, recorder in self._recorders.items():
            recorder.load_state(state.recorders[seat])
        for seat, inputs in self._inputs.items():
            inputs.load_state(state.inputs[seat])


def end_event(tick: int, winner: str, voided: str) -> Event:
    """The last event of a trial; ``winner`` found the object or stands for the team, and is empty without success."""
    if voided:
        return Voided(tick=tick, seat=HUMAN, reason=voided)
    return Success(tick=tick, seat=winner) if winner else Timeout(tick=tick, seat=HUMAN)
