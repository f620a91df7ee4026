"""Tries out where pushed objects go, before anything is moved.

An object that is in the way of a body is shifted out of its disc, by the shortest way or, where that is blocked, at an
angle to it. What it then overlaps is shifted by as much, if it is light enough as well. A shift is taken only if
nothing comes to be in a wall, in furniture, in another object, in another body, or outdoors.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from hthor.geometry import convex, plane
from hthor.houses.space.obstacles import STEP_M
from hthor.types import HouseSpec, Vec2
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.geom_index import GeomIndex
from hthor.world.state.body_state import BodyState
from hthor.world.state.footprint import Footprint, footprint
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.objects import Objects
from hthor.world.state.overlap_test import OverlapTest

PUSH_MAX_N = 20.0
"""[N] The most force with which a body pushes what is in its way; our choice, small beside the 130 N that ISO/TS 15066
allows a robot to press against a person's shin.
"""
FRICTION = 1.0
"""Sliding friction of objects on the floor, as the engine counts it: the greater of the floor's and the object's."""
LIGHT_KG = PUSH_MAX_N / (FRICTION * 9.81)
"""[kg] The most that a body pushes at once, 2.04 kg: all small things of the catalogue but the dumbbell, no trunk."""
TOUCH_M = 0.001
"""[m] A body may be this deep in an object's footprint."""
DEEP_M = 0.002
"""[m] A pushed object may be this deep in another solid: things at rest are up to a millimetre deep in one another."""
_GAP_M = 5e-4
"""[m] Gap between a body and what it has pushed away."""
_ANGLES = tuple(math.radians(angle) for angle in (0, 20, -20, 40, -40, 60, -60, 75, -75))
"""[rad] Directions in which an object is pushed, off the shortest way out, in the order in which they are tried."""
_ROUNDS = 4
"""How often all objects in the way are looked through until none is in the way."""
_OUTDOORS_M = 0.1
"""[m] How far outside all rooms the middle of an object may be, as in a doorway."""


class Floor(NamedTuple):
    """What a plan looks at: the house, the engine, the objects and the bodies."""

    house: HouseSpec
    env: LazyComposerEnv
    geoms: GeomIndex
    objects: Objects
    overlap: OverlapTest
    seats: Sequence[BodyState]


class PushPlan:
    """A number of shifts of objects, which `Floor.env` does not know of until `commit`; otherwise `undo` has to follow.

    Attributes:
        shifts: object -> its shift [m] so far.
    """

    def __init__(self, floor: Floor) -> None:
        self._floor = floor
        self._prints: dict[MovableObject, Footprint] = {}
        self._begun: dict[MovableObject, Any] = {}
        self.shifts: dict[MovableObject, Vec2] = {}

    def where(self, item: MovableObject) -> Footprint:
        """The object's footprint after its shift."""
        if item not in self._prints:
            self._prints[item] = footprint(item, self._floor.env, self._floor.geoms)
        shift = self.shifts.get(item)
        return self._prints[item].moved(shift) if shift else self._prints[item]

    def clear(
        self, seat: BodyState, place: Vec2, items: Sequence[MovableObject], free: MovableObject | None = None
    ) -> str:
        """Shift objects out of the way of a body at ``place`` [m].

        Args:
            items: the objects that may be in the way. free: one that may be shifted whatever its mass.

        Returns:
            the id of an object that is in the way and stays there; empty for none. The body may be in an object, except
            ``free``, as deep as it is already at its pose.
        """
        for _ in range(_ROUNDS):
            found = [item for item in items if self._depths(seat, place, item, free)[0] > TOUCH_M]
            for item in found:
                if not self._push(seat, place, item, free):
                    return item.id
            if not found:
                return ""
        depths = ((item.id, *self._depths(seat, place, item, free)) for item in items)
        return next((id for id, deep, least in depths if deep > least), "")

    def commit(self, velocity: Mapping[MovableObject, Sequence[float]]) -> None:
        """Move the objects, each with its new velocity (6,) [m/s, rad/s]."""
        data, shifted = self._floor.env.data, sorted(self.shifts, key=lambda item: item.number)
        for item in shifted:
            data.geom_xpos[item.geoms, :2] = self._begun[item]
        self._floor.objects.wake_beside(geom for item in shifted for geom in range(item.geoms.start, item.geoms.stop))
        for item in shifted:
            (dx, dy), (x, y, *rest) = self.shifts[item], data.qpos[item.qpos : item.qpos + 7].tolist()
            self._floor.objects.shove(item, (x + dx, y + dy, *rest), velocity[item])
        self._floor.env.touch()

    def undo(self) -> None:
        """Forget all shifts."""
        for item in tuple(self.shifts):
            self._place(item, None)

    def shift(self, item: MovableObject, by: Vec2) -> None:
        """Shift one object [m], whatever is there."""
        dx, dy = self.shifts.get(item, (0.0, 0.0))
        self._place(item, (dx + by[0], dy + by[1]))

    def _depths(self, seat: BodyState, place: Vec2, item: MovableObject, free: MovableObject | None) -> Vec2:
        """How deep [m] a body at ``place`` would be in the object, and how deep it may be."""
        now = self.where(item)
        if now.low >= seat.spec.height or (now.high <= STEP_M and item.mass > LIGHT_KG):
            return 0.0, 0.0
        deep = now.depth(place, seat.spec.radius)
        if deep <= TOUCH_M or item is free:
            return deep, TOUCH_M
        first = self._prints[item].depth((seat.pose.x, seat.pose.y), seat.spec.radius)
        return deep, max(TOUCH_M, first + 1e-9)

    def _push(self, seat: BodyState, place: Vec2, item: MovableObject, free: MovableObject | None) -> bool:
        """Shift an object out of the way; whether the body may be at ``place`` afterwards."""
        deep, way = convex.disc_overlap(place, seat.spec.radius, self.where(item).outline)
        if deep <= TOUCH_M:
            return True  # moved out of the way with another one
        for angle in _ANGLES if item is free or item.mass <= LIGHT_KG else ():
            far = (deep + _GAP_M) / math.cos(angle)
            x, y = plane.turn(way, angle)
            if self._shift_all(item, (far * x, far * y), seat, free):
                return True
        return deep <= self._depths(seat, place, item, free)[1]

    def _shift_all(self, item: MovableObject, by: Vec2, seat: BodyState, free: MovableObject | None) -> bool:
        """Shift an object and, as far as they are light, all that it then overlaps; False if it cannot be shifted."""
        moved, mass = [item], 0.0 if item is free else item.mass
        self.shift(item, by)
        for one in moved:  # grows
            met = self.newly_met(one, by, seat)
            for owner in met:
                other = self._floor.objects.get(owner)
                if other in moved:
                    continue
                mass += math.inf if other is None or other.number not in self._floor.objects.low else other.mass
                if other is None or mass > LIGHT_KG:
                    for back in moved:
                        self.shift(back, (-by[0], -by[1]))
                    return False
                self.shift(other, by)
                moved.append(other)
        return True

    def newly_met(self, item: MovableObject, by: Vec2, seat: BodyState) -> list[str]:
        """Owners of the solids, and seats, that the object overlaps more after a shift than before."""
        floor, now = self._floor, self.where(item)
        back = now.moved((-by[0], -by[1]))
        found = []
        for other in floor.seats:
            if other is not seat and now.low < other.spec.height:
                place, radius = (other.pose.x, other.pose.y), other.spec.radius
                if now.depth(place, radius) > max(TOUCH_M, back.depth(place, radius)):
                    found.append(other.name)
        if not self._is_indoors(item):
            found.append("")
        deep = floor.overlap.depths(item, DEEP_M) if not found else {}
        if deep:
            self.shift(item, (-by[0], -by[1]))
            before = floor.overlap.depths(item, DEEP_M)
            self.shift(item, by)
            found += [owner for owner in sorted(deep) if deep[owner] > before.get(owner, 0.0) + 1e-9]
        return found

    def _is_indoors(self, item: MovableObject) -> bool:
        (x, y, _), (dx, dy) = item.position, self.shifts[item]
        rooms = [room.polygon for room in self._floor.house.rooms]
        place = (x + dx, y + dy)
        return any(plane.inside(place, room) for room in rooms) or any(
            plane.distance_to_edge(place, room) < _OUTDOORS_M for room in rooms
        )

    def _place(self, item: MovableObject, shift: Vec2 | None) -> None:
        """Set an object's shift, None for no shift at all, in the engine's shapes too."""
        data = self._floor.env.data
        if item not in self._begun:
            self._begun[item] = data.geom_xpos[item.geoms, :2].copy()
        data.geom_xpos[item.geoms, :2] = self._begun[item] if shift is None else self._begun[item] + shift
        if shift is None:
            self.shifts.pop(item, None)
        else:
            self.shifts[item] = shift
