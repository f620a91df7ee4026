"""How a person used the panel and the map on their display in a trial, from the events."""

import math
from collections.abc import Iterator

from msgspec import Struct

from hthor import rules
from hthor.comms import display
from hthor.eval.records.trial_record import TrialRecord
from hthor.types import HUMAN
from hthor.types.events import Accepted, Answered, Declined, Displayed, Exposure, Offer, Picked, Sent

NEAR_M = 1.5
"""[m] A person this near to the place of a message has followed it. Our choice, that of the proxy's last choice."""
SOON_S = 2.0
"""[s] A map that is hidden this soon after the confirmation was not used on the way. Our choice."""


class Follow(Struct, frozen=True, kw_only=True):
    """The way to the place of one confirmed message.

    It ends near that place, when its object is noticed or something is picked up, at the next confirmation, or with the
    trial. A message that told the person nothing new is not followed.

    Attributes:
        seconds: how long it took [s]. shown: how long of that the map was shown [s].
        shown_again: how often a hidden map was shown again on the way.
        hidden: whether the map was hidden within `SOON_S` of the confirmation.
    """

    seconds: float
    shown: float
    shown_again: int
    hidden: bool


def message_follows(record: TrialRecord) -> tuple[Follow, ...]:
    """Every confirmed message with a place that was followed for longer than `SOON_S`, in order."""
    sent = {event.message: event for event in record.events if isinstance(event, Sent)}
    idle = {entry.message for entry in record.journal if isinstance(entry, Offer) and not entry.useful}
    spans = display.shown_spans(record.events, HUMAN, record.ticks)["map"]
    found = []
    for event in record.events:
        if isinstance(event, Accepted) and event.seat == HUMAN and event.message in sent.keys() - idle:
            follow = _follow(record, spans, event.tick, _end(record, event.tick, sent[event.message]))
            if sent[event.message].position is not None and follow.seconds > SOON_S:
                found.append(follow)
    return tuple(found)


def panel_times(record: TrialRecord) -> tuple[float, ...]:
    """For how long [s] the panel was shown until each answer, since the answer before it."""
    spans, since, found = display.shown_spans(record.events, HUMAN, record.ticks)["panel"], 0, []
    for event in record.events:
        if isinstance(event, (Accepted, Declined, Answered)) and event.seat == HUMAN:
            found.append(_overlap(spans, since, event.tick))
            since = event.tick
    return tuple(found)


def _follow(record: TrialRecord, spans: list[tuple[int, int]], begin: int, end: int) -> Follow:
    changes = [
        event
        for event in record.events
        if isinstance(event, Displayed) and event.seat == HUMAN and event.what == "map" and begin < event.tick < end
    ]
    soon = begin + round(SOON_S / rules.TICK_S)
    return Follow(
        seconds=(end - begin) * rules.TICK_S,
        shown=_overlap(spans, begin, end),
        shown_again=sum(event.on for event in changes),
        hidden=any(not event.on and event.tick <= soon for event in changes),
    )


def _end(record: TrialRecord, begin: int, message: Sent) -> int:
    """The tick at which a way that began at ``begin`` ended."""
    stops = [event.tick for event in record.events if event.seat == HUMAN and isinstance(event, (Accepted, Picked))]
    glimpses = [entry for entry in record.journal if isinstance(entry, Exposure) and entry.object == message.object]
    seen = [max(begin, entry.tick) for entry in glimpses if entry.noticed]  # what was seen before needs no way
    return min([tick for tick in (*stops, *arrival(record, begin, message)) if tick > begin] + seen + [record.ticks])


def arrival(record: TrialRecord, begin: int, message: Sent) -> Iterator[int]:
    """The tick from which the person was near the place of a message, if they came there."""
    path, every, place = record.paths[HUMAN], rules.LOG_EVERY_TICKS, message.position
    for number in range(begin // every + 1, len(path)):
        if place is not None and math.dist((path[number][0] / 1000.0, path[number][1] / 1000.0), place[:2]) <= NEAR_M:
            yield number * every
            return


def _overlap(spans: list[tuple[int, int]], begin: int, end: int) -> float:
    """How long [s] the spans lie between two ticks."""
    return sum(max(0, min(last, end) - max(first, begin)) for first, last in spans) * rules.TICK_S
