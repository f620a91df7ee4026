"""Records what a person did in a trial, and puts the journal together; `hthor.types.events.journal` lists the kinds.

The episode records stick and head for every human model, and of people who drive everything that they did, so that the
trial can be repeated from it; only some human models record more.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeGuard

import msgspec
from msgspec import UNSET, Struct

from hthor.types import BodySpec, Drive, Motion, Move, Rotate, Wait
from hthor.types.events import (
    Acted,
    Attempt,
    Closed,
    Dropped,
    Event,
    Head,
    Inputs,
    JournalEntry,
    LogEntry,
    Opened,
    Picked,
    Placed,
    Stick,
)

_THOUSAND = 1000
"""[count] Steps per full deflection of the stick, and per radian of pitch. Our choice."""
_DONE: dict[str, type[LogEntry]] = {
    "pick": Picked,
    "place": Placed,
    "open": Opened,
    "close": Closed,
    "drop": Dropped,
}
"""The event in the trial's log for each kind of attempt that succeeds."""

INPUT_UNIT = 1e-4
"""[m/s, rad] The unit of the set-points in the journal. Our choice: finer than any stick or headset measures."""


class RecorderState(Struct, frozen=True, kw_only=True):
    """A copy of what a `BehaviourRecorder` recorded."""

    stick: tuple[int, ...]
    pitch: tuple[int, ...]
    inputs: tuple[int, ...]
    held: tuple[int, ...]
    acted: tuple[Acted, ...]


class BehaviourRecorder:
    """Records one trial of one body; stick and pitch as run lengths, where full deflection gives the body's speed."""

    def __init__(self, seat: str, body: BodySpec, tick_s: float) -> None:
        self.seat, self.body, self.tick_s, self._step = seat, body, tick_s, body.speed * tick_s
        self._stick: list[int] = [0, 0]
        self._pitch: list[int] = []
        self._inputs: list[int] = []
        self._held: list[int] = []  # the set-point that the body drives by
        self._acted: list[Acted] = []

    def motion(self, tick: int, motion: Motion, step: int = 0) -> None:
        """Record a motion that begins at ``tick``, for a `Drive` after ``step`` of the tick's steps."""
        deflection = 0
        if isinstance(motion, Move):
            share = math.hypot(motion.forward, motion.left) / self._step
            deflection = round(_THOUSAND * min(1.0, share)) if math.isfinite(share) else 0
        elif isinstance(motion, Drive):
            share = math.hypot(motion.forward, motion.left) / self.body.speed
            deflection = round(_THOUSAND * min(1.0, share))
            self._record_inputs(tick, step, motion)
        if isinstance(motion, (Move, Rotate, Wait)):
            self._held = []
        stick = self._stick
        if stick[-1] != deflection:
            stick += (tick, deflection)

    def _record_inputs(self, tick: int, step: int, drive: Drive) -> None:
        numbers = [round(value / INPUT_UNIT) for value in (drive.forward, drive.left, drive.yaw, drive.pitch)]
        if self._held != numbers:
            self._inputs += (tick, step, *numbers)
            self._held = numbers

    def action(self, acted: Acted) -> None:
        """Record an action."""
        before = self._acted[-1] if self._acted else None
        if before is not None and (before.tick, before.early) == (acted.tick, acted.early):  # in the very same step
            say, signals = acted.say or before.say, before.signals + acted.signals
            self._acted[-1] = msgspec.structs.replace(acted, say=say, signals=signals)
        else:
            self._acted.append(acted)

    def head(self, tick: int, pitch: float) -> None:
        """Record the ``pitch`` [rad] of the head."""
        tilt = round(_THOUSAND * pitch)
        if not self._pitch or self._pitch[-1] != tilt:
            self._pitch += (tick, tilt)

    def journal(self, own: Iterable[JournalEntry], events: Iterable[Event]) -> tuple[JournalEntry, ...]:
        """The whole journal: the human model's own entries, with successes from the trial's log (``events``)."""
        stick = Stick(tick=0, seat=self.seat, full=self.body.speed, runs=tuple(self._stick))
        head = Head(tick=0, seat=self.seat, fastest=self.body.turn_rate, pitch=tuple(self._pitch))
        done = [event for event in events if event.seat == self.seat and isinstance(event, tuple(_DONE.values()))]
        written = list(own)
        tried = [entry.tick for entry in written if isinstance(entry, Attempt)]
        ended = (self._completed(entry, done, tried) if _is_open(entry) else entry for entry in written)
        return (stick, head, *(self.inputs() if self._inputs else ()), *ended)

    def inputs(self) -> tuple[Inputs | Acted, ...]:
        """Everything that the body was made to do, from which the trial can be repeated."""
        inputs = (Inputs(tick=0, seat=self.seat, runs=tuple(self._inputs)),) if self._inputs else ()
        return (*inputs, *self._actions())

    def save_state(self) -> RecorderState:
        """A copy of what was recorded."""
        return RecorderState(
            stick=tuple(self._stick),
            pitch=tuple(self._pitch),
            inputs=tuple(self._inputs),
            held=tuple(self._held),
            acted=tuple(self._acted),
        )

    def load_state(self, state: RecorderState) -> None:
        """Continue from a copy."""
        self._stick, self._pitch, self._inputs = list(state.stick), list(state.pitch), list(state.inputs)
        self._held, self._acted = list(state.held), list(state.acted)

    def _actions(self) -> Iterator[Acted]:
        """The actions without those that are mere set-points, which the inputs have; unless one replaced a motion."""
        of_tick = Counter(acted.tick for acted in self._acted)
        for acted in self._acted:
            timely = acted.seen is UNSET or acted.seen == acted.tick
            silent = acted.say is None and not acted.signals
            if not (isinstance(acted.motion, Drive) and timely and silent and of_tick[acted.tick] == 1):
                yield acted

    def _completed(self, attempt: Attempt, done: Sequence[Event], tried: Sequence[int]) -> Attempt:
        """The attempt, with its success if that is in ``done`` before the next attempt (``tried``: all ticks)."""
        last = min((tick for tick in tried if tick > attempt.tick), default=math.inf)
        kind = _DONE.get(attempt.what)
        ends = (event.tick for event in done if type(event) is kind and attempt.tick <= event.tick <= last)
        end = next(ends, None)
        if end is None:
            return attempt
        seconds = round((end - attempt.tick) * self.tick_s, 3)
        return msgspec.structs.replace(attempt, seconds=seconds, ok=True)


def _is_open(entry: JournalEntry) -> TypeGuard[Attempt]:
    return isinstance(entry, Attempt) and entry.ok is UNSET
