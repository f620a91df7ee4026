"""Routes for `Actor.go_to` on the house's true floor plan, and the places where they end."""

import functools
import math
from typing import Any

import numpy as np

from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.types import Thing, Vec2
from hthor.world import numbers
from hthor.world.simulation import Simulation
from hthor.world.state import doors
from hthor.world.things import Things

_REACH_SHARES = (0.8, 0.97, 0.9999)
"""How close a body goes to a thing, as shares of its reach. If it cannot see and use the thing from a place within one
share, the next share is tried. The margins absorb rounding to grid cells."""
_FAR_SHARE = _REACH_SHARES[1]
_ARMLESS_M = 1.0
"""[m] What counts as the reach of a body without hands."""
_SHORT_M = 0.3
"""[m] A walk that ends this much farther from the target than the house requires has a body in its way."""
_BESIDE_M = 1.0
"""[m] How near a body has to come to a place that another body occupies."""
_ROUND = ((1.0, 0.5), (0.87, 0.8), (0.6, 1.0))
"""Half sides of three rectangles that together cover a disc of radius 1."""
_MARGIN_M = 0.04
"""[m] Half the diagonal of a cell: paths may cross a free cell anywhere, but only its middle is tested."""
_TRIES = 100
"""About how many places around a body, or within reach of an object, are tried before all of them are."""


class WalkPlanner:
    """Plans the walks of one simulation's bodies to places and things."""

    def __init__(self, simulation: Simulation, things: Things) -> None:
        self._simulation, self._things = simulation, things

    def route(self, seat: str, target: str | Vec2) -> tuple[Vec2, ...]:
        """The corners [m] of the shortest way of a seat's body to a place, or to one from which a thing is in reach.

        Raises:
            UnknownName: when nothing has this id. HthorError: when the place is in no room, or the body cannot move.
        """
        pose = self._simulation.pose(seat)
        paths = Geodesics(self._space_around_others(seat))
        space, here = paths.space, (pose.x, pose.y)
        if not space.is_free(*here):
            here = self._nearest_free_floor(seat, space)
        goal = self._standing_place(seat, paths, here, target) if isinstance(target, str) else self._indoors(target)
        path = paths.path(here, space.nearest_free(*goal, within=space.component(*here)))
        return tuple(path if here != (pose.x, pose.y) else path[1:])

    def body_in_the_way(self, seat: str, target: str | Vec2) -> str:
        """The seat whose body kept another one, at the end of its route, away from the target; empty for none."""
        if self._detour(seat, target) <= _SHORT_M:
            return ""
        pose = self._simulation.pose(seat)
        others = {name: other for name, other in self._simulation.poses().items() if name != seat}
        return min(others, key=lambda name: math.dist((others[name].x, others[name].y), (pose.x, pose.y)))

    def hindrance(self, seat: str, target: str) -> str:
        """Why a body, from where it is, does not have the thing that it walked to in reach and in sight, or cannot use
        it; empty when it has and can.
        """
        pose, reach = self._simulation.pose(seat), self._reach(seat)
        far = float(self._distances(target, np.array([(pose.x, pose.y)]))[0])
        reason = self._things.hindrance(seat, target)
        if not reason and far > reach and not self._is_object(target):
            reason = f"{target} is {far:.2f} m away; reach is {reach:.2f} m"
        if not reason and not self._picks(seat, target) and not self._things.in_sight(seat, target):
            reason = f"{target} is out of sight"
        states = {state.id: state for state in self._simulation.truth()}
        inside = states.get(states[target].support) if target in states else None
        closed = inside is not None and not inside.open and reason.endswith("out of sight")
        return f"{reason}; {states[target].support} is closed" if closed else reason

    def _picks(self, seat: str, target: str) -> bool:
        """Whether a body can pick up the target, the rules of which have their own test of sight."""
        return self._is_object(target) and "pick" in self._simulation.bodies[seat].capabilities

    def _reach(self, seat: str) -> float:
        return self._simulation.bodies[seat].reach or _ARMLESS_M

    def _is_object(self, target: str) -> bool:
        """Whether ``target`` is an object, not furniture or a body."""
        return any(state.id == target for state in self._things.objects())

    def _detour(self, seat: str, target: str | Vec2) -> float:
        """How much nearer [m] the body could be if it were alone in the house."""
        if len(self._simulation.seats) == 1:
            return 0.0
        pose, space = self._simulation.pose(seat), self._simulation.space[seat]
        alone = space.component(*space.nearest_free(pose.x, pose.y))
        here = np.array([(pose.x, pose.y)])
        if not isinstance(target, str):
            goal = space.nearest_free(*target, within=alone)
            return math.dist((pose.x, pose.y), goal) - (_BESIDE_M if self._is_taken(seat, goal) else 0.0)
        enough = max(_FAR_SHARE * self._reach(seat), float(self._distances(target, space.centres(alone)).min()))
        return float(self._distances(target, here)[0]) - enough

    def _is_taken(self, seat: str, goal: Vec2) -> bool:
        """Whether another body stands at the goal; then a place next to that body is good enough."""
        others = [
            (self._simulation.pose(name), self._simulation.bodies[name].radius)
            for name in self._simulation.seats
            if name != seat
        ]
        reach = _SHORT_M + self._simulation.bodies[seat].radius
        return any(math.dist((pose.x, pose.y), goal) < reach + radius for pose, radius in others)

    def _indoors(self, target: Vec2) -> Vec2:
        x, y = target
        if not any(plane.inside((x, y), room.polygon) for room in self._simulation.house.rooms):
            place = f"({numbers.format_number(x)}, {numbers.format_number(y)})"
            raise HthorError(f"{place} is in no room of the house; give a point indoors, or the id of a thing")
        return (x, y)

    def _nearest_free_floor(self, seat: str, space: FreeSpace) -> Vec2:
        """The nearest free floor that a body close to others reaches in a straight line without touching them."""
        pose = self._simulation.pose(seat)
        places = space.centres(space.free)
        order = np.argsort(np.hypot(places[:, 0] - pose.x, places[:, 1] - pose.y), kind="stable")[:_TRIES]
        others = [
            (self._simulation.pose(name), self._simulation.bodies[name].radius)
            for name in self._simulation.seats
            if name != seat
        ]
        for x, y in places[order].tolist():
            way = np.linspace((pose.x, pose.y), (x, y), 20)
            gaps = (np.hypot(way[:, 0] - other.x, way[:, 1] - other.y).min() - radius for other, radius in others)
            if all(gap >= self._simulation.bodies[seat].radius for gap in gaps):
                return (x, y)
        return space.nearest_free(pose.x, pose.y)

    def _space_around_others(self, seat: str) -> FreeSpace:
        """The floor that is free for this body while the others stay where they are."""
        rows = []
        for name, pose in self._simulation.poses().items():
            if name != seat:
                radius = self._simulation.bodies[name].radius + _MARGIN_M
                rows += [(pose.x, pose.y, a * radius, b * radius, 0.0) for a, b in _ROUND]
        return doors.with_obstacles(self._simulation.space[seat], rows)

    def _standing_place(self, seat: str, paths: Geodesics, here: Vec2, target: str) -> Vec2:
        """The place, by the shortest walk, from which ``target`` is in reach, in sight and can be used.

        Places in front of furniture are preferred, then those close to it, and of these those from which the camera can
        show it. If there is no such place, one from which it is at least in sight, or else the nearest.
        """
        places = paths.space.centres(paths.space.component(*here))
        if not len(places):
            raise HthorError(f"{seat} stands where it cannot move")
        gaps = self._distances(target, places)
        within = gaps <= max(_REACH_SHARES[-1] * self._reach(seat), float(gaps.min()) + 1e-9)
        places, gaps = places[within], gaps[within]
        order = np.argsort(paths.distances(here, places), kind="stable")
        places, gaps = places[order], gaps[order]
        front, rings = self._in_front(target, places), []
        for ahead in (front, ~front) if front.any() else (~front,):
            for share in _REACH_SHARES:
                near = ahead & (gaps <= max(share * self._reach(seat), float(gaps.min()) + 1e-9))
                rings.append(places[near])

        @functools.cache  # a wider ring has the places of the narrower ones, too
        def hindered(place: Vec2) -> bool:
            return bool(self._things.hindrance(seat, target, place))

        @functools.cache
        def seen(place: Vec2) -> bool:
            return self._things.in_sight(seat, target, place)

        @functools.cache
        def shown(place: Vec2) -> bool:
            return self._things.in_sight(seat, target, place, picture=True) and not hindered(place)

        def usable(place: Vec2) -> bool:
            return not hindered(place) and (self._picks(seat, target) or seen(place))

        for good in (shown, usable, seen):
            for near in rings:
                for stride in {max(1, len(near) // _TRIES): 0, 1: 0}:  # first a few places, then all
                    for x, y in near[::stride].tolist():
                        if good((x, y)):
                            return (x, y)
        x, y = next(ring for ring in rings if len(ring))[0].tolist()
        return (x, y)

    def _distances(self, target: str, places: Any) -> Any:
        """(N,) distances [m] from ``places`` (N, 2) to a thing's footprint, or to an object's or body's middle."""
        thing = next((thing for thing in self._things.furniture() if thing.id == target), None)
        x, y, _ = self._things.position(target)
        if thing is None:
            return np.hypot(places[:, 0] - x, places[:, 1] - y)
        u, v = _local(thing, places)
        return np.hypot(np.maximum(np.abs(u) - thing.size[0] / 2, 0.0), np.maximum(np.abs(v) - thing.size[1] / 2, 0.0))

    def _in_front(self, target: str, places: Any) -> Any:
        """(N,) bool, whether places (N, 2) are straight in front of a piece of furniture; false for all else."""
        thing = next((thing for thing in self._things.furniture() if thing.id == target), None)
        if thing is None:
            return np.zeros(len(places), bool)
        u, v = _local(thing, places)
        return (v > 0.0) & (np.abs(u) <= thing.size[0] / 2)


def _local(thing: Thing, places: Any) -> tuple[Any, Any]:
    """Places (N, 2) in the frame of a thing: to its right and to its front [m]."""
    (x, y, _), cos, sin = thing.centre, math.cos(thing.yaw), math.sin(thing.yaw)
    dx, dy = places[:, 0] - x, places[:, 1] - y
    return cos * dx + sin * dy, cos * dy - sin * dx
