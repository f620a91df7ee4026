"""The journal of a trial: what a headset's recorder stores in addition to the paths.

The trial's log has what the system sees: poses (x, y and yaw at 5 Hz), messages, picks and places, the rating. The
journal adds what a recorder in the headset sees, as events of these kinds:

- ``stick``, once per trial: ``full`` [m/s], the speed at full deflection of the stick, and ``runs``, a flat list of
  pairs (tick, deflection from that tick on in thousandths of ``full``). The direction is in the path.
- ``head``, once per trial: ``pitch``, a flat list of pairs (tick, pitch [mrad] from that tick on, up positive);
  ``fastest`` [rad/s], the body's limit of turning.
- ``inputs``, once per trial in which the person drove: ``runs``, a flat list of sextuples (tick, step of the tick,
  forward, left, yaw and pitch of the `Drive` from that step on), in units of `INPUT_UNIT` [m/s, rad].
- ``attempt``, with the tick at which it began: ``what`` was tried ("pick", "place", "open", "close", "drop"), how many
  ``seconds`` it took, whether it succeeded (``ok``), and if not ``why`` ("missed" when the hand closed on nothing, else
  the world's reason); for a "place" also ``at`` [m], the position on the furniture. An attempt cut off by the end of
  the trial has neither ``seconds`` nor ``ok``.
- ``exposure``: glimpses at an object that is searched for, see `hthor.humans.perception.exposure_log`.
- ``choice``: the options to search next, and the chosen one, see `hthor.humans.search.option_description`.
- ``offer``: a message that was read, and the answer, see `hthor.humans.models._dialogue`.
- ``misled``: the participant left the place named by an accepted message without success.

The episode records stick and head for every human model; only some human models record the other kinds.
"""

import math
from collections.abc import Iterable, Sequence

import msgspec

from hthor.types import BodySpec, Drive, Event, Motion, Move

_THOUSAND = 1000
"""[count] Steps per full deflection of the stick, and per radian of pitch. Our choice."""
_DONE = {"pick": "picked", "place": "placed", "open": "opened", "close": "closed", "drop": "dropped"}
"""The kind of event in the trial's log for each kind of attempt that succeeds."""

INPUT_UNIT = 1e-4
"""[m/s, rad] The unit of the set-points in the journal. Our choice: finer than any stick or headset measures."""

RecorderState = tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]


class BehaviourRecorder:
    """Records stick and pitch of one trial as run lengths; full deflection of the stick gives the body's speed."""

    def __init__(self, seat: str, body: BodySpec, tick_s: float) -> None:
        self.seat, self.body, self.tick_s, self._step = seat, body, tick_s, body.speed * tick_s
        self._stick: list[int] = [0, 0]
        self._pitch: list[int] = []
        self._inputs: list[int] = []

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
        stick = self._stick
        if stick[-1] != deflection:
            stick += (tick, deflection)

    def _record_inputs(self, tick: int, step: int, drive: Drive) -> None:
        numbers = [round(value / INPUT_UNIT) for value in (drive.forward, drive.left, drive.yaw, drive.pitch)]
        if self._inputs[-len(numbers) :] != numbers:
            self._inputs += (tick, step, *numbers)

    def head(self, tick: int, pitch: float) -> None:
        """Record the ``pitch`` [rad] of the head."""
        tilt = round(_THOUSAND * pitch)
        if not self._pitch or self._pitch[-1] != tilt:
            self._pitch += (tick, tilt)

    def journal(self, own: Iterable[Event], events: Iterable[Event]) -> tuple[Event, ...]:
        """The whole journal: the human model's own events, with successes from the trial's log (``events``)."""
        stick = Event(tick=0, seat=self.seat, kind="stick", data={"full": self.body.speed, "runs": self._stick})
        pitch = {"fastest": self.body.turn_rate, "pitch": self._pitch}
        done = [event for event in events if event.seat == self.seat and event.kind in _DONE.values()]
        written = list(own)
        tried = [event.tick for event in written if event.kind == "attempt"]
        ended = (self._completed(event, done, tried) if _is_open(event) else event for event in written)
        inputs = [Event(tick=0, seat=self.seat, kind="inputs", data={"runs": self._inputs})] if self._inputs else []
        return (stick, Event(tick=0, seat=self.seat, kind="head", data=pitch), *inputs, *ended)

    def save_state(self) -> RecorderState:
        """A copy of what was recorded."""
        return tuple(self._stick), tuple(self._pitch), tuple(self._inputs)

    def load_state(self, state: RecorderState) -> None:
        """Continue from a copy."""
        self._stick, self._pitch, self._inputs = (list(part) for part in state)

    def _completed(self, attempt: Event, done: Sequence[Event], tried: Sequence[int]) -> Event:
        """The attempt, with its success if that is in ``done`` before the next attempt (``tried``: all ticks)."""
        last = min((tick for tick in tried if tick > attempt.tick), default=math.inf)
        kind = _DONE.get(attempt.data["what"])
        ends = (event.tick for event in done if event.kind == kind and attempt.tick <= event.tick <= last)
        end = next(ends, None)
        if end is None:
            return attempt
        seconds = round((end - attempt.tick) * self.tick_s, 3)
        return msgspec.structs.replace(attempt, data={**attempt.data, "seconds": seconds, "ok": True})


def _is_open(event: Event) -> bool:
    return event.kind == "attempt" and "ok" not in event.data
