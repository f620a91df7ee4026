"""What one trial was worth: pure functions of the trial and its log."""

from __future__ import annotations

import msgspec
from msgspec import Struct

from hthor import rules
from hthor.comms import claims
from hthor.episode import EpisodeLog
from hthor.eval.metrics import communication, contribution, interference
from hthor.types import HUMAN, TrialSpec

CODE_ROOT = "trial"

DIGITS = 6
"""Decimals that are kept, so that a record reads the same on every machine."""


class Messages(Struct, frozen=True, kw_only=True):
    """What became of the messages that robots sent in a trial, and how many of their claims were false."""

    sent: int
    accepted: int
    declined: int
    covered: int
    unanswered: int
    false_claims: int


class TrialMetrics(Struct, frozen=True, kw_only=True):
    """The values of one trial; docs/metrics.md defines each of them.

    ``sr`` is 1 for a success, else 0. ``twsr`` is s T* / max(T*, T), in [0, 1]. ``time_s`` [s] is the time spent, the
    whole time limit after a failure. ``adoption`` is 1 when the person confirmed a robot's message; it, ``trust``
    (1 to 7), the counts of messages, and what has to do with bodies in the way are None where there was no robot.

    ``progress`` is the share of the goal that was met in the end, None where the kind of task counts no parts.
    ``idle_s`` [s] is how long the person's body did nothing. ``in_way`` is how often a body met another in its way,
    ``hindered_s`` [s] what the person lost by that, and ``hindered_by`` [s] what each seat lost to each other. ``work``
    holds each seat's share of what was achieved, empty when nothing was.

    ``precision`` is the share of the robots' claims that were true, None where there were none. ``first_useful_s`` [s]
    is when the first true message was sent that the person confirmed, None without one. ``interruptions_per_min`` is
    how many messages a minute came up before the person's eyes. ``useful`` counts the confirmed messages that were true
    and new to the person, ``usefulness`` is their share among the confirmed, None where none was.
    """

    sr: int
    twsr: float
    adoption: int | None
    time_s: float
    trust: int | None
    progress: float | None = None
    idle_s: float | None = None
    in_way: int | None = None
    hindered_s: float | None = None
    sent: int | None = None
    accepted: int | None = None
    declined: int | None = None
    covered: int | None = None
    unanswered: int | None = None
    false_claims: int | None = None
    precision: float | None = None
    first_useful_s: float | None = None
    interruptions_per_min: float | None = None
    useful: int | None = None
    usefulness: float | None = None
    work: dict[str, float] = {}
    hindered_by: dict[str, float] = {}


BY_SEAT = ("work", "hindered_by")
"""Metrics that have several values, by name of a seat or of a pair of seats."""
NAMES = tuple(name for name in TrialMetrics.__struct_fields__ if name not in BY_SEAT)
"""Metrics that have one value."""


def measure(spec: TrialSpec, log: EpisodeLog) -> TrialMetrics:
    """The metrics of a trial."""
    alone = not spec.robots
    return TrialMetrics(
        sr=int(log.met),
        twsr=time_weighted_success(spec, log),
        adoption=adoption(spec, log),
        time_s=time_spent(spec, log),
        trust=None if alone else log.trust,
        progress=log.progress,
        idle_s=_rounded(log.idle[HUMAN] * rules.TICK_S) if HUMAN in log.idle else None,
        in_way=None if alone else interference.count(log),
        hindered_s=None if alone else _rounded(interference.of_person(log)),
        **({} if alone else msgspec.structs.asdict(messages(log))),
        precision=None if alone else _maybe(communication.precision(log)),
        first_useful_s=None if alone else _maybe(communication.first_useful_s(log)),
        interruptions_per_min=None if alone else _maybe(communication.interruptions_per_min(log)),
        useful=None if alone else communication.useful(log),
        usefulness=None if alone else _maybe(communication.usefulness(log)),
        work={} if alone else {seat: _rounded(part) for seat, part in (contribution.shares(spec, log) or {}).items()},
        hindered_by={} if alone else {pair: _rounded(value) for pair, value in interference.by_pair(log).items()},
    )


def time_spent(spec: TrialSpec, log: EpisodeLog) -> float:
    """Seconds until the goal was met; the time limit when it was not."""
    return _rounded(log.ticks * rules.TICK_S) if log.met else spec.task.time_limit


def time_weighted_success(spec: TrialSpec, log: EpisodeLog) -> float:
    """Success weighted by time: 1 when the task was done in the time T* or faster, 0 when it failed."""
    if not log.met:
        return 0.0
    good = spec.task.t_star
    longest = max(good, time_spent(spec, log))
    return _rounded(good / longest) if longest > 0.0 else 1.0


def adoption(spec: TrialSpec, log: EpisodeLog) -> int | None:
    """Whether the person confirmed at least one message of a robot; None in a trial without robots."""
    if not spec.robots:
        return None
    by_robots = {event.data.get("message") for event in log.events if event.kind == "sent" and event.seat != HUMAN}
    confirmed = {event.data.get("message") for event in log.events if event.kind == "confirmed"}
    return int(bool(by_robots & confirmed))


def messages(log: EpisodeLog) -> Messages:
    """What became of each message: the person confirmed it, declined it, or a newer one covered it before that."""
    sent = communication.sent(log)
    numbers = {event.data.get("message") for event in sent}
    ends = {
        kind: len({event.data.get("message") for event in log.events if event.kind == kind} & numbers)
        for kind in ("confirmed", "declined", "covered")
    }
    return Messages(
        sent=len(sent),
        accepted=ends["confirmed"],
        declined=ends["declined"],
        covered=ends["covered"],
        unanswered=len(sent) - sum(ends.values()),
        false_claims=sum(claims.is_false(event.data) for event in sent),
    )


def _rounded(value: float) -> float:
    return round(value, DIGITS)


def _maybe(value: float | None) -> float | None:
    return None if value is None else _rounded(value)
