"""One step of a body on the floor: straight on, or sliding along what is in the way.

Where the way ahead is blocked a body slides along x or y; where both are blocked it stays. Other bodies are discs: no
body may come closer to another than the sum of their radii, but a body that is too close already may always move away.
Loose things are pushed aside or stop it (`hthor.world.motion.loose_things`).
"""

import math
from collections.abc import Sequence

from hthor import rules
from hthor.types import Pose, Vec2
from hthor.world.state.body_state import BodyState

EPS = 1e-9
"""[m, rad, ticks] Tolerance for rounding."""
SLIDE_SHARE_MIN = 0.05
"""A body slides only if at least this share of the step lies along the axis; our choice."""
FREE, HOUSE = "", "*"
"""What blocks a step: nothing or the house; any other value is the seat in the way."""


def go(seat: BodyState, others: Sequence[BodyState], dx: float, dy: float, seconds: float = rules.TICK_S) -> str:
    """Go by (dx, dy) [m] in ``seconds`` if that place is free or can be made free; else returns what is in the way.

    An object that cannot be pushed counts as part of the house.
    """
    pose = seat.pose
    x, y = pose.x + dx, pose.y + dy
    for other in others:
        if _too_close(seat, other, x, y):
            return other.name
    if not seat.space.segment_free((pose.x, pose.y), (x, y)):
        return HOUSE
    loose = seat.loose
    if loose is not None and loose.low and not loose.make_way(seat, (dx, dy), seconds):
        return HOUSE
    seat.pose = Pose(x=x, y=y, yaw=pose.yaw, pitch=pose.pitch, head=pose.head)
    return FREE


def slide(
    seat: BodyState, others: Sequence[BodyState], step: Vec2, length: float, seconds: float = rules.TICK_S
) -> bool:
    """Go along x or else y by that part of a blocked step [m], unless the step is nearly perpendicular to the axis.

    Args:
        others: all other bodies. length: [m] of the step. seconds: how long it lasts.

    Returns:
        whether the body has moved.
    """
    (dx, dy), least = step, SLIDE_SHARE_MIN * length
    ways = ((dx, 0.0), (0.0, dy))
    return any(abs(x + y) > least and not go(seat, others, x, y, seconds) for x, y in ways)


def _too_close(seat: BodyState, other: BodyState, x: float, y: float) -> bool:
    there, least = other.pose, seat.spec.radius + other.spec.radius - EPS
    dx, dy = x - there.x, y - there.y
    if abs(dx) >= least or abs(dy) >= least or math.hypot(dx, dy) >= least:
        return False
    return math.hypot(dx, dy) < math.hypot(seat.pose.x - there.x, seat.pose.y - there.y)
