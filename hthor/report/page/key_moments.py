"""The moments of a trial that a case study shows: a robot speaks, the human answers and acts, the end."""

import itertools
from collections.abc import Iterator

from msgspec import Struct

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.geometry import plane
from hthor.report.drawing import trial_trace
from hthor.types import HUMAN, Event, HouseSpec

MANY = 4
_APART_S = 1.0
"""Two moments are at least so far apart."""
_ANSWERS = {"confirmed": "person confirms", "declined": "person declines"}
_DEEDS = ("picked", "held", "lifted", "opened", "placed")


class Moment(Struct, frozen=True, kw_only=True):
    """A tick of a trial, and what happened there in a few words."""

    tick: int
    words: str


def key_moments(record: TrialRecord, house: HouseSpec | None = None) -> list[Moment]:
    """Up to `MANY` moments in order, the last of them the end.

    First come the sending of the first message that the person confirmed (else of the first), the answer to it, and the
    first action of the human's hands. What is left is filled with looks into the longest waits; where ``house`` is
    given, they say in which room the person is.
    """
    found = [Moment(tick=record.ticks, words="done" if record.met else "time is up")]
    apart = round(_APART_S / rules.TICK_S)
    for one in _candidates(record):
        if len(found) < MANY and one.tick > 0 and all(abs(one.tick - other.tick) >= apart for other in found):
            found.append(one)
    while len(found) < MANY and (middle := _longest_wait(found, 2 * apart)):
        where = _room(record, middle, house)
        found.append(Moment(tick=middle, words=f"in {where}" if where else "on the way"))
    return sorted(found, key=lambda one: one.tick)


def _candidates(record: TrialRecord) -> Iterator[Moment]:
    """What happened, the most telling first."""
    sent = trial_trace.messages(record.log)
    if sent:
        fates = [trial_trace.outcome_of(record.log, event.data["message"]) for event in sent]
        number = next((fates.index(fate) for fate in _ANSWERS if fate in fates), 0)
        yield Moment(tick=sent[number].tick, words=f"{sent[number].seat}, message {number + 1}")
        yield from _answer(record, sent[number])
    own = [event for event in record.events if event.seat == HUMAN]
    for kind in _DEEDS:
        event = next((one for one in own if one.kind == kind), None)
        if event is not None:
            yield Moment(tick=event.tick, words=f"person {trial_trace.ACTS[kind][1]}")


def _answer(record: TrialRecord, message: Event) -> Iterator[Moment]:
    for event in record.events:
        if event.kind in _ANSWERS and event.data.get("message") == message.data["message"]:
            yield Moment(tick=event.tick, words=_ANSWERS[event.kind])
            return


def _longest_wait(found: list[Moment], least: int) -> int:
    """The middle of the longest time in which nothing is shown; 0 where none is worth it."""
    ticks = [0, *sorted(one.tick for one in found)]
    wait, first = max((second - first, -first) for first, second in itertools.pairwise(ticks))
    return -first + wait // 2 if wait >= least else 0


def _room(record: TrialRecord, tick: int, house: HouseSpec | None) -> str:
    place = trial_trace.position_at(record.log, HUMAN, tick)
    rooms = house.rooms if house is not None else ()
    return next((room.name for room in rooms if plane.inside(place, room.polygon)), "")
