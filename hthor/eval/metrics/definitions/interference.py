"""How much bodies were in each other's way."""

import functools
import math
import statistics
from collections.abc import Callable, Iterable, Iterator

from hthor import rules
from hthor.episode.recording.episode_log import EpisodeLog
from hthor.eval.metrics.metric import LOWER, SECONDS, Metric, Trial
from hthor.types import is_person
from hthor.types.events import InWay

FREED_M = 0.3
"""A body this far from where it was hindered is free again [m]."""
LONGEST_S = 5.0
"""Longest time [s] that one event counts as hindering: by then the body could have chosen another way."""

Span = tuple[int, int]
"""A span of time: its first and its last tick."""


def encounters(trial: Trial) -> int:
    """How often a body met another in its way."""
    return sum(isinstance(event, InWay) for event in trial.log.events)


def human_hindered(trial: Trial) -> float:
    """Seconds that the human lost to all robots together, as bodies were in its way.

    With several people, the mean of theirs; the time that they lost to one another is only in `hindered_by`.
    """
    return statistics.fmean(_seconds(_spans(trial.log, seat, _is_robot)) for seat in trial.people)


def hindered_by_pair(trial: Trial) -> dict[str, float]:
    """Seconds that each seat lost to each other seat, by names such as "human by robot2"."""
    seats = list(trial.log.paths)
    pairs = [(seat, other) for seat in seats for other in seats if seat != other]
    return {f"{seat} by {other}": _seconds(_spans(trial.log, seat, other.__eq__)) for seat, other in pairs}


def _spans(log: EpisodeLog, seat: str, counts: Callable[[str], bool]) -> Iterator[Span]:
    """The spans from each time that the seat was hindered, by a seat that ``counts``, until it was free again."""
    for event in log.events:
        if isinstance(event, InWay) and event.seat == seat and counts(event.by):
            yield event.tick, _freed(log, seat, event.tick)


def _is_robot(seat: str) -> bool:
    return not is_person(seat)


def _freed(log: EpisodeLog, seat: str, tick: int) -> int:
    path, every = log.paths[seat], rules.LOG_EVERY_TICKS
    last = min(log.ticks, tick + round(LONGEST_S / rules.TICK_S))
    first = min(tick // every, len(path) - 1)
    x, y, _ = path[first]
    for number in range(first + 1, min(last // every + 1, len(path))):
        if math.hypot(path[number][0] - x, path[number][1] - y) > 1000.0 * FREED_M:
            return min(last, number * every)
    return last


def _seconds(spans: Iterable[Span]) -> float:
    """Length of all spans together [s]; where spans overlap, time counts once."""
    ticks, end = 0, -1
    for first, last in sorted(spans):
        ticks += max(0, last - max(first, end))
        end = max(end, last)
    return ticks * rules.TICK_S


_hindrance = functools.partial(Metric, decimals=2, better=LOWER, needs_robot=True)

METRICS = (
    _hindrance("in_way", "bodies in the way, a trial", encounters, rank=120),
    _hindrance("hindered_s", "human hindered", human_hindered, unit=SECONDS, rank=130, timed=True),
    _hindrance("hindered_by", "hindered", hindered_by_pair, unit=SECONDS, rank=910, by_seat=True, timed=True),
)
