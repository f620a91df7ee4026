"""Places where objects may rest in a house: exact poses on surfaces, clear of everything."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable

import numpy as np
from msgspec import Struct

from hthor import catalog
from hthor.geometry.plane import distance_to_rectangle, inside, rectangle, to_house, to_local
from hthor.houses.laying import part_slabs
from hthor.houses.space.solids import Slab, overlap_depth, penetration
from hthor.types import HouseSpec, Placement, Surface, Thing, Vec2, Vec3

EDGE_M = 0.01
"""Least distance from an object's footprint to its surface's edge."""
GAP_M = 0.01
"""Least free space around an object."""
LOW_M, HIGH_M = 0.25, 1.45
"""Heights of surfaces that objects are put on, which everybody can reach and see."""
_LIFT_M, _ALOFT_M = 1e-4, 1e-3
NEAR_M = 1.0
"""Two things are near each other within this distance on the plan."""


class SupportSurface(Struct, frozen=True, kw_only=True):
    """One surface of one thing of a house, where objects may rest."""

    thing: Thing
    surface: Surface

    @property
    def centre(self) -> Vec3:
        """Middle of the surface [m], house frame."""
        return to_house(self.surface.centre, self.thing.centre, self.thing.yaw)

    def point(self, u: float, v: float) -> Vec3:
        """The place [m] at shares ``u`` and ``v`` in [-1, 1] of the surface's half extents."""
        x, y, z = self.surface.centre
        local = (x + u * self.surface.half[0], y + v * self.surface.half[1], z)
        return to_house(local, self.thing.centre, self.thing.yaw)


class SupportSurfaces:
    """The surfaces of a house on which objects may rest, and what already stands on them.

    Attributes:
        all: every surface. rests: the surfaces between `LOW_M` and `HIGH_M`, on which objects are put.
    """

    def __init__(self, house: HouseSpec) -> None:
        self.all = tuple(rest for thing in house.things for rest in supports_of(thing))
        self.rests = tuple(rest for rest in self.all if LOW_M <= rest.centre[2] <= HIGH_M)
        owned = [(thing.id, slab) for thing in house.things for slab in part_slabs(thing)]
        self._solids = tuple(slab for _, slab in owned)
        self._owners = tuple(id for id, _ in owned)
        rows = [(*slab.centre, math.hypot(*slab.size) / 2) for slab in self._solids]
        self._x, self._y, self._radius = np.array(rows, dtype=float).reshape(-1, 3).T

    @staticmethod
    @functools.lru_cache(maxsize=32)
    def of(house: HouseSpec) -> SupportSurfaces:
        """The same as the constructor, computed once per process."""
        return SupportSurfaces(house)

    def fits(self, rest: SupportSurface, placement: Placement, others: Iterable[Placement]) -> bool:
        """Whether the object rests on the surface, under its clearance, and touches nothing else."""
        return rests_on(placement, rest) and self._clear(placement, others)

    def lies(self, house: HouseSpec, placement: Placement, others: Iterable[Placement]) -> bool:
        """Whether the whole object lies on the floor of one room of the house, and touches nothing."""
        body = footprint(placement)
        corners = rectangle(body.centre, body.size, body.yaw)
        in_room = any(all(inside(corner, room.polygon) for corner in corners) for room in house.rooms)
        return in_room and abs(body.low - _LIFT_M) <= _ALOFT_M and self._clear(placement, others)

    def within(self, placement: Placement, deep: float) -> str:
        """Id of a thing of the house that the object overlaps by more than ``deep`` [m], empty if there is none."""
        body = footprint(placement)
        rivals = (number for number in self._about(body) if penetration(body, self._solids[number]) > deep)
        return next((self._owners[number] for number in rivals), "")

    def _clear(self, placement: Placement, others: Iterable[Placement]) -> bool:
        body = footprint(placement, GAP_M)
        rivals = [self._solids[number] for number in self._about(body)]
        return not any(overlap_depth(body, rival) > 0.0 for rival in [*rivals, *(footprint(other) for other in others)])

    def _about(self, body: Slab) -> list[int]:
        """Indices of the solids that may touch a box: the circles around both footprints overlap."""
        reach = math.hypot(*body.size) / 2 + _LIFT_M
        gaps = np.hypot(self._x - body.centre[0], self._y - body.centre[1])
        return list(map(int, np.flatnonzero(gaps < reach + self._radius)))


def supports_of(thing: Thing) -> tuple[SupportSurface, ...]:
    """The surfaces of one thing, lowest first."""
    return tuple(SupportSurface(thing=thing, surface=surface) for surface in catalog.kind(thing.kind).rests(thing.size))


def as_thing(placement: Placement) -> Thing:
    """An object of a task as a thing of its house, so that another object can rest on it."""
    size = catalog.kind(placement.kind).size
    return Thing(
        id=placement.id,
        kind=placement.kind,
        asset="",
        centre=placement.position,
        size=size,
        yaw=placement.yaw,
        parent=placement.support,
    )


def rests_on(placement: Placement, rest: SupportSurface, slip: float = 1e-6) -> bool:
    """Whether the object's bottom is on the surface, its footprint `EDGE_M` inside, its top under the clearance."""
    size = catalog.kind(placement.kind).size
    x, y, z = to_local(placement.position, rest.thing.centre, rest.thing.yaw)
    turn = placement.yaw - rest.thing.yaw
    cos, sin = abs(math.cos(turn)), abs(math.sin(turn))
    surface = rest.surface
    return (
        abs(z - size[2] / 2 - surface.centre[2]) <= slip
        and abs(x - surface.centre[0]) + (cos * size[0] + sin * size[1]) / 2 <= surface.half[0] - EDGE_M + slip
        and abs(y - surface.centre[1]) + (sin * size[0] + cos * size[1]) / 2 <= surface.half[1] - EDGE_M + slip
        and size[2] + GAP_M <= surface.clearance + slip
    )


def place_on(kind: str, rest: SupportSurface, u: float, v: float, yaw: float) -> Placement:
    """An object of a kind at shares ``u``, ``v`` in [-1, 1] of a surface, rounded to 0.1 mm on the plan."""
    x, y, z = rest.point(u, v)
    height = catalog.kind(kind).size[2]
    return Placement(
        id=kind,
        kind=kind,
        position=(round(x, 4), round(y, 4), round(z + height / 2, 9)),
        yaw=round(yaw, 4),
        support=rest.thing.id,
        relation="in" if rest.surface.inside or catalog.kind(rest.thing.kind).relation == "in" else "on",
    )


def place_on_floor(kind: str, place: Vec2, yaw: float) -> Placement:
    """An object of a kind on the floor, rounded to 0.1 mm on the plan."""
    x, y = place
    position = (round(x, 4), round(y, 4), round(catalog.kind(kind).size[2] / 2, 9))
    return Placement(id=kind, kind=kind, position=position, yaw=round(yaw, 4))


def footprint(placement: Placement, gap: float = 0.0) -> Slab:
    """The object as an upright box, wider by ``gap`` [m] on all sides and lifted slightly off its support."""
    w, d, h = catalog.kind(placement.kind).size
    x, y, z = placement.position
    return Slab((x, y), (w + 2 * gap, d + 2 * gap), placement.yaw, z - h / 2 + _LIFT_M, z + h / 2 + gap)


def distance_to_thing(point: Vec2, thing: Thing) -> float:
    """Distance [m] on the plan from a point to a thing's edge, zero within."""
    return distance_to_rectangle(point, (thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw)
