"""Finds a pose for one relation of a scene graph: a place for a target on, in or near its reference."""

import math
from collections.abc import Iterator, Sequence

import msgspec
from msgspec import Struct

from hthor import catalog, seeds
from hthor.catalog import priors
from hthor.catalog.priors import Triplet
from hthor.geometry.plane import inside
from hthor.tasks.arrangement.placement import NEAR_M, SupportSurface, SupportSurfaces, distance_to_thing, place_on
from hthor.tasks.arrangement.reachability import ReachableFloor
from hthor.types import HouseSpec, Placement, Thing, Vec2

TRIES = 60
"""How many poses are tried for a relation."""
_ODD = 0.005
"""Weight of surfaces on which people do not put an object, for objects that only have to be near something."""


class PlacementRequest(Struct, frozen=True, kw_only=True):
    """A target to be placed: its relation ``row``, the kind ``ban`` of things that it must not rest on or in, and
    ``waiting``, the ids of objects placed before that have to be near it.

    ``careful`` adds rules: near objects are in the same room; nothing rests on a thing that can be picked up, unless
    the relation says so, nor on such a thing that itself lies on a banned kind.
    """

    row: Triplet
    ban: str = ""
    waiting: tuple[str, ...] = ()
    tries: int = TRIES
    careful: bool = True


def find_placement(
    house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement], *, first: bool = False
) -> Placement | None:
    """A pose for one relation; None when no pose was found.

    Args:
        root: root of all draws. done: the objects placed so far.
        first: whether an object may be placed before the target that it has to be near.
    """
    row = wish.row
    for rest, mark, attempt in _rests(house, root, wish, done, first):
        edge = (row.relation, row.reference)
        u, v, turn = (2 * seeds.draw(root, *edge, axis, attempt) - 1 for axis in ("u", "v", "yaw"))
        placement = place_on(row.target, rest, u, v, math.pi * turn)
        near = is_near_enough(house, placement, mark, wish, done)
        if near and SupportSurfaces.of(house).fits(rest, placement, done) and is_reachable(house, placement, rest):
            return msgspec.structs.replace(placement, near="" if mark is None else mark.id)
    return None


def _rests(
    house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement], first: bool
) -> Iterator[tuple[SupportSurface, Thing | Placement | None, int]]:
    """Surfaces to try, large ones more often, each with the thing that must be near, and the attempt's number.

    An object that only has to be near something rests where people put such objects, if there is such a place.
    """
    relation, reference = wish.row.relation, wish.row.reference
    pairs = _pairs(house, wish, done, first)
    areas = [rest.surface.half[0] * rest.surface.half[1] for rest, _ in pairs]
    if relation == "near" and wish.careful:
        usual = priors.weights(wish.row.target)
        kinds = [(catalog.kind(rest.thing.kind).relation, rest.thing.kind) for rest, _ in pairs]
        areas = [area * (usual.get(kind, 0.0) + _ODD) for area, kind in zip(areas, kinds, strict=True)]
    for attempt in range(wish.tries if pairs else 0):
        yield (*pairs[seeds.choice(areas, root, relation, reference, "rest", attempt)], attempt)


def _pairs(
    house: HouseSpec, wish: PlacementRequest, done: Sequence[Placement], first: bool
) -> list[tuple[SupportSurface, Thing | Placement | None]]:
    """Surfaces that suit the relation, each with the thing or object that has to be near, or None."""
    reference = wish.row.reference
    rests = [rest for rest in SupportSurfaces.of(house).rests if rest.thing.kind != wish.ban]
    if wish.careful and wish.ban:
        rests = [rest for rest in rests if _beneath(house, rest.thing) != wish.ban]
    if wish.row.relation != "near":
        return [(rest, None) for rest in rests if rest.thing.kind == reference]
    if wish.careful:
        rests = [rest for rest in rests if not catalog.kind(rest.thing.kind).pickable]
    outside = [rest for rest in rests if not rest.surface.inside]
    marks: list[Thing | Placement] = [thing for thing in house.things if thing.kind == reference]
    marks += [placement for placement in done if placement.kind == reference]
    if not marks and first and reference in catalog.TARGETS:
        return [(rest, None) for rest in outside]
    return [(rest, mark) for mark in marks for rest in outside if rest.thing.id != mark.id and _may_be_near(rest, mark)]


def is_near_enough(
    house: HouseSpec,
    placement: Placement,
    mark: Thing | Placement | None,
    wish: PlacementRequest,
    done: Sequence[Placement],
) -> bool:
    """Whether a placement is near its reference ``mark``, and near the objects that wait for it."""
    place = (placement.position[0], placement.position[1])
    marks = [*(() if mark is None else (mark,)), *(one for one in done if one.id in wish.waiting)]
    if any(_distance(place, one) > NEAR_M for one in marks):
        return False
    return not wish.careful or all(_room(house, place) == _room(house, _middle(one)) for one in marks)


def is_reachable(house: HouseSpec, placement: Placement, rest: SupportSurface) -> bool:
    """Whether the person can stand at a place to see and reach the object, once the thing that contains it is open."""
    ground = ReachableFloor.of(house)
    opened = frozenset({rest.thing.id}) if rest.surface.inside else frozenset[str]()
    return bool((ground.seeing(placement, opened) & ground.touching(placement) & ground.joined).any())


def _beneath(house: HouseSpec, thing: Thing) -> str:
    """The kind of the thing that a thing lies on, empty if it stands on the floor."""
    return next((other.kind for other in house.things if other.id == thing.parent), "")


def _room(house: HouseSpec, place: Vec2) -> str:
    return next((room.id for room in house.rooms if inside(place, room.polygon)), "")


def _middle(mark: Thing | Placement) -> Vec2:
    x, y, _ = mark.centre if isinstance(mark, Thing) else mark.position
    return (x, y)


def _distance(place: Vec2, mark: Thing | Placement) -> float:
    if isinstance(mark, Thing):
        return distance_to_thing(place, mark)
    return math.dist(place, _middle(mark))


def _may_be_near(rest: SupportSurface, mark: Thing | Placement) -> bool:
    x, y, _ = rest.centre
    return _distance((x, y), mark) <= NEAR_M + math.hypot(*rest.surface.half)
