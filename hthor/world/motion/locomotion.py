"""Moving, turning and waiting, tick by tick.

A body moves relative to its heading at the start of the motion. Where the way ahead is blocked it slides along x or y;
where both are blocked it stops. Other bodies are discs: no body may come closer to another than the sum of their radii,
but a body that is too close already may always move away.
"""

import math
from collections.abc import Callable, Iterable, Sequence

from hthor import rules
from hthor.geometry import plane
from hthor.geometry.plane import turn, wrap
from hthor.houses.space import solids
from hthor.houses.space.free_space import STEP_M
from hthor.types import Event, HouseSpec, Move, Opening, Outcome, Pose, Rotate, Vec2, Wait
from hthor.world import numbers
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import leaf_rectangle

EPS = 1e-9
"""[m, rad, ticks] Tolerance for rounding."""
WAIT_MAX_S = 3600.0
"""[s] The longest single wait."""
SLIDE_SHARE_MIN = 0.05
"""A body slides only if at least this share of the step lies along the axis; our choice."""
_FREE, _BLOCKED = "", "*"
"""What blocks a step: nothing or the house; any other value is the seat in the way."""

_MOVED, _ROTATED, _WAITED = (Outcome(motion=motion, ok=True) for motion in ("move", "rotate", "wait"))

TickResult = tuple[Outcome | None, tuple[Event, ...]]
WALL = "wall"
_JAMB_M = 0.05
"""[m] A wall may be nearer than a shut door by this much, and the door is still named as the obstacle."""


def refusal(seat: BodyState, motion: Move | Rotate | Wait) -> str:
    """Why the motion cannot be started, empty when it can."""
    if isinstance(motion, Wait):
        reason = "" if _is_plain(motion.seconds) else _finite(seconds=motion.seconds)
        if not reason and motion.seconds > WAIT_MAX_S:
            return f"wait is {numbers.format_number(motion.seconds)} s long; at most {WAIT_MAX_S:.0f} s"
        return reason
    if "navigate" not in seat.spec.capabilities:
        return f"{seat.spec.title} cannot move"
    if isinstance(motion, Move):
        plain = _is_plain(motion.forward) and _is_plain(motion.left)
        reason = "" if plain else _finite(forward=motion.forward, left=motion.left)
        length = 0.0 if reason else math.hypot(motion.forward, motion.left)
        if length > rules.MOVE_MAX_M + EPS:
            return f"move is {numbers.format_number(length)} m long; at most {rules.MOVE_MAX_M:.2f} m"
        return reason
    plain = _is_plain(motion.yaw) and _is_plain(motion.pitch)
    reason = "" if plain else _finite(yaw=motion.yaw, pitch=motion.pitch)
    if reason:
        return reason
    if abs(motion.yaw) > 2 * math.pi + EPS:
        return f"rotation is {numbers.format_number(motion.yaw)} rad; at most one full turn, {2 * math.pi:.2f} rad"
    pitch, limit = seat.pose.pitch + motion.pitch, seat.spec.pitch_limit
    if abs(pitch) > limit + EPS:
        return f"camera pitch would be {numbers.format_number(pitch)} rad; at most {limit:.2f} rad up or down"
    return ""


def _is_plain(value: object) -> bool:
    return type(value) is float and math.isfinite(value)


def _finite(**given: object) -> str:
    for name, value in given.items():
        if not numbers.is_finite(value):
            return f"{name} must be a finite number, got {numbers.quoted(value)}"
    return ""


class WaitMotion:
    """Standing still."""

    def __init__(self, motion: Wait) -> None:
        self._left = duration_ticks(motion.seconds)

    def advance(self, tick: int) -> TickResult:  # noqa: ARG002
        self._left -= 1
        return (None if self._left else _WAITED), ()


class RotateMotion:
    """Turning the body and tilting the camera, both at the body's turn rate."""

    def __init__(self, seat: BodyState, motion: Rotate) -> None:
        self._seat, self._motion, self._from = seat, motion, seat.pose
        self._done, self._rate = 0, seat.spec.turn_rate * rules.TICK_S
        self._ticks = max(1, math.ceil(max(abs(motion.yaw), abs(motion.pitch)) / self._rate - EPS))

    def advance(self, tick: int) -> TickResult:  # noqa: ARG002
        self._done += 1
        start, most = self._from, self._done * self._rate
        limit = self._seat.spec.pitch_limit
        pitch = start.pitch + _clip(self._motion.pitch, most)
        yaw = wrap(start.yaw + _clip(self._motion.yaw, most))
        self._seat.pose = Pose(x=start.x, y=start.y, yaw=yaw, pitch=_clip(pitch, limit))
        return (None if self._done < self._ticks else _ROTATED), ()


class MoveMotion:
    """Moving along a straight line, as far as the house and the other bodies allow.

    Args:
        others: all other bodies. culprit: returns the name of the obstacle at a place, for the outcome.
    """

    def __init__(
        self, seat: BodyState, motion: Move, others: Sequence[BodyState], culprit: Callable[[BodyState, Vec2], str]
    ) -> None:
        self._seat, self._others, self._culprit = seat, others, culprit
        self._left, self._along = length_and_direction(seat, motion)
        self._hindered = False

    def advance(self, tick: int) -> TickResult:
        step = min(self._seat.spec.speed * rules.TICK_S, self._left)
        self._left -= step
        dx, dy = self._along[0] * step, self._along[1] * step
        met = self._try(dx, dy)
        if not met:
            return (None if self._left > EPS else _MOVED), ()
        events = self._in_way(tick, met)
        if self._slide(dx, 0.0, step) and self._slide(0.0, dy, step):
            return self._stop(tick, met, (dx, dy), events)
        return (None if self._left > EPS else _MOVED), events

    def _try(self, dx: float, dy: float) -> str:
        """Go by (dx, dy) [m] if that place is free; else returns what is in the way."""
        pose = self._seat.pose
        x, y = pose.x + dx, pose.y + dy
        for other in self._others:
            if _too_close(self._seat, other, x, y):
                return other.name
        if not self._seat.space.segment_free((pose.x, pose.y), (x, y)):
            return _BLOCKED
        self._seat.pose = Pose(x=x, y=y, yaw=pose.yaw, pitch=pose.pitch)
        return _FREE

    def _slide(self, dx: float, dy: float, step: float) -> str:
        """Try one axis of a step, unless the step is nearly perpendicular to it."""
        return self._try(dx, dy) if abs(dx + dy) > SLIDE_SHARE_MIN * step else _BLOCKED

    def _in_way(self, tick: int, met: str) -> tuple[Event, ...]:
        """The event that another body is in the way, at most once per move.

        Its tick is the one before the step: up to that tick the other body had no effect on the move.
        """
        if met in (_FREE, _BLOCKED) or self._hindered:
            return ()
        self._hindered = True
        return (Event(tick=tick - 1, seat=self._seat.name, kind="in_way", data={"by": met}),)

    def _stop(self, tick: int, met: str, step: Vec2, events: tuple[Event, ...]) -> TickResult:
        name = self._seat.name
        if met != _BLOCKED:
            return Outcome(motion="move", ok=False, reason=f"{met} is in the way", by=met), events
        by = self._culprit(self._seat, step)
        outcome = Outcome(motion="move", ok=False, reason="blocked", by=by)
        return outcome, (*events, Event(tick=tick, seat=name, kind="blocked", data={"by": by}))


def length_and_direction(seat: BodyState, motion: Move) -> tuple[float, Vec2]:
    """Length [m] of a move, and its unit vector in the house frame; the zero vector for a move of length zero."""
    length = math.hypot(motion.forward, motion.left)
    x, y = turn((motion.forward, motion.left), seat.pose.yaw)
    return length, (x / length, y / length) if length > 0.0 else (0.0, 0.0)


def duration_ticks(seconds: float) -> int:
    """``seconds`` in whole ticks, rounded up, at least one."""
    return max(1, math.ceil(max(0.0, seconds) / rules.TICK_S - 1e-6))


def _clip(value: float, most: float) -> float:
    return max(-most, min(most, value))


def _too_close(seat: BodyState, other: BodyState, x: float, y: float) -> bool:
    there, least = other.pose, seat.spec.radius + other.spec.radius - EPS
    dx, dy = x - there.x, y - there.y
    if abs(dx) >= least or abs(dy) >= least or math.hypot(dx, dy) >= least:
        return False
    return math.hypot(dx, dy) < math.hypot(seat.pose.x - there.x, seat.pose.y - there.y)


class ObstacleFootprints:
    """The footprints of a house's walls and furniture."""

    def __init__(self, house: HouseSpec) -> None:
        self._slabs = [(WALL, slab) for slab in solids.wall_slabs(house)]
        self._slabs += [(thing.id, slab) for thing, slab in solids.furniture_slabs(house) if slab.high > STEP_M]

    def nearest(self, place: Vec2, height: float, shut: Iterable[Opening] = ()) -> str:
        """Id of the thing nearest to ``place`` [m] that stands in the way of a body ``height`` [m] tall, or "wall".

        Args:
            shut: the doorways that are shut now; a shut door is named unless something else is clearly nearer.
        """
        gaps = (
            (plane.distance_to_rectangle(place, slab.centre, slab.size, slab.yaw), index)
            for index, (_, slab) in enumerate(self._slabs)
            if slab.low < height
        )
        gap, index = min(gaps, default=(0.0, -1))
        for opening in shut:
            x, y, half, deep, yaw = leaf_rectangle(opening)
            if plane.distance_to_rectangle(place, (x, y), (2 * half, 2 * deep), yaw) <= gap + _JAMB_M:
                return opening.id
        return self._slabs[index][0] if index >= 0 else WALL
