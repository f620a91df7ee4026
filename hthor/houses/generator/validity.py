"""The rules that a generated house must meet; each violation names its rule."""

import math
from collections.abc import Iterator

import numpy as np

from hthor import catalog
from hthor.geometry.plane import inside, to_local
from hthor.houses.checks.house_checks import check
from hthor.houses.generator.floorplan.doors import LEAF_M
from hthor.houses.generator.furnishing.clutter import all_fit
from hthor.houses.laying import part_slabs
from hthor.houses.space import grid_kernel, solids
from hthor.houses.space.free_space import Bools, FreeSpace
from hthor.houses.space.solids import WALL_M, Slab
from hthor.types import HouseSpec, Opening, Thing

Fault = tuple[str, str, str]
"""A rule, the id of the thing, room or opening that breaks it, and the problem in words."""
DOOR_M = 0.8
"""Least clear width of a doorway with an open leaf."""
RADIUS_M, HEIGHT_M = 0.25, 1.8
DEEP_M = 0.005
"""How far solids may overlap."""


def leaves(house: HouseSpec) -> tuple[tuple[float, float, float, float, float], ...]:
    """The floor under open leaves: centre x, y, half width, half depth [m], yaw. They hang at ``Opening.a``."""
    rows = []
    for opening in house.openings:
        if opening.openable:
            width = math.dist(opening.a, opening.b)
            nx, ny = _into(house, opening)
            reach, off = (WALL_M / 2 + width) / 2, sum(LEAF_M) / 2
            ux, uy = (opening.b[0] - opening.a[0]) / width, (opening.b[1] - opening.a[1]) / width
            centre = (opening.a[0] + nx * reach + ux * off, opening.a[1] + ny * reach + uy * off)
            rows.append((*centre, reach, (LEAF_M[1] - LEAF_M[0]) / 2, math.atan2(ny, nx)))
    return tuple(rows)


def _into(house: HouseSpec, opening: Opening) -> tuple[float, float]:
    """The unit vector from a doorway into the first of its rooms."""
    (ax, ay), (bx, by) = opening.a, opening.b
    width = math.dist(opening.a, opening.b)
    nx, ny = -(by - ay) / width, (bx - ax) / width
    polygon = next(room.polygon for room in house.rooms if room.id == opening.rooms[0])
    ahead = inside(((ax + bx) / 2 + 0.2 * nx, (ay + by) / 2 + 0.2 * ny), polygon)
    return (nx, ny) if ahead else (-nx, -ny)


def floor(house: HouseSpec, radius: float = RADIUS_M) -> tuple[FreeSpace, Bools]:
    """The free-space grid, and its free cells when all leaves stand open."""
    space = FreeSpace(house, radius, HEIGHT_M)
    rows = np.array(leaves(house), dtype=float).reshape(-1, 5)
    free: Bools = grid_kernel.clear_cells(space.free, rows, *space.origin, space.cell, radius)
    return space, free


def reached(free: Bools) -> Bools:
    """The cells of the largest connected stretch of free floor."""
    from skimage.measure import label  # late: a slow import

    labels = label(free, connectivity=1)
    counts = np.bincount(labels.ravel())
    counts[0] = 0
    mask: Bools = (labels == int(counts.argmax())) & free
    return mask


def find_faults(house: HouseSpec, space: FreeSpace, walkable: Bools) -> Iterator[Fault]:
    """All faults of a generated house.

    First by the strict rules of `hthor.houses.checks.house_checks`, then by those about open doors, solids and free
    surfaces.
    """
    for finding in check(house, RADIUS_M, HEIGHT_M, strict=True):
        if finding.severity == "error":
            yield finding.rule, finding.where, finding.problem
    yield from _leaves(house, space, walkable)
    yield from _solids(house)
    yield from _surfaces(house)


def _leaves(house: HouseSpec, space: FreeSpace, walkable: Bools) -> Iterator[Fault]:
    """``leaf-passable``: whether a body can walk past the open leaves everywhere, and through their doorways."""
    for room in house.rooms:
        if not (walkable & space.room_mask(room)).any():
            yield "leaf-passable", room.id, f"an open door keeps one out of the {room.name}"
    if not walkable[space.cell_of(house.start.x, house.start.y)]:
        yield "leaf-passable", house.id, "the start is not on floor from which all rooms can be walked to"
    for opening in house.openings:
        clear = math.dist(opening.a, opening.b) - LEAF_M[1]
        if opening.openable and clear < DOOR_M:
            yield "leaf-passable", opening.id, f"{clear:.2f} m clear beside the open door, less than {DOOR_M}"


def _within(thing: Thing, box: Slab, reach: float) -> bool:
    gap = math.hypot(box.centre[0] - thing.centre[0], box.centre[1] - thing.centre[1])
    return gap < reach + math.hypot(*box.size) / 2


def _solids(house: HouseSpec) -> Iterator[Fault]:
    """Whether things overlap; if bounding boxes do, such as a chair's and its table's, the solids decide."""
    walls = solids.wall_slabs(house)
    leaf = [Slab((x, y), (2 * w, 2 * d), yaw, 0.0, 2.0) for x, y, w, d, yaw in leaves(house)]
    boxes = solids.furniture_slabs(house)
    for k, (thing, box) in enumerate(boxes):
        for wall in (*walls, *leaf):
            if _within(thing, wall, math.hypot(*box.size) / 2) and solids.overlap_depth(box, wall) > DEEP_M:
                yield "thing-in-wall", thing.id, f"the {thing.kind} reaches into a wall or an open door"
                break
        for other, rival in boxes[k + 1 :]:
            if _within(thing, rival, math.hypot(*box.size) / 2) and solids.penetration(box, rival) > DEEP_M:
                deep = max(
                    (solids.penetration(a, b) for a in part_slabs(thing) for b in part_slabs(other)), default=0.0
                )
                if deep > DEEP_M:
                    yield "thing-in-thing", thing.id, f"stands {deep:.3f} m inside {other.id}"


def _surfaces(house: HouseSpec) -> Iterator[Fault]:
    children: dict[str, list[Thing]] = {}
    for thing in house.things:
        children.setdefault(thing.parent, []).append(thing)
    for thing in house.things:
        kind = catalog.kind(thing.kind)
        if kind.pickable:
            continue
        for surface in kind.rests(thing.size):
            laid = [
                box for child in children.get(thing.id, []) if (box := _laid(child, thing, surface.centre)) is not None
            ]
            if not all_fit(surface, laid, strict=True):
                yield "surface-full", thing.id, f"no room on its {surface.name} for some target"


def _laid(child: Thing, parent: Thing, centre: tuple[float, float, float]) -> tuple[float, ...] | None:
    """A child's box on a surface, local to the surface's middle; None for a child on another surface."""
    x, y, z = to_local(child.centre, parent.centre, parent.yaw)
    if abs(z - child.size[2] / 2 - centre[2]) > 0.01:
        return None
    across = abs(math.sin(child.yaw - parent.yaw)) > 0.5
    w, d = (child.size[1], child.size[0]) if across else (child.size[0], child.size[1])
    x, y = x - centre[0], y - centre[1]
    return (x - w / 2, y - d / 2, x + w / 2, y + d / 2, child.size[2])
