"""Moving, turning and waiting, tick by tick.

A body moves relative to its heading at the start of the motion, in steps by the law of `hthor.world.motion.steps`. A
head that was turned by a `Drive` keeps its angle to the body in all these motions: a rotation turns both by as much.
"""

import math
from collections.abc import Callable, Iterable, Sequence

from hthor import rules
from hthor.geometry import plane
from hthor.geometry.plane import turn, wrap
from hthor.houses.space import solids
from hthor.houses.space.obstacles import furniture_in_the_way
from hthor.houses.space.solids import Slab
from hthor.types import BodySpec, HouseSpec, Move, Opening, Outcome, Pose, Rotate, Vec2, Wait
from hthor.types.events import Blocked, Event, InWay
from hthor.world import numbers
from hthor.world.motion.steps import EPS, FREE, HOUSE, go, slide
from hthor.world.records import Moving, Rotating, Waiting
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import leaf_rectangle

WAIT_MAX_S = 3600.0
"""[s] The longest single wait."""

_MOVED, _ROTATED, _WAITED = (Outcome(motion=motion, ok=True) for motion in ("move", "rotate", "wait"))

TickResult = tuple[Outcome | None, tuple[Event, ...]]
Culprit = Callable[[BodyState, Vec2], str]
"""Returns the name of the obstacle that a body would hit in a step (dx, dy) [m]."""
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
    pitch, limit = seat.pose.pitch + motion.pitch, pitch_limit(seat.spec, seat.pose)
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
    """Standing still for so many ticks."""

    __slots__ = ("_left",)
    of_hands = False

    def __init__(self, ticks: int) -> None:
        self._left = ticks

    def advance(self, tick: int) -> TickResult:  # noqa: ARG002
        self._left -= 1
        return (None if self._left else _WAITED), ()

    def state(self) -> Waiting:
        return Waiting(self._left)


class RotateMotion:
    """Turning the body, with its head, and tilting the camera, both at the body's turn rate.

    Args:
        begun: the pose at the start. done: for how many ticks it has been going on.
    """

    __slots__ = ("_done", "_from", "_limit", "_motion", "_rate", "_seat", "_ticks")
    of_hands = False

    def __init__(self, seat: BodyState, motion: Rotate, begun: Pose, done: int = 0) -> None:
        self._seat, self._motion, self._from = seat, motion, begun
        self._done, self._rate = done, seat.spec.turn_rate * rules.TICK_S
        self._limit = pitch_limit(seat.spec, begun)
        self._ticks = max(1, math.ceil(max(abs(motion.yaw), abs(motion.pitch)) / self._rate - EPS))

    def advance(self, tick: int) -> TickResult:  # noqa: ARG002
        self._done += 1
        start, most = self._from, self._done * self._rate
        pitch = start.pitch + clip(self._motion.pitch, most)
        yaw = wrap(start.yaw + clip(self._motion.yaw, most))
        self._seat.pose = Pose(x=start.x, y=start.y, yaw=yaw, pitch=clip(pitch, self._limit), head=start.head)
        return (None if self._done < self._ticks else _ROTATED), ()

    def state(self) -> Rotating:
        return Rotating(self._motion, self._from, self._done)


class MoveMotion:
    """Moving along a straight line, as far as the house and the other bodies allow.

    Args:
        others: all other bodies. culprit: returns the name of the obstacle at a place, for the outcome.
        left: the way left [m]. along: its direction. hindered: whether a body has been in the way.
    """

    __slots__ = ("_along", "_culprit", "_hindered", "_left", "_others", "_seat")
    of_hands = False

    def __init__(
        self,
        seat: BodyState,
        others: Sequence[BodyState],
        culprit: Culprit,
        left: float,
        along: Vec2,
        hindered: bool = False,
    ) -> None:
        self._seat, self._others, self._culprit = seat, others, culprit
        self._left, self._along, self._hindered = left, along, hindered

    def advance(self, tick: int) -> TickResult:
        length = min(self._seat.spec.speed * rules.TICK_S, self._left)
        self._left -= length
        dx, dy = self._along[0] * length, self._along[1] * length
        met = go(self._seat, self._others, dx, dy)
        if not met:
            return (None if self._left > EPS else _MOVED), ()
        events = self._in_way(tick, met)
        if not slide(self._seat, self._others, (dx, dy), length):
            return self._stop(tick, met, (dx, dy), events)
        return (None if self._left > EPS else _MOVED), events

    def state(self) -> Moving:
        return Moving(self._left, self._along, self._hindered)

    def _in_way(self, tick: int, met: str) -> tuple[Event, ...]:
        """The event that another body is in the way, at most once per move.

        Its tick is the one before the step: up to that tick the other body had no effect on the move.
        """
        if met in (FREE, HOUSE) or self._hindered:
            return ()
        self._hindered = True
        return (InWay(tick=tick - 1, seat=self._seat.name, by=met),)

    def _stop(self, tick: int, met: str, step: Vec2, events: tuple[Event, ...]) -> TickResult:
        name = self._seat.name
        if met != HOUSE:
            return Outcome(motion="move", ok=False, reason=f"{met} is in the way", by=met), events
        by = self._culprit(self._seat, step)
        outcome = Outcome(motion="move", ok=False, reason="blocked", by=by)
        return outcome, (*events, Blocked(tick=tick, seat=name, by=by))


def length_and_direction(seat: BodyState, motion: Move) -> tuple[float, Vec2]:
    """Length [m] of a move, and its unit vector in the house frame; the zero vector for a move of length zero."""
    length = math.hypot(motion.forward, motion.left)
    x, y = turn((motion.forward, motion.left), seat.pose.yaw)
    return length, (x / length, y / length) if length > 0.0 else (0.0, 0.0)


def duration_ticks(seconds: float) -> int:
    """``seconds`` in whole ticks, rounded up, at least one."""
    return max(1, math.ceil(max(0.0, seconds) / rules.TICK_S - 1e-6))


def clip(value: float, most: float) -> float:
    """``value``, or the nearest number from ``-most`` to ``most``."""
    return max(-most, min(most, value))


def pitch_limit(spec: BodySpec, pose: Pose) -> float:
    """[rad] By how much a camera may be tilted: by the body's limit, or as far as it is already, as measured heads may
    be.
    """
    return max(spec.pitch_limit, abs(pose.pitch))


class ObstacleFootprints:
    """The footprints of a house's walls and furniture."""

    def __init__(self, house: HouseSpec) -> None:
        self._house = house
        self._slabs: dict[float, list[tuple[str, Slab]]] = {}

    def nearest(self, place: Vec2, height: float, shut: Iterable[Opening] = ()) -> str:
        """Id of the thing nearest to ``place`` [m] that stands in the way of a body ``height`` [m] tall, or "wall".

        Args:
            shut: the doorways that are shut now; a shut door is named unless something else is clearly nearer.
        """
        slabs = self._of(height)
        gaps = (
            (plane.distance_to_rectangle(place, slab.centre, slab.size, slab.yaw), index)
            for index, (_, slab) in enumerate(slabs)
        )
        gap, index = min(gaps, default=(0.0, -1))
        for opening in shut:
            x, y, half, deep, yaw = leaf_rectangle(opening)
            if plane.distance_to_rectangle(place, (x, y), (2 * half, 2 * deep), yaw) <= gap + _JAMB_M:
                return opening.id
        return slabs[index][0] if index >= 0 else WALL

    def _of(self, height: float) -> list[tuple[str, Slab]]:
        """What is in the way of a body ``height`` [m] tall, the walls first."""
        if height not in self._slabs:
            walls = [(WALL, slab) for slab in solids.wall_slabs(self._house) if slab.low < height]
            things = [(thing.id, slab) for thing, slab in furniture_in_the_way(self._house, height)]
            self._slabs[height] = walls + things
        return self._slabs[height]
