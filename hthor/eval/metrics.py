"""What one trial was worth: pure functions of the trial and its log; knows nothing of other trials."""

from __future__ import annotations

from msgspec import Struct

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.types import HUMAN, TrialSpec

DIGITS = 6
"""Decimals that are kept, so that a record reads the same on every machine."""


class TrialMetrics(Struct, frozen=True, kw_only=True):
    """The values of one trial.

    ``sr`` is 1 for a success, else 0. ``twsr`` is s T* / max(T*, T), in [0, 1]. ``time_s`` [s] is the time spent, the
    whole time limit after a failure. ``adoption`` is 1 when the person confirmed a robot's message; it and ``trust``
    (1 to 7) are None where there was no robot.
    """

    sr: int
    twsr: float
    adoption: int | None
    time_s: float
    trust: int | None


NAMES = TrialMetrics.__struct_fields__


def measure(spec: TrialSpec, log: EpisodeLog) -> TrialMetrics:
    """The metrics of a trial."""
    return TrialMetrics(
        sr=int(log.met),
        twsr=time_weighted_success(spec, log),
        adoption=adoption(spec, log),
        time_s=time_spent(spec, log),
        trust=log.trust if spec.robots else None,
    )


def time_spent(spec: TrialSpec, log: EpisodeLog) -> float:
    """Seconds until the goal was met; the time limit when it was not."""
    return round(log.ticks * rules.TICK_S, DIGITS) if log.met else spec.task.time_limit


def time_weighted_success(spec: TrialSpec, log: EpisodeLog) -> float:
    """Success weighted by time: 1 when the task was done in the least time T* or faster, 0 when it failed."""
    if not log.met:
        return 0.0
    least = spec.task.t_star
    longest = max(least, time_spent(spec, log))
    return round(least / longest, DIGITS) if longest > 0.0 else 1.0


def adoption(spec: TrialSpec, log: EpisodeLog) -> int | None:
    """Whether the person confirmed at least one message of a robot; None in a trial without robots."""
    if not spec.robots:
        return None
    by_robots = {event.data.get("message") for event in log.events if event.kind == "sent" and event.seat != HUMAN}
    confirmed = {event.data.get("message") for event in log.events if event.kind == "confirmed"}
    return int(bool(by_robots & confirmed))
