"""Places the six targets in a house by the scene priors.

If a house has no place for a relation, the task adds a thing or uses the floor. For example, a tomato has to be on a
plate and its destination is the dining table, where the house's only plate is: the task adds another plate, elsewhere.
Or the remote control has to be near the television, its destination is the TV stand, and no other surface is within a
metre: it lies on the floor.
"""

import math
from collections.abc import Mapping, Sequence

import msgspec

from hthor import catalog, seeds
from hthor.catalog import priors
from hthor.catalog.priors import Triplet
from hthor.errors import HthorError
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.arrangement.placement import (
    NEAR_M,
    SupportSurface,
    SupportSurfaces,
    as_thing,
    place_on,
    place_on_floor,
    supports_of,
)
from hthor.tasks.arrangement.reachability import ReachableFloor
from hthor.tasks.arrangement.relation_placement import (
    TRIES,
    PlacementRequest,
    find_placement,
    is_near_enough,
    is_reachable,
)
from hthor.types import HouseSpec, Placement

BROUGHT = "brought"
"""Begins the id of a thing that a task adds to the house, such as ``brought_plate``."""
_ARM_M = 2.1
"""Greatest distance from the eye to an object on the floor within reach."""
CODE_PART = "tools"

_MOST_TRIES = 2000
"""How many poses are tried for the relation of a task's own target."""
_GRAPHS = 40
"""How many scene graphs are tried before a relation counts as impossible."""

__all__ = ["NEAR_M", "arrange"]


def on_floor(house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement]) -> Placement | None:
    """A pose on the floor near a thing of the house; None when no pose was found."""
    row, ground = wish.row, ReachableFloor.of(house)
    marks = [thing for thing in house.things if thing.kind == row.reference]
    for attempt in range(wish.tries if marks and row.relation == "near" else 0):
        mark = marks[attempt % len(marks)]
        reach = NEAR_M + max(mark.size[:2]) / 2
        x, y, turn = (2 * seeds.draw(root, "floor", axis, attempt) - 1 for axis in ("x", "y", "yaw"))
        place = (mark.centre[0] + reach * x, mark.centre[1] + reach * y)
        placement = msgspec.structs.replace(place_on_floor(row.target, place, math.pi * turn), near=mark.id)
        if not is_near_enough(house, placement, mark, wish, done):
            continue
        lies = SupportSurfaces.of(house).lies(house, placement, done)
        if lies and (ground.seeing(placement, reach_m=_ARM_M) & ground.touching(placement) & ground.joined).any():
            return placement
    return None


def on_brought(
    house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement]
) -> tuple[Placement, Placement] | None:
    """The target on or near an extra thing, and that thing, which lies where people put the target; None if that has no
    place either.
    """
    row, shelves = wish.row, SupportSurfaces.of(house)
    if not catalog.kind(row.reference).pickable:
        return None
    usual = {place for relation, place in priors.weights(row.target) if relation == "on"} - {wish.ban}
    rests = [rest for rest in shelves.rests if rest.thing.kind in usual and not catalog.kind(rest.thing.kind).pickable]
    areas = [rest.surface.half[0] * rest.surface.half[1] for rest in rests]
    for attempt in range(wish.tries if rests else 0):
        rest = rests[seeds.choice(areas, root, "brought", attempt)]
        u, v, turn = (2 * seeds.draw(root, "brought", axis, attempt) - 1 for axis in ("u", "v", "yaw"))
        under = place_on(row.reference, rest, u, v, math.pi * turn)
        under = msgspec.structs.replace(under, id=f"{BROUGHT}_{row.reference}")
        if shelves.fits(rest, under, done) and is_reachable(house, under, rest):
            target = _with(house, root, wish, under, rest, done)
            if target is not None:
                return target, under
    return None


def _with(
    house: HouseSpec,
    root: int,
    wish: PlacementRequest,
    under: Placement,
    rest: SupportSurface,
    done: Sequence[Placement],
) -> Placement | None:
    """The target near the extra thing ``under``, or on it; None if it has no room there."""
    if wish.row.relation == "near":
        return find_placement(house, root, msgspec.structs.replace(wish, tries=TRIES), [*done, under])
    top = supports_of(as_thing(under))[0]
    target = place_on(wish.row.target, top, 0.0, 0.0, under.yaw)
    fits = SupportSurfaces.of(house).fits(top, target, done) and is_reachable(house, target, rest)
    return target if fits and is_near_enough(house, target, None, wish, done) else None


def arrange(
    house: HouseSpec,
    root: int,
    bans: Mapping[str, str] | None = None,
    *,
    fixed: Triplet | None = None,
    serial: bool = False,
) -> tuple[Placement, ...]:
    """A placement for each target, in the catalogue's order, then for the things that the task adds.

    A scene graph is drawn by the priors' weights among the triplets whose reference the house or the task has; then for
    each relation a pose that rests exactly on a surface, touches nothing, and can be reached and seen by the person's
    avatar with the fridge's door open. Objects near each other are in the same room. If a relation has no such pose,
    the target's relation is drawn again; if it is ``fixed``, `on_brought` and `on_floor` are tried if there is a ban,
    then the whole graph is drawn again.

    Args:
        house: the floor plan.
        root: root of all draws.
        bans: for a target, the kind of thing that it must not rest on or in.
        fixed: a triplet that must hold.
        serial: draw one target after the other, as ``smoke`` does: a target is near only targets placed before it
            (so more rarely than the priors say), also through walls, and the placement does not record it.

    Raises:
        HthorError: when a target has no place, or ``fixed`` is impossible.
    """
    bans = bans or {}
    if serial:
        return _in_order(_serial(house, root, bans))
    for attempt in range(_GRAPHS):
        done = _spread(house, seeds.derive(root, "graph", attempt), bans, fixed)
        if done is not None:
            return _in_order(done)
    what = "some target" if fixed is None else f"'{scene_graph.triplet_words(fixed)}'"
    raise HthorError(f"house '{house.id}' has no place for {what}: it needs a free surface within reach")


def _in_order(done: Sequence[Placement]) -> tuple[Placement, ...]:
    names = [*catalog.TARGETS, *(placement.id for placement in done)]
    return tuple(sorted(done, key=lambda placement: names.index(placement.id)))


def _serial(house: HouseSpec, root: int, bans: Mapping[str, str]) -> list[Placement]:
    kinds, done = {thing.kind for thing in house.things}, list[Placement]()
    for number in seeds.shuffled(len(catalog.TARGETS), root, "order"):
        target = catalog.TARGETS[number]
        own, there = seeds.derive(root, target), kinds | {placement.kind for placement in done}
        wishes = (
            PlacementRequest(row=row, ban=bans.get(target, ""), careful=False)
            for row in scene_graph.triplets_in_random_order(target, there, own)
        )
        spots = (find_placement(house, own, wish, done) for wish in wishes)
        spot = next((spot for spot in spots if spot is not None), None)
        if spot is None:
            raise HthorError(f"house '{house.id}' has no place for the {target}: it needs a free surface within reach")
        done.append(msgspec.structs.replace(spot, near=""))
    return done


def _spread(house: HouseSpec, root: int, bans: Mapping[str, str], fixed: Triplet | None) -> list[Placement] | None:
    """All targets by one scene graph; None when a target has no place."""
    kinds = scene_graph.kinds_present(house)
    if not all(scene_graph.applicable_triplets(target, kinds) for target in catalog.TARGETS):
        return None
    wanted = scene_graph.sample_graph(kinds, root, fixed)
    done: list[Placement] = []
    for target in scene_graph.placement_order(wanted, root):
        own, ban = seeds.derive(root, target), bans.get(target, "")
        waiting = tuple(one.id for one in done if one.id in wanted and _waits(wanted[one.id], one, target))
        rows = (
            [fixed]
            if fixed is not None and target == fixed.target
            else list(scene_graph.triplets_in_random_order(target, kinds, own))
        )
        for row in rows:
            wish = PlacementRequest(row=row, ban=ban, waiting=waiting, tries=_MOST_TRIES if row is fixed else TRIES)
            spot = find_placement(house, own, wish, done, first=row is wanted[target])
            spots = (spot,) if spot is not None else _makeshift(house, own, wish, done) if row is fixed else ()
            if spots:
                break
        else:
            return None
        wanted[target] = row
        done = [msgspec.structs.replace(one, near=target) if one.id in waiting else one for one in done]
        done += spots
    return done


def _makeshift(house: HouseSpec, root: int, wish: PlacementRequest, done: Sequence[Placement]) -> tuple[Placement, ...]:
    """Placements off the house's own surfaces, when a ban leaves no place on these; () when none are found."""
    if not wish.ban or wish.row.reference in catalog.TARGETS:
        return ()
    both = on_brought(house, root, wish, done)
    if both is not None:
        return both
    spot = on_floor(house, root, wish, done)
    return () if spot is None else (spot,)


def _waits(row: Triplet, placement: Placement, target: str) -> bool:
    return row.relation == "near" and row.reference == target and not placement.near
