"""Records stick and pitch of a trial, and puts its journal together; `hthor.types.events.journal` lists the kinds.

The episode records stick and head for every human model; only some human models record more.
"""

import math
from collections.abc import Iterable, Sequence
from typing import TypeGuard

import msgspec
from msgspec import UNSET

from hthor.types import BodySpec, Drive, Motion, Move
from hthor.types.events import (
    Attempt,
    Closed,
    Dropped,
    Event,
    Head,
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

RecorderState = tuple[tuple[int, ...], tuple[int, ...]]


class BehaviourRecorder:
    """Records stick and pitch of one trial as run lengths; full deflection of the stick gives the body's speed."""

    def __init__(self, seat: str, body: BodySpec, tick_s: float) -> None:
        self.seat, self.body, self.tick_s, self._step = seat, body, tick_s, body.speed * tick_s
        self._stick: list[int] = [0, 0]
        self._pitch: list[int] = []

    def motion(self, tick: int, motion: Motion) -> None:
        """Record a motion that begins at ``tick``."""
        deflection = 0
        if isinstance(motion, Move):
            share = math.hypot(motion.forward, motion.left) / self._step
            deflection = round(_THOUSAND * min(1.0, share)) if math.isfinite(share) else 0
        elif isinstance(motion, Drive):
            share = math.hypot(motion.forward, motion.left) / self.body.speed
            deflection = round(_THOUSAND * min(1.0, share))
        stick = self._stick
        if stick[-1] != deflection:
            stick += (tick, deflection)

    def head(self, tick: int, pitch: float) -> None:
        """Record the ``pitch`` [rad] of the head."""
        tilt = round(_THOUSAND * pitch)
        if not self._pitch or self._pitch[-1] != tilt:
            self._pitch += (tick, tilt)

    def journal(
        self, own: Iterable[JournalEntry], events: Iterable[Event], inputs: Iterable[JournalEntry] = ()
    ) -> tuple[JournalEntry, ...]:
        """The whole journal.

        Args:
            own: the human model's own entries. events: the trial's log, which has the successes of attempts.
            inputs: everything that the person did, if they drove.
        """
        stick = Stick(tick=0, seat=self.seat, full=self.body.speed, runs=tuple(self._stick))
        head = Head(tick=0, seat=self.seat, fastest=self.body.turn_rate, pitch=tuple(self._pitch))
        done = [event for event in events if event.seat == self.seat and isinstance(event, tuple(_DONE.values()))]
        written = list(own)
        tried = [entry.tick for entry in written if isinstance(entry, Attempt)]
        ended = (self._completed(entry, done, tried) if _is_open(entry) else entry for entry in written)
        return (stick, head, *inputs, *ended)

    def save_state(self) -> RecorderState:
        """A copy of what was recorded."""
        return tuple(self._stick), tuple(self._pitch)

    def load_state(self, state: RecorderState) -> None:
        """Continue from a copy."""
        self._stick, self._pitch = (list(part) for part in state)

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
