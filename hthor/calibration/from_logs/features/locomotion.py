"""How a person walked and turned in a trial, from the joystick and the path."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.types import HUMAN
from hthor.types.events import Accepted, Attempt, Covered, Declined, Head, Picked, Shown, Stick

Array = Any
"""A numpy array."""

_READ_TICKS = round(12.0 / rules.TICK_S)
_GUIDED_TICKS = round(15.0 / rules.TICK_S)
_ENOUGH_TICKS = round(3.0 / rules.TICK_S)
_SAMPLE_S = rules.LOG_EVERY_TICKS * rules.TICK_S
_STILL_RAD, _MOVED_RAD = 0.004, 0.02
_TURN_RAD = math.radians(45.0)
_ON_RAD, _STOP_TICKS = math.radians(15.0), round(6.0 / rules.TICK_S)


class Walk(Struct, frozen=True, kw_only=True):
    """Walking in one trial; fields with too few data are NaN or empty.

    Attributes:
        full: speed at full deflection of the joystick [m/s]. fastest: the greatest turning speed of the body [rad/s].
        pace: median walking speed [m/s], while neither reading nor following a map.
        guided: for each walk after an accepted message, ``pace`` over its speed.
        turns: speed of each turn of more than 45 degrees [rad/s].
        start: when the person first moved or turned [s].
        under_way: time with the joystick deflected [s]. stops: durations of stops within a straight walk [s].
    """

    full: float
    fastest: float
    pace: float
    guided: tuple[float, ...]
    turns: tuple[float, ...]
    start: float
    under_way: float
    stops: tuple[float, ...]


def walk_features(record: TrialRecord) -> Walk | None:
    """Walking in a trial, None when its log has no joystick data."""
    pushed = stick_deflection(record)
    if pushed is None:
        return None
    full = next(entry.full for entry in record.journal if isinstance(entry, Stick))
    fastest = next((entry.fastest for entry in record.journal if isinstance(entry, Head)), math.inf)
    on = pushed > 0
    reading, guided = _reading(record), _guided(record)
    plain = pushed[on & ~reading & ~guided]
    pace = full * float(np.median(plain)) / 1000.0 if len(plain) >= _ENOUGH_TICKS else math.nan
    path = np.array(record.paths[HUMAN], dtype=float) / 1000.0
    turned = _wrapped(np.diff(path[:, 2]))
    turns = _turns(turned)
    return Walk(
        full=full,
        fastest=fastest,
        pace=pace,
        guided=() if math.isnan(pace) or pace >= 0.99 * full else _slower(record, pushed, reading, pace / full),
        turns=turns,
        start=_start(path, turned, turns),
        under_way=float(on.sum()) * rules.TICK_S,
        stops=_stops(record, on, path[:, 2], turned, float(np.median(turns))) if turns else (),
    )


def stick_deflection(record: TrialRecord) -> Array | None:
    """(ticks,) deflection in thousandths at each tick; None if the log has no joystick data."""
    runs = next((entry.runs for entry in record.journal if isinstance(entry, Stick)), None)
    if runs is None:
        return None
    at, value = np.array(runs[::2]), np.array(runs[1::2])
    return np.repeat(value, np.diff(np.append(at, max(record.ticks, at[-1]))))[: record.ticks]


def _reading(record: TrialRecord) -> Array:
    """(ticks,) bool, whether a message was shown and not yet answered; an ignored one counts for 12 s."""
    mask = np.zeros(record.ticks, dtype=bool)
    for event in record.events:
        if isinstance(event, Shown):
            ended = (other for other in record.events if isinstance(other, (Accepted, Declined, Covered)))
            ends = [other.tick for other in ended if other.message == event.message]
            mask[event.tick : min([*ends, event.tick + _READ_TICKS])] = True
    return mask


def _guided(record: TrialRecord) -> Array:
    """(ticks,) bool, whether a message was accepted and the person has picked up nothing since."""
    mask, since = np.zeros(record.ticks, dtype=bool), -1
    for event in record.events:
        if isinstance(event, Accepted) and since < 0:
            since = event.tick
        elif isinstance(event, Picked) and event.seat == HUMAN and since >= 0:
            mask[since : event.tick] = True
            since = -1
    if since >= 0:
        mask[since:] = True
    return mask


def _slower(record: TrialRecord, pushed: Array, reading: Array, usual: float) -> tuple[float, ...]:
    """The factor by which each walk after an accepted message was slower, from its most frequent deflection."""
    found = []
    for event in record.events:
        if isinstance(event, Accepted):
            piece = slice(event.tick, event.tick + _GUIDED_TICKS)
            walked = pushed[piece][(pushed[piece] > 0) & ~reading[piece]]
            if len(walked) >= _ENOUGH_TICKS // 2:
                values, counts = np.unique(walked, return_counts=True)
                found.append(1000.0 * usual / float(values[counts.argmax()]))
    return tuple(found)


def _turns(turned: Array) -> tuple[float, ...]:
    """Speeds of turns to one side [rad/s], without their first and last sample."""
    side = np.where(np.abs(turned) > _MOVED_RAD, np.sign(turned), 0.0)
    edges = np.flatnonzero(np.diff(side)) + 1
    found = []
    for piece in np.split(turned, edges):
        inner = np.abs(piece[1:-1])
        if len(inner) >= 2 and abs(piece.sum()) > _TURN_RAD and abs(piece[0]) > _MOVED_RAD:
            found.append(float(np.median(inner)) / _SAMPLE_S)
    return tuple(found)


def _start(path: Array, turned: Array, turns: tuple[float, ...]) -> float:
    """When the person first moved or turned [s]; within a sample, estimated from the angle turned."""
    gone = np.hypot(*np.diff(path[:, :2], axis=0).T)
    moved = np.flatnonzero((np.abs(turned) > _STILL_RAD) | (gone > _STILL_RAD))
    if not len(moved):
        return math.nan
    first = int(moved[0])
    busy = min(_SAMPLE_S, abs(float(turned[first])) / turns[0]) if turns and gone[first] < _STILL_RAD else _SAMPLE_S / 2
    return (first + 1) * _SAMPLE_S - busy


def _stops(record: TrialRecord, on: Array, yaw: Array, turned: Array, rate: float) -> tuple[float, ...]:
    """Durations [s] without walking, turning or handling after which the walk continued in the same direction.

    Time spent turning is subtracted, at the ``rate`` of the trial's turns [rad/s].
    """
    busy = [entry.tick for entry in record.journal if isinstance(entry, Attempt)]
    edges, found = np.flatnonzero(np.diff(on.astype(int))), []
    for off, again in pairwise(edges):
        if not on[off] or again - off > _STOP_TICKS or any(off <= tick <= again for tick in busy):
            continue
        a, b = (off + 1) // rules.LOG_EVERY_TICKS, min(-(-(again + 1) // rules.LOG_EVERY_TICKS), len(yaw) - 1)
        still = (again - off) * rules.TICK_S - float(np.abs(turned[a:b]).sum()) / rate
        if still > 0.0 and abs(_wrapped(yaw[b] - yaw[a])) < _ON_RAD:
            found.append(float(still))
    return tuple(found)


def _wrapped(angle: Array) -> Array:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
