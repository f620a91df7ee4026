"""The moments of a trial that a case study shows: a robot speaks, a person answers and acts, the end."""

import itertools
from collections.abc import Iterator

from msgspec import Struct

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.geometry import plane
from hthor.report.drawing import trial_trace
from hthor.types import HUMAN, HouseSpec, is_person
from hthor.types.events import Accepted, Declined, Sent

MANY = 4
_APART_S = 1.0
"""Time between two moments at least [s]."""
_ANSWERS = {"accepted": "accepts", "declined": "declines"}
_DEEDS = ("picked", "held", "lifted", "opened", "placed")


class Moment(Struct, frozen=True, kw_only=True):
    """A tick of a trial, and in a few words what happened then."""

    tick: int
    words: str


def key_moments(
    record: TrialRecord, house: HouseSpec | None = None, many: int = MANY, seat: str = HUMAN
) -> list[Moment]:
    """Up to ``many`` moments in order; the last moment is the end.

    The first three are when a robot's first message that a person accepted was sent (if none was, the first message),
    when it was answered, and when a person's hands first did something. The others are in the middle of the longest
    waits; if ``house`` is given, their words are the room in which ``seat`` is.
    """
    found = [Moment(tick=record.ticks, words=trial_trace.end_word(record.log))]
    apart = round(_APART_S / rules.TICK_S)
    for one in _candidates(record):
        if len(found) < many and one.tick > 0 and all(abs(one.tick - other.tick) >= apart for other in found):
            found.append(one)
    while len(found) < many and (middle := _longest_wait(found, 2 * apart)):
        where = _room(record, middle, house, seat)
        found.append(Moment(tick=middle, words=f"in {where}" if where else "on the way"))
    return sorted(found, key=lambda one: one.tick)


def _candidates(record: TrialRecord) -> Iterator[Moment]:
    """Events of the trial as moments, the most important first."""
    sent = [event for event in trial_trace.messages(record.log) if not is_person(event.seat)]
    if sent:
        fates = [trial_trace.outcome_of(record.log, message.message) for message in sent]
        number = next((fates.index(fate) for fate in _ANSWERS if fate in fates), 0)
        yield Moment(tick=sent[number].tick, words=f"{sent[number].seat}, message {number + 1}")
        yield from _answer(record, sent[number])
    own = [event for event in record.events if is_person(event.seat)]
    for kind in _DEEDS:
        event = next((one for one in own if one.kind == kind), None)
        if event is not None:
            name = trial_trace.seat_name(event.seat, record.paths)
            yield Moment(tick=event.tick, words=f"{name} {trial_trace.ACTS[kind][1]}")


def _answer(record: TrialRecord, message: Sent) -> Iterator[Moment]:
    for event in record.events:
        if isinstance(event, (Accepted, Declined)) and event.message == message.message:
            name = trial_trace.seat_name(event.seat, record.paths)
            yield Moment(tick=event.tick, words=f"{name} {_ANSWERS[event.kind]}")
            return


def _longest_wait(found: list[Moment], least: int) -> int:
    """The middle tick of the longest time without a moment; 0 if that time is shorter than ``least``."""
    ticks = [0, *sorted(one.tick for one in found)]
    wait, first = max((second - first, -first) for first, second in itertools.pairwise(ticks))
    return -first + wait // 2 if wait >= least else 0


def _room(record: TrialRecord, tick: int, house: HouseSpec | None, seat: str) -> str:
    place = trial_trace.position_at(record.log, seat, tick)
    rooms = house.rooms if house is not None else ()
    return next((room.name for room in rooms if plane.inside(place, room.polygon)), "")
