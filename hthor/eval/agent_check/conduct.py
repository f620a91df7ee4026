"""How a robot behaved in a trial, beyond its score: whether it stood around and whether it repeated itself.

Pure functions of a trial's log.
"""

import math

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.types import Event

_SPOT_M = 0.25
"""A robot that stays within this distance [m] is on one spot, turning or not."""


def longest_on_one_spot_s(log: EpisodeLog, seat: str) -> float:
    """The longest time [s] that a seat stayed on one spot, up to the first message of any robot that was confirmed.

    Later it may wait with good reason: the person knows where to go.
    """
    until = min((event.tick for event in log.events if event.kind == "confirmed"), default=log.ticks)
    step = rules.LOG_EVERY_TICKS
    points = [(x / 1000.0, y / 1000.0) for x, y, _ in log.paths[seat][: until // step + 1]]
    longest = start = 0
    for number, point in enumerate(points):
        if math.dist(point, points[start]) > _SPOT_M:
            start = number
        longest = max(longest, number - start)
    return longest * step * rules.TICK_S


def count_repeated_messages(log: EpisodeLog, seat: str) -> int:
    """How many messages of a seat say what the one before said, although the person had not declined that one."""
    count, last = 0, None
    for event in log.events:
        if event.kind == "sent" and event.seat == seat:
            said = _said(event)
            count += said == last
            last = said
        elif event.kind == "declined":
            last = None
    return count


def _said(event: Event) -> tuple[object, ...]:
    return event.data.get("text"), event.data.get("object")
