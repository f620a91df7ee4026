"""How a person handled messages in a trial, from events, joystick and journal."""

from typing import Any

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.calibration.from_logs.features import locomotion
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.communication.message_reading import is_same_message
from hthor.types import Message, events
from hthor.types.events import Accepted, Covered, Declined, Sent, Shown

_BEFORE_TICKS = round(1.5 / rules.TICK_S)
_SLOWER = 0.75
"""A person who slows down to this share of their pace, while still walking, has noticed a message."""


class Reading(Struct, frozen=True, kw_only=True):
    """The time [s] from showing a message of ``words`` words to its answer, or until an answer was impossible.

    ``known``: the same message had been shown before.
    """

    seconds: float
    answered: bool
    words: int
    known: bool


class Offer(Struct, frozen=True, kw_only=True):
    """A message about the task that was read: terms of the decision, and whether it was accepted (``accepted``)."""

    gain: float
    load: float
    again: float
    accepted: bool


def message_readings(record: TrialRecord) -> tuple[Reading, ...]:
    """Every message that was shown; a repetition of the message that is being read counts as the same."""
    sent = _messages(record)
    found: list[Reading] = []
    shown: list[Message] = []
    begun: tuple[int, Message, bool] | None = None
    for event in record.events:
        if isinstance(event, Shown):
            message = sent[event.message]
            if begun is None or not is_same_message(message, begun[1]):
                found += _left(begun, event.tick)
                begun = event.tick, message, any(is_same_message(message, old) for old in shown)
            shown.append(message)
        elif isinstance(event, (Accepted, Declined)) and begun is not None:
            found.append(_reading(begun, event.tick, answered=True))
            begun = None
    return (*found, *_left(begun, record.ticks))


def message_noticings(record: TrialRecord) -> tuple[tuple[float, bool], ...]:
    """For each message during a walk: seconds until the person slowed down (True) or first stopped (False)."""
    stick = locomotion.stick_deflection(record)
    found: list[tuple[float, bool]] = []
    if stick is None:
        return ()
    for event in record.events:
        if not isinstance(event, Shown):
            continue
        before = stick[max(0, event.tick - _BEFORE_TICKS) : event.tick]
        after = stick[event.tick : _answer(record, event)]
        if len(before) < _BEFORE_TICKS or before.min() <= 0 or not len(after):
            continue
        slow = np.flatnonzero((after > 0) & (after < _SLOWER * float(np.median(before))) & _kept(after))
        off = np.flatnonzero(after <= 0)
        until = int(off[0]) if len(off) else len(after)
        noticed = len(slow) > 0 and int(slow[0]) < until
        found.append(((int(slow[0]) if noticed else until) * rules.TICK_S, noticed))
    return tuple(pair for pair in found if pair[0] > 0.0)


def message_offers(record: TrialRecord) -> tuple[Offer, ...]:
    """The messages about the task that were read, in order."""
    return tuple(
        Offer(
            gain=entry.gain,
            load=entry.load,
            again=float(entry.again),
            accepted=entry.answer == "accept",
        )
        for entry in record.journal
        if isinstance(entry, events.Offer) and entry.relevant
    )


def _kept(stick: Any) -> Any:
    """Whether a deflection lasts for more than a tick; the last step to a corner is always short, so it does not."""
    follows = np.append(stick[1:], 0)
    return np.abs(follows - stick) <= 0.02 * stick


def _answer(record: TrialRecord, shown: Shown) -> int:
    ended = (event for event in record.events if isinstance(event, (Accepted, Declined, Covered)))
    ends = (event.tick for event in ended if event.message == shown.message)
    return min(next(ends, record.ticks), record.ticks)


def _messages(record: TrialRecord) -> dict[int, Message]:
    return {event.message: _message(event) for event in record.events if isinstance(event, Sent)}


def _message(sent: Sent) -> Message:
    return Message(
        id=sent.message,
        sender=sent.seat,
        tick=sent.tick,
        text=sent.text,
        object=sent.object,
        position=sent.position,
    )


def _left(begun: tuple[int, Message, bool] | None, tick: int) -> tuple[Reading, ...]:
    """The reading of a message that was not answered until ``tick``, if there is one."""
    return () if begun is None or tick <= begun[0] else (_reading(begun, tick, answered=False),)


def _reading(begun: tuple[int, Message, bool], tick: int, *, answered: bool) -> Reading:
    since, message, known = begun
    seconds = max(1, tick - since) * rules.TICK_S
    return Reading(seconds=seconds, answered=answered, words=len(message.text.split()), known=known)
