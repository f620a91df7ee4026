"""How long a person's hands took, from what everybody could see: for people whose own attempts nobody recorded."""

from __future__ import annotations

import numpy as np

from hthor import rules
from hthor.calibration.from_logs.features import locomotion
from hthor.eval.records.trial_record import TrialRecord
from hthor.types import HUMAN
from hthor.types.events import Accepted, Closed, Declined, Opened, Picked, Placed, Refused, Shown

_DONE = (Picked, Placed, Opened, Closed)
_TRIED = ("pick", "place", "open", "close")
_LOOK_S = 0.4
"""[s] The look at a thing before the hands begin, as the model of people has it (`_CHECK_S` of its behaviours)."""
_LONGEST_S = 30.0
"""[s] Somebody who stood still for longer did something else. Our choice."""
_TURNED_RAD = 0.02


def handling_times(record: TrialRecord) -> tuple[float, ...]:
    """How long [s] each thing took that was picked up, put down, opened or closed, from the last step before it.

    Time spent turning and the first look are not counted, nor are times in which a message came or was answered.
    """
    pushed = locomotion.stick_deflection(record)
    if pushed is None:
        return ()
    ends = [event for event in record.events if event.seat == HUMAN and _is_try(event)]
    asides = [e.tick for e in record.events if e.seat == HUMAN and isinstance(e, (Shown, Accepted, Declined))]
    path = np.array(record.paths[HUMAN], dtype=float)
    turning = np.abs(np.angle(np.exp(1j * np.diff(path[:, 2]) / 1000.0))) > _TURNED_RAD
    found, last = [], 0
    for event in ends:
        walked = np.flatnonzero(pushed[: event.tick] > 0)
        begin = max(last, int(walked[-1]) + 1 if len(walked) else 0)
        last = event.tick
        if not isinstance(event, _DONE) or any(begin <= tick <= event.tick for tick in asides):
            continue
        first, end = begin // rules.LOG_EVERY_TICKS, event.tick // rules.LOG_EVERY_TICKS
        turned = float(turning[first:end].sum()) * rules.LOG_EVERY_TICKS * rules.TICK_S
        seconds = (event.tick - begin) * rules.TICK_S - turned - _LOOK_S
        if seconds < _LONGEST_S:
            found.append(max(seconds, rules.HANDLING_S))
    return tuple(found)


def _is_try(event: object) -> bool:
    return isinstance(event, _DONE) or (isinstance(event, Refused) and event.motion in _TRIED)
