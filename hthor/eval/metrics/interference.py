"""How much bodies were in each other's way in a trial: pure functions of its log."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.types import HUMAN

FREED_M = 0.3
"""Who has come so far from where they were hindered is hindered no more."""
LONGEST_S = 5.0
"""Nobody is hindered longer by one event: by then they could have chosen another way."""

Span = tuple[int, int]
"""Ticks, from and until."""


def count(log: EpisodeLog) -> int:
    """How often a body met another in its way."""
    return sum(event.kind == "in_way" for event in log.events)


def of_person(log: EpisodeLog) -> float:
    """Seconds that the person lost to all robots together."""
    return _seconds(_spans(log, HUMAN))


def by_pair(log: EpisodeLog) -> dict[str, float]:
    """Seconds that each seat lost to each other, as ``{"human by robot": 1.2, ...}``."""
    seats = list(log.paths)
    return {
        f"{seat} by {other}": _seconds(_spans(log, seat, other)) for seat in seats for other in seats if seat != other
    }


def _spans(log: EpisodeLog, seat: str, by: str = "") -> Iterator[Span]:
    """From each time that the seat was hindered until it had come away from there."""
    for event in log.events:
        if event.kind == "in_way" and event.seat == seat and by in ("", event.data.get("by")):
            yield event.tick, _freed(log, seat, event.tick)


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
    """Length of all spans together [s], what they share counted once."""
    ticks, end = 0, -1
    for first, last in sorted(spans):
        ticks += max(0, last - max(first, end))
        end = max(end, last)
    return ticks * rules.TICK_S
