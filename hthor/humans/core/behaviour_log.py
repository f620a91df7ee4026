"""The journal of a trial: what a headset's recorder holds besides the paths.

The trial's log has what the system sees: poses (x, y and yaw at 5 Hz), messages, picks and places, the rating. The
journal adds what a recorder at the participant's side sees, as events of these kinds:

- ``stick``, once a trial: ``full`` [m/s], the speed of the stick pushed all the way, and ``runs``, flat pairs of a tick
  and the deflection from then on, in thousandths of ``full``. The direction is in the path.
- ``head``, once a trial: ``pitch``, flat pairs of a tick and the pitch [mrad] from then on, up positive; ``fastest``
  [rad/s], the body's limit of turning.
- ``attempt``, under the tick at which it began: ``what`` was tried ("pick", "place", "open", "close", "drop"), the
  ``seconds`` that it took, whether it was ``ok`` and ``why`` not ("missed" when the hand closed on nothing, else the
  world's reason); ``at`` [m], where on the furniture, for a "place". An attempt cut off by the end of the trial has
  neither ``seconds`` nor ``ok``.
- ``exposure``: glimpses at an object that is wanted, see `hthor.humans.perception.exposure_log`.
- ``choice``: what could be searched next, and what was, see `hthor.humans.search.option_description`.
- ``offer``: a message that was read, and the answer, see `hthor.humans.models._dialogue`.
- ``misled``: the place named by a confirmed message was left without success.

The episode records stick and head for every human model; the rest is written by models that have such notions.
"""

import math
from collections.abc import Iterable, Sequence

import msgspec

from hthor.types import HUMAN, BodySpec, Event, Motion, Move

_THOUSAND = 1000
"""[count] Steps of the stick's deflection, and of the pitch's radian. Our choice."""
_DONE = {"pick": "picked", "place": "placed", "open": "opened", "close": "closed", "drop": "dropped"}
"""The event of the trial's log for each attempt that succeeds."""


class BehaviourRecorder:
    """Stick and pitch of one trial, as run lengths; the body's speed is that of the stick pushed all the way."""

    def __init__(self, body: BodySpec, tick_s: float) -> None:
        self.body, self.tick_s, self._step = body, tick_s, body.speed * tick_s
        self._stick: list[int] = [0, 0]
        self._pitch: list[int] = []

    def motion(self, tick: int, motion: Motion) -> None:
        """The participant begins a motion at ``tick``."""
        deflection = 0
        if isinstance(motion, Move):
            share = math.hypot(motion.forward, motion.left) / self._step
            deflection = round(_THOUSAND * min(1.0, share)) if math.isfinite(share) else 0
        stick = self._stick
        if stick[-1] != deflection:
            stick += (tick, deflection)

    def head(self, tick: int, pitch: float) -> None:
        """The head is tilted by ``pitch`` [rad]."""
        tilt = round(_THOUSAND * pitch)
        if not self._pitch or self._pitch[-1] != tilt:
            self._pitch += (tick, tilt)

    def journal(self, own: Iterable[Event], events: Iterable[Event]) -> tuple[Event, ...]:
        """The whole journal: what the human model recorded (``own``), with the successes that the trial's log has."""
        stick = Event(tick=0, seat=HUMAN, kind="stick", data={"full": self.body.speed, "runs": self._stick})
        pitch = {"fastest": self.body.turn_rate, "pitch": self._pitch}
        done = [event for event in events if event.seat == HUMAN and event.kind in _DONE.values()]
        written = list(own)
        tried = [event.tick for event in written if event.kind == "attempt"]
        ended = (self._completed(event, done, tried) if _is_open(event) else event for event in written)
        return (stick, Event(tick=0, seat=HUMAN, kind="head", data=pitch), *ended)

    def _completed(self, attempt: Event, done: Sequence[Event], tried: Sequence[int]) -> Event:
        """The attempt with its success, if it succeeded before the next was ``tried``."""
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
