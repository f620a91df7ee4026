"""What a headset's recorder holds of a trial besides the paths: stick, pitch, attempts, glimpses.

The umpire's log has what the system sees: where everybody is (x, y and yaw at 5 Hz), the life of every message, what
was picked, placed and opened, the rating. A recorder on the person's side holds the rest, as events of these kinds:

==========
============================================================================================================ stick
``full`` [m/s], the speed of the stick pushed all the way; ``runs``, flat pairs of a tick and the deflection from
that tick on, in thousandths of ``full``. Written once a trial; the direction stands in the path. head ``pitch``,
flat pairs of a tick and the head's pitch [mrad] from that tick on, up positive, looked at when the path is;
``fastest`` [rad/s], what the body turns at most. Written once a trial. attempt ``what`` was tried ("pick", "place",
"open", "close", "drop"), under the tick at which that began; the ``seconds`` that it took and whether it was
``ok``; ``why`` not, where it was not: "missed" when the hand closed on nothing, else the world's words; ``at`` [m],
where on the furniture, of a "place". What was given up or cut off by the end has neither. exposure what of the
object wanted came into view, and whether it was noticed: see `hthor.humans.perception.exposure_log`. choice what
could be searched next, and what was: see `hthor.humans.search.option_choice`. offer a message that was read, what
spoke for and against it, and the answer: see `hthor.humans.models._dialogue`. misled the person left the place to
which a confirmed message had led, without what it was about. ==========
============================================================================================================

Stick and head are recorded by the umpire for every human model, attempts by the hands; the others are worked out
from what was in view, on the way and on the panel, and a human model that has no such notions leaves them out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import msgspec

from hthor.types import HUMAN, BodySpec, Event, Motion, Move

_THOUSAND = 1000
_DONE = {"pick": "picked", "place": "placed", "open": "opened", "close": "closed", "drop": "dropped"}
"""The event that the umpire writes when an attempt worked."""


class Recorder:
    """Stick and pitch of one trial, as run lengths.

    Args:
        body: the person's, which says what the stick pushed all the way is. tick_s: length of a tick [s].
    """

    def __init__(self, body: BodySpec, tick_s: float) -> None:
        self.body, self.tick_s, self._step = body, tick_s, body.speed * tick_s
        self._stick: list[int] = [0, 0]
        self._pitch: list[int] = []

    def motion(self, tick: int, motion: Motion) -> None:
        """The person begins a motion at ``tick``."""
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
        """The whole journal of a trial.

        Args:
            own: what the human model wrote. events: the umpire's, which tell of attempts that worked while nobody was
                there any more to write it down.
        """
        stick = Event(tick=0, seat=HUMAN, kind="stick", data={"full": self.body.speed, "runs": self._stick})
        pitch = {"fastest": self.body.turn_rate, "pitch": self._pitch}
        done = [event for event in events if event.seat == HUMAN and event.kind in _DONE.values()]
        written = list(own)
        tried = [event.tick for event in written if event.kind == "attempt"]
        ended = (self._ended(event, done, tried) if _is_open(event) else event for event in written)
        return (stick, Event(tick=0, seat=HUMAN, kind="head", data=pitch), *ended)

    def _ended(self, attempt: Event, done: Sequence[Event], tried: Sequence[int]) -> Event:
        """An attempt with the end that came of it, if one did before the next was ``tried``."""
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
