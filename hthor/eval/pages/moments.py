"""The moments of a trial that are worth a look: a robot speaks, the target is taken, the end; draws nothing."""

from __future__ import annotations

from msgspec import Struct

from hthor.eval import trace
from hthor.eval.record import Record
from hthor.types import HUMAN

MANY = 3


class Moment(Struct, frozen=True, kw_only=True):
    """A tick of a trial, and what happened there in a few words."""

    tick: int
    words: str


def of(record: Record) -> list[Moment]:
    """Up to three moments in order, the last of them the end.

    They are the sending of the first message that the person confirmed (else of the first), the first deed of the
    person's hands (else their answer), and the end. Where nothing was said there is the middle of what is left instead.
    """
    end = Moment(tick=record.ticks, words="done" if record.met else "time is up")
    found = [one for one in (_spoken(record), _done(record)) if one is not None and one.tick < end.tick]
    found = [one for one in found if one.tick > 0]
    if len(found) < MANY - 1:
        first = found[0].tick if found else 0
        middle = (first // 2) if first > end.tick // 2 else (first + end.tick) // 2
        if middle not in (0, end.tick, first):
            found.append(Moment(tick=middle, words="on the way"))
    return [*sorted(found, key=lambda one: one.tick), end]


def _spoken(record: Record) -> Moment | None:
    sent = trace.messages(record.log)
    if not sent:
        return None
    fates = [trace.fate(record.log, event.data["message"]) for event in sent]
    number = fates.index("confirmed") if "confirmed" in fates else 0
    return Moment(tick=sent[number].tick, words=f"{sent[number].seat}, message {number + 1}")


def _done(record: Record) -> Moment | None:
    own = [event for event in record.events if event.seat == HUMAN]
    for kind in ("picked", "opened", "confirmed", "declined"):
        event = next((one for one in own if one.kind == kind), None)
        if event is not None:
            verb = trace.ACTS[kind][1] if kind in trace.ACTS else {"confirmed": "confirms"}.get(kind, "declines")
            return Moment(tick=event.tick, words=f"person {verb}")
    return None
