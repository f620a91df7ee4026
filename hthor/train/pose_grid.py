"""Pose grids: what a robot sees from every pose of a lattice over a house, and where each action leads.

Training reads them instead of running the simulator, which is many times faster. A pose is a place of a lattice
with steps of 0.25 m, one of eight headings and one of two tilts of the camera; the robot is alone in the house. What it
sees is computed by the simulator itself, so that the detections of a grid are those of the live world.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor.agents.skills.semantic_cells import CELLS, GOALS, CellReader, Cells
from hthor.geometry.plane import inside
from hthor.houses.space.free_space import FreeSpace
from hthor.types import Detection, HouseSpec, Placement, Pose
from hthor.world import World

Ints: TypeAlias = NDArray[np.int32]
Bytes: TypeAlias = NDArray[np.uint8]

STEP_M = 0.25
"""[m] Length of a step along the lattice; along its diagonals a step is longer by the square root of 2."""
HEADINGS = 8
"""Headings of 45 degrees, counter-clockwise from +x."""
TILTS_RAD = (0.0, -math.radians(30.0))
"""[rad] The camera is level or looks down, as in the published training."""
_SEAT = "robot"


class PoseGrid(Struct, frozen=True, kw_only=True, eq=False):
    """The grid of one house with one arrangement of objects, N places and P = 16 N poses.

    Pose ``(place * 8 + heading) * 2 + tilt`` is at ``places[place]`` with heading ``heading`` * 45 degrees.

    Attributes:
        places: (N, 2) float64 [m]. rooms: (N,) int32, index of the place's room in the house, -1 between rooms.
        ahead: (N, 8) int32, the place that a step ahead leads to; the place itself where the way is not free.
        shown, behind, depth: (P, 49) uint8, see `hthor.agents.skills.semantic_cells.Cells`.
        visible: (P,) uint16, bit g is set if the robot's detector reports a thing of kind ``GOALS[g]``.
        codes: (P, 49, 32) uint8, an encoder's codes of the pictures, see `hthor.agents.skills.picture_encoder`; None if
            nothing reads them.
    """

    places: NDArray[np.float64]
    rooms: Ints
    ahead: Ints
    shown: Bytes
    behind: Bytes
    depth: Bytes
    visible: NDArray[np.uint16]
    codes: Bytes | None = None


def make_pose(x: float, y: float, heading: int, tilt: int) -> Pose:
    """The pose at a place [m] with numbers of a heading and a tilt."""
    yaw = heading * 2.0 * math.pi / HEADINGS
    return Pose(x=x, y=y, yaw=yaw - 2.0 * math.pi * (yaw > math.pi), pitch=TILTS_RAD[tilt])


def next_poses(ahead: Ints) -> Ints:
    """(P, 5) int32, the poses that ahead, left, right, up and down lead to, from the places ahead (N, 8)."""
    count, tilts = len(ahead), len(TILTS_RAD)
    place, heading, tilt = (part.ravel() for part in np.indices((count, HEADINGS, tilts)))
    level, down = np.zeros_like(tilt), np.ones_like(tilt)
    found = (
        (ahead[place, heading], heading, tilt),
        (place, (heading + 1) % HEADINGS, tilt),
        (place, (heading - 1) % HEADINGS, tilt),
        (place, heading, level),
        (place, heading, down),
    )
    return np.stack([(p * HEADINGS + h) * tilts + t for p, h, t in found], axis=1).astype(np.int32)


def lattice(house: HouseSpec, space: FreeSpace) -> tuple[NDArray[np.float64], Ints]:
    """The places (N, 2) [m] of the lattice that can be reached from the house's start, and the places ahead (N, 8)."""
    start = space.nearest_free(house.start.x, house.start.y)
    reached = space.component(*start)
    low, high = space.centres(reached).min(axis=0), space.centres(reached).max(axis=0)
    columns, rows = (
        range(math.floor((first - middle) / STEP_M), math.ceil((last - middle) / STEP_M) + 1)
        for first, middle, last in zip(low, start, high, strict=True)
    )
    label = space.label(*start)
    spot = {
        (i, j): (start[0] + i * STEP_M, start[1] + j * STEP_M)
        for j in rows
        for i in columns
        if space.label(start[0] + i * STEP_M, start[1] + j * STEP_M) == label
    }
    order = _joined(spot, space)
    index = {key: number for number, key in enumerate(order)}
    ahead = [
        [
            index[other] if other in index and space.segment_free(spot[key], spot[other]) else number
            for other in _around(key)
        ]
        for number, key in enumerate(order)
    ]
    return np.array([spot[key] for key in order]), np.array(ahead, np.int32)


def _around(key: tuple[int, int]) -> list[tuple[int, int]]:
    """The eight neighbours of a lattice point, in the order of headings."""
    i, j = key
    steps = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
    return [(i + across, j + along) for across, along in steps]


def _joined(spot: dict[tuple[int, int], tuple[float, float]], space: FreeSpace) -> list[tuple[int, int]]:
    """The lattice points that steps lead to from the start's, in order; narrow passages may part the lattice."""
    found, left = {(0, 0)}, [(0, 0)]
    while left:
        key = left.pop()
        for other in _around(key):
            if other in spot and other not in found and space.segment_free(spot[key], spot[other]):
                found.add(other)
                left.append(other)
    return sorted(found, key=lambda key: (key[1], key[0]))


def build_grid(house: HouseSpec, objects: Sequence[Placement], robot: str = "scout") -> PoseGrid:
    """The grid of a house with these objects, for a robot's body; costs some seconds."""
    world = _make_world(house, objects, robot)
    places, ahead = lattice(house, world.space[_SEAT])
    cells, visible = survey(world, [_pose(places, number) for number in range(len(places) * HEADINGS * len(TILTS_RAD))])
    return PoseGrid(
        places=places,
        rooms=_rooms(house, places),
        ahead=ahead,
        shown=cells.shown,
        behind=cells.behind,
        depth=cells.depth,
        visible=visible,
    )


def draw_pictures(
    house: HouseSpec, objects: Sequence[Placement], robot: str, places: NDArray[np.float64], poses: Iterable[int]
) -> Iterator[NDArray[np.uint8]]:
    """The robot's colour pictures, each (H, W, 3), from poses of a grid of this house with these objects.

    Args:
        places: of the grid. poses: their numbers, see `PoseGrid`.
    """
    world = _make_world(house, objects, robot)
    for reading in world.survey(_SEAT, (_pose(places, number) for number in poses), colours=True):
        assert reading.rgb is not None  # as colours are wanted
        yield reading.rgb


def survey(world: World, poses: Sequence[Pose]) -> tuple[Cells, NDArray[np.uint16]]:
    """What the robot of a world sees from poses: cells, each array (P, 49), and the goals in view, see `PoseGrid`."""
    cells = Cells(*(np.empty((len(poses), CELLS), np.uint8) for _ in range(3)))
    visible = np.zeros(len(poses), np.uint16)
    reader = CellReader(world.label_kinds, world.camera(_SEAT).size)
    for number, reading in enumerate(world.survey(_SEAT, poses)):
        for column, one in zip(cells, reader.read(reading.segmentation, reading.depth), strict=True):
            column[number] = one
        visible[number] = goal_bits(reading.detections)
    return cells, visible


def goal_bits(detections: Iterable[Detection]) -> int:
    """A number with bit g set if a thing of kind ``GOALS[g]`` is among the detections."""
    kinds = {one.kind for one in detections}
    return sum(1 << number for number, kind in enumerate(GOALS) if kind in kinds)


def _make_world(house: HouseSpec, objects: Sequence[Placement], robot: str) -> World:
    world = World(house, robots=[robot], objects=[(one.id, one.kind) for one in objects])
    world.rearrange((), objects)
    return world


def _pose(places: NDArray[np.float64], number: int) -> Pose:
    """The pose of a number, see `PoseGrid`."""
    place, turned = divmod(number, HEADINGS * len(TILTS_RAD))
    x, y = places[place].tolist()
    return make_pose(x, y, *divmod(turned, len(TILTS_RAD)))


def _rooms(house: HouseSpec, places: NDArray[np.float64]) -> Ints:
    """(N,) index of the room in which each place is, -1 for places between rooms."""
    found = np.full(len(places), -1, np.int32)
    for number, room in enumerate(house.rooms):
        found[[inside((x, y), room.polygon) for x, y in places.tolist()]] = number
    return found
