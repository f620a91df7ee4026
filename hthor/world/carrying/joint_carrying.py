"""Rules of joint carrying: several bodies lift a thing that is too heavy for one of them by its handles.

A thing with handles (`hthor.catalog.Kind.handles`, such as a trunk) has one at either end of its length. A body that is
not strong enough to take the thing in hand takes hold of a handle instead, with the same action:

- ``Pick(object=...)`` takes hold of the free handle nearest to the body. The usual rules apply (the body can pick, its
  hands are empty, the handle is in reach and in front, the thing in sight), but the weight does not matter, and the
  body must not stand on the thing. The outcome is ok, the event is ``held``, ``Observation.holding`` the thing's id.
- By a handle, a body lifts `rules.HANDLE_STRENGTH` times its ``strength``. When all bearers together can lift its mass,
  the thing rises: the event ``lifted`` names its ``bearers``. Until then it stays on the floor, and a bearer may turn,
  wait, or let go; a ``Move`` is refused, and the outcome's reason states the mass and what the bearers can lift.
- While the thing is up, a ``Move`` of any bearer carries it along. The other bearers are drawn along by their handles,
  no faster than they walk, while they wait, turn or look around. If several bearers move in the same tick, the first
  in the order of the seats leads, the person before all robots. All bearers move at `rules.HANDLE_PACE` times the speed
  of the slowest.
- Every body stays on its own free floor, and the thing, as a rectangle, touches no wall, furniture, shut door or other
  body. A step that would take a handle out of its bearer's reach or push the thing into an obstacle is not taken: the
  move ends ``blocked``, as it does for a body alone.
- ``Drop()`` by any bearer lets go. If the other bearers are too weak, the thing is put down where it is and nobody
  holds it: event ``lowered``. If it was not up yet, only that body lets go: event ``released``. ``Place(on="floor")``
  does the same; the thing cannot be placed on furniture.

In true states and detections, ``bearers`` names all seats that hold the thing, in the order in which they took hold;
``held_by`` is empty while the thing is on the floor and names the first bearer while it is up.

The thing follows like a trailer: a leader who pulls can take it round corners, one who pushes moves it straight ahead
only. The leader should take the handle at the end where the route begins and, where possible, use floor on which a disc
of 0.40 m radius has room.
"""

import math
from collections.abc import Iterable, Sequence

import msgspec
import numpy as np

from hthor import catalog, rules
from hthor.geometry import plane
from hthor.geometry.plane import wrap
from hthor.geometry.ray_casting import Floats
from hthor.houses.space import free_space
from hthor.types import HouseSpec, Outcome, Vec2, Vec3
from hthor.types.events import Blocked, Event, Held, InWay, Lifted, Lowered, Released
from hthor.world.carrying.load import LIFT_M
from hthor.world.carrying.trailer import TrailerLoad
from hthor.world.motion.driving import LOAD
from hthor.world.motion.locomotion import Culprit, TickResult, clip, pitch_limit
from hthor.world.motion.reach import out_of_reach
from hthor.world.motion.steps import EPS, FREE, HOUSE, SLIDE_SHARE_MIN
from hthor.world.records import LoadRecord, Moving, Turning
from hthor.world.state.body_state import BodyState
from hthor.world.state.doors import Doors, leaf_rectangle
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.objects import Objects
from hthor.world.state.overlap_test import OverlapTest

_LOWER_STEP_M = 0.01
"""[m] Step of the search, from the floor up, for a free height at which a thing is put down."""
_STANDING_ON_M = 0.05
"""[m] How far a body's disc may overlap a thing on the floor when it takes hold of a handle."""
_CARRY_HEIGHT_M = 1.0
"""[m] Obstacles that begin higher above the floor are not in the way of a carried thing."""


class JointCarrying:
    """The things that bodies of one world hold by their handles."""

    def __init__(
        self, house: HouseSpec, objects: Objects, doors: Doors, overlap: OverlapTest, seats: Sequence[BodyState]
    ) -> None:
        self._house, self._objects, self._doors, self._overlap = house, objects, doors, overlap
        self._seats = tuple(seats)
        self._loads: dict[str, TrailerLoad] = {}
        self._fixed: Floats | None = None

    def reset(self) -> None:
        """Begin an episode: nobody holds anything."""
        self._loads.clear()

    def records(self) -> tuple[LoadRecord, ...]:
        """The things that are held by handles."""
        return tuple(load.record() for load in self._loads.values())

    def restore(self, records: Iterable[LoadRecord]) -> None:
        """Go back to these things."""
        self._loads.clear()
        for record in records:
            self._loads[record.item] = self.load(record.item)
            self._loads[record.item].restore(record)

    def load(self, id: str) -> TrailerLoad:
        """The thing with this id as a load; a new one if nobody holds it."""
        known, item = self._loads.get(id), self._objects.known(id)
        assert item is not None, "only objects are carried"
        return known or TrailerLoad(item, self._seats, self._obstacles)

    def of(self, seat: BodyState) -> TrailerLoad | None:
        """The thing that ``seat`` holds by a handle; None for none."""
        load = self._loads.get(seat.holding)
        return load if load is not None and seat.name in load.ends else None

    @staticmethod
    def takes(seat: BodyState, item: MovableObject) -> bool:
        """Whether ``seat`` can take the object only by a handle: it is too heavy, or others hold it by a handle."""
        return catalog.kind(item.kind).handles and (item.mass > seat.spec.strength or bool(item.bearers))

    def refusal(self, seat: BodyState, item: MovableObject) -> str:
        """Why ``seat`` cannot take hold of the thing, empty when it can."""
        load = self._loads.get(item.id)
        if load is not None and len(load.ends) == 2:
            return f"both handles of {item.id} are taken, by {' and '.join(load.ends)}"
        x, y, _ = item.position
        gap = plane.distance_to_rectangle((seat.pose.x, seat.pose.y), (x, y), item.size[:2], item.yaw)
        if gap < seat.spec.radius - _STANDING_ON_M:
            return f"{seat.name} stands on {item.id}; step back from it"
        return out_of_reach(seat, f"the handle of {item.id}", self._handle(seat, item)[1])

    def stuck(self, seat: BodyState) -> str:
        """Why ``seat`` cannot move because of the thing that it holds; empty when it can."""
        load = self.of(seat)
        if load is None or load.up:
            return ""
        weight = f"{load.item.id} weighs {load.item.mass:.1f} kg; {load.holders} {load.lifted:.1f} kg by its handles"
        return f"{weight}: wait until somebody helps, or let go"

    def pace(self, seat: BodyState) -> float | None:
        """[m/s] The speed at which ``seat`` goes with the thing that it holds by a handle; None if it holds none so."""
        load = self.of(seat)
        return None if load is None else load.pace

    def go(self, seat: BodyState, step: Vec2, length: float, tick: int) -> tuple[str, bool]:
        """See `hthor.world.motion.driving.JointLoads`."""
        load = self.of(seat)
        assert load is not None, "asked before"
        return go_with_load(seat, load, step, length, tick) if load.up else (LOAD, True)

    def hold(self, seat: BodyState, item: MovableObject, tick: int) -> tuple[Event, ...]:
        """Take hold of the nearest free handle; the thing rises if its bearers are strong enough."""
        load = self._loads[item.id] = self.load(item.id)
        load.ends[seat.name] = self._handle(seat, item)[0]
        seat.holding = item.id
        self._objects.grip(item.id, tuple(load.ends))
        held = Held(tick=tick, seat=seat.name, object=item.id)
        if load.up or load.lifted < item.mass:
            return (held,)
        load.up, load.z = True, LIFT_M + item.size[2] / 2
        self._objects.take(item.id, next(iter(load.ends)), load.pose)
        return held, Lifted(tick=tick, seat=seat.name, object=item.id, bearers=tuple(load.ends))

    def release(self, seat: BodyState, tick: int) -> tuple[Event, ...]:
        """Let go; if the other bearers are too weak, the thing is put down."""
        load = self.of(seat)
        if load is None:
            return ()
        names, name, object_ = tuple(load.ends), seat.name, load.item.id
        del load.ends[seat.name]
        seat.holding = ""
        if load.up and load.lifted < load.item.mass:
            for other in load.bearers:
                other.holding = ""
            load.ends.clear()
            self._lower(load)
            news: Event = Lowered(tick=tick, seat=name, object=object_, bearers=names)
        else:
            news = Released(tick=tick, seat=name, object=object_)
        if not load.ends:
            del self._loads[object_]
        self._objects.grip(object_, tuple(load.ends))
        return (news,)

    def _obstacles(self) -> Floats:
        """Rectangles (N, 5) that are in the way of a carried thing now, see `hthor.world.carrying.trailer_kernel`."""
        if self._fixed is None:
            self._fixed = free_space.obstacle_rectangles(self._house, _CARRY_HEIGHT_M)
        shut = [leaf_rectangle(opening) for opening in self._doors.shut().values()]
        return np.concatenate((self._fixed, np.array(shut))) if shut else self._fixed

    def _lower(self, load: TrailerLoad) -> None:
        """Put the thing down where it is, on the floor or on objects that lie there."""
        item, top = load.item, load.z
        low = item.size[2] / 2 + _LOWER_STEP_M / 10
        for step in range(math.ceil((top - low) / _LOWER_STEP_M)):
            load.z = low + step * _LOWER_STEP_M
            self._objects.follow(item.id)
            if not self._overlap.inside(item):
                break
        else:
            load.z = top
        self._objects.put(item.id, load.pose(), "")

    def _handle(self, seat: BodyState, item: MovableObject) -> tuple[int, Vec3]:
        """The free handle nearest to a body: which end, and its position [m]."""
        load = self.load(item.id)
        here = (seat.pose.x, seat.pose.y)
        ends = [end for end in (1, -1) if end not in load.ends.values()]
        places = [(end, load.handle(end)) for end in ends]
        return min(places, key=lambda place: math.dist(place[1][:2], here))


class CarryMotion:
    """Moving with a load along a straight line, as far as the house, the other bodies and the load allow.

    Args:
        culprit: names the obstacle at a place, for the outcome. left: the way left [m]. along: its direction.
    """

    of_hands = False

    def __init__(self, seat: BodyState, load: TrailerLoad, culprit: Culprit, left: float, along: Vec2) -> None:
        self._seat, self._load, self._culprit = seat, load, culprit
        self._left, self._along = left, along

    def advance(self, tick: int) -> TickResult:
        seat, load = self._seat, self._load
        if seat.name not in load.ends:
            return Outcome(motion="move", ok=False, reason=f"{load.item.id} was put down"), ()
        length = min(load.pace * rules.TICK_S, self._left)
        self._left -= length
        step = self._along[0] * length, self._along[1] * length
        met, stuck = go_with_load(seat, load, step, length, tick)
        if stuck:
            return self._stop(tick, met, step)
        return (None if self._left > EPS else Outcome(motion="move", ok=True)), ()

    def state(self) -> Moving:
        return Moving(self._left, self._along, load=self._load.item.id)

    def _stop(self, tick: int, met: str, step: Vec2) -> TickResult:
        by = self._culprit(self._seat, step) if met == HOUSE else met
        reason = "blocked" if met == HOUSE else f"{met} is in the way"
        outcome = Outcome(motion="move", ok=False, reason=reason, by=by)
        kind = Blocked if met == HOUSE else InWay
        return outcome, (kind(tick=tick, seat=self._seat.name, by=by),)


def go_with_load(seat: BodyState, load: TrailerLoad, step: Vec2, length: float, tick: int) -> tuple[str, bool]:
    """Lead the load by ``step`` [m], ``length`` long, straight on or else along one axis, unless the step is nearly
    perpendicular to it; with another leader in this tick, wait.

    Returns:
        what is in the way, and whether the body had to stay where it was.
    """
    if length <= 0.0 or load.follows(seat, tick):
        return FREE, False
    dx, dy = step
    least = SLIDE_SHARE_MIN * length
    ways = (step, *(way for way in ((dx, 0.0), (0.0, dy)) if abs(way[0] + way[1]) > least))
    if any(load.lead(seat, *way) for way in ways):
        return FREE, False
    return load.body_in_the_way(seat) or HOUSE, True


class CarryRotation:
    """Turning the body and tilting the camera by angles [rad] while other bearers may draw the body along."""

    of_hands = False

    def __init__(self, seat: BodyState, yaw: float, pitch: float) -> None:
        self._seat, self._yaw, self._pitch = seat, yaw, pitch
        self._rate = seat.spec.turn_rate * rules.TICK_S

    def advance(self, tick: int) -> TickResult:  # noqa: ARG002
        yaw, pitch = (clip(left, self._rate) for left in (self._yaw, self._pitch))
        self._yaw, self._pitch = self._yaw - yaw, self._pitch - pitch
        pose = self._seat.pose
        tilt = clip(pose.pitch + pitch, pitch_limit(self._seat.spec, pose))
        self._seat.pose = msgspec.structs.replace(pose, yaw=wrap(pose.yaw + yaw), pitch=tilt)
        over = abs(self._yaw) < EPS and abs(self._pitch) < EPS
        return (Outcome(motion="rotate", ok=True) if over else None), ()

    def state(self) -> Turning:
        return Turning(self._yaw, self._pitch)
