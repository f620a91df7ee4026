"""Moving and turning with a thing that is held by its handles, tick by tick."""

import math
from collections.abc import Callable

from hthor import rules
from hthor.geometry.plane import turn, wrap
from hthor.types import Event, Move, Outcome, Pose, Rotate, Vec2
from hthor.world.carrying.trailer import TrailerLoad
from hthor.world.motion.locomotion import TickResult
from hthor.world.state.body_state import BodyState

_EPS = 1e-9
_SLIDE_SHARE_MIN = 0.05
"""A body slides only if at least this share of the step lies along the axis; our choice."""


class CarryMotion:
    """Moving with a load along a straight line, as far as the house, the other bodies and the load allow.

    Args:
        culprit: names what blocks a place, for the outcome.
    """

    def __init__(
        self, seat: BodyState, motion: Move, load: TrailerLoad, culprit: Callable[[BodyState, Vec2], str]
    ) -> None:
        self._seat, self._load, self._culprit = seat, load, culprit
        self._left = math.hypot(motion.forward, motion.left)
        x, y = turn((motion.forward, motion.left), seat.pose.yaw)
        self._along = (x / self._left, y / self._left) if self._left > 0.0 else (0.0, 0.0)

    def advance(self, tick: int) -> TickResult:
        seat, load = self._seat, self._load
        if seat.name not in load.ends:
            return Outcome(motion="move", ok=False, reason=f"{load.item.id} was put down"), ()
        step = min(load.pace * rules.TICK_S, self._left)
        self._left -= step
        dx, dy = self._along[0] * step, self._along[1] * step
        if step > 0.0 and not load.follows(seat, tick) and not self._go(dx, dy, step):
            return self._stop(tick, (dx, dy))
        return (None if self._left > _EPS else Outcome(motion="move", ok=True)), ()

    def _stop(self, tick: int, step: Vec2) -> TickResult:
        other = self._load.body_in_the_way(self._seat)
        by = other or self._culprit(self._seat, step)
        outcome = Outcome(motion="move", ok=False, reason=f"{other} is in the way" if other else "blocked", by=by)
        kind = "in_way" if other else "blocked"
        return outcome, (Event(tick=tick, seat=self._seat.name, kind=kind, data={"by": by}),)

    def _go(self, dx: float, dy: float, step: float) -> bool:
        """Straight on, or else along one axis, unless hardly anything of the step is along it."""
        ways = ((dx, dy), *(way for way in ((dx, 0.0), (0.0, dy)) if abs(way[0] + way[1]) > _SLIDE_SHARE_MIN * step))
        return any(self._load.lead(self._seat, *way) for way in ways)


class CarryRotation:
    """Turning the body and tilting the camera while other bearers may draw the body along."""

    def __init__(self, seat: BodyState, motion: Rotate) -> None:
        self._seat, self._yaw, self._pitch = seat, motion.yaw, motion.pitch
        self._rate = seat.spec.turn_rate * rules.TICK_S

    def advance(self, tick: int) -> TickResult:  # noqa: ARG002
        yaw, pitch = (max(-self._rate, min(self._rate, left)) for left in (self._yaw, self._pitch))
        self._yaw, self._pitch = self._yaw - yaw, self._pitch - pitch
        pose, limit = self._seat.pose, self._seat.spec.pitch_limit
        tilt = max(-limit, min(limit, pose.pitch + pitch))
        self._seat.pose = Pose(x=pose.x, y=pose.y, yaw=wrap(pose.yaw + yaw), pitch=tilt)
        over = abs(self._yaw) < _EPS and abs(self._pitch) < _EPS
        return (Outcome(motion="rotate", ok=True) if over else None), ()
