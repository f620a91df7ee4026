"""Floors, ceilings, walls and baseboards of a house as meshes.

The physical boxes of `hthor.world.model.walls` overlap at their ends, where materials would flicker. Here corners are
closed, and no two faces lie in one plane.
"""

import math
from collections.abc import Iterator

import numpy as np

from hthor.geometry.plane import inside, rectangular_strips
from hthor.houses.space.solids import WALL_M
from hthor.looks import Material, Mesh
from hthor.types import HouseSpec, Opening, Room, Vec2, Wall
from hthor.world.model import walls
from hthor.world.model.walls import FaceLine, WallSlab
from hthor.world.rendering.scene import materials
from hthor.world.rendering.scene.scene_mesh import ABOVE, ALWAYS, INSIDE, SceneMesh, facet, join, slab

_BOARD_M, _BOARD_OUT_M = 0.09, 0.012
"""[m] Height of a baseboard and its thickness."""
_BIT_M = 0.02
"""[m] How far beyond the end of a wall its corner is searched for."""
_CAP_M = 0.006
"""[m] How far above the walls their cut faces are drawn in the view from above."""
CUT = Material(rgba=(0.30, 0.31, 0.33, 1.0), emission=0.4, specular=0.0)


def shell(house: HouseSpec) -> Iterator[SceneMesh]:
    """Meshes of the building itself: floors, ceilings, walls, baseboards."""
    for room in house.rooms:
        yield SceneMesh(f"floor of {room.id}", _floor(room), materials.floor(room.floor))
        yield SceneMesh(f"ceiling of {room.id}", _ceiling(room, house.height), materials.CEILING, INSIDE)
    yield from _walls(house)


def _floor(room: Room) -> Mesh:
    scale = materials.repeat(materials.floor(room.floor))
    strips = [
        facet((x0, y0, 0.0), (x1 - x0, 0.0, 0.0), (0.0, y1 - y0, 0.0), (x0, y0))
        for x0, y0, x1, y1 in rectangular_strips(room.polygon)
    ]
    return scaled(join(strips), scale)


def _ceiling(room: Room, height: float) -> Mesh:
    return join(
        facet((x0, y1, height), (x1 - x0, 0.0, 0.0), (0.0, y0 - y1, 0.0))
        for x0, y0, x1, y1 in rectangular_strips(room.polygon)
    )


def scaled(mesh: Mesh, repeat: float) -> Mesh:
    """The mesh with texture coordinates in repeats instead of metres."""
    return mesh._replace(uv=mesh.uv / np.float32(repeat))


def _walls(house: HouseSpec) -> Iterator[SceneMesh]:
    for piece in wall_slabs(house):
        face, material = piece.face, materials.wall(piece.face)
        group = INSIDE if piece.low > house.height / 2 else ALWAYS
        yield SceneMesh(face.id, scaled(_slab(piece), materials.repeat(material)), material, group)
        if piece.low < 1e-6 and not materials.is_exterior(face):
            yield SceneMesh(face.id, _baseboard(piece), materials.TRIM)
        if group == ALWAYS and piece.top > house.height - 0.01:
            yield SceneMesh(face.id, _cap(piece), CUT, ABOVE)


def wall_slabs(house: HouseSpec) -> Iterator[WallSlab]:
    """Every piece of wall of the house."""
    for line in walls.face_lines(house):
        side = 1.0 if _within(house, line.face, line.at(line.length / 2, WALL_M / 2)) else -1.0
        first, last = -_reach(house, line, side, 0.0, -1.0), line.length + _reach(house, line, side, line.length, 1.0)
        yield from line.slabs(house, side, first, last, line.face.height)


def _reach(house: HouseSpec, line: FaceLine, side: float, end: float, way: float) -> float:
    """How far [m] a slab continues beyond an end: round an outward corner if it runs along x, else not at all."""
    beyond = end + way * _BIT_M
    outward = all(_within(house, line.face, line.at(beyond, side * off)) for off in (_BIT_M, -_BIT_M))
    return WALL_M / 2 if outward and abs(line.along[0]) > 0.5 else 0.0


def _within(house: HouseSpec, face: Wall, point: Vec2) -> bool:
    if materials.is_exterior(face):
        return not any(inside(point, room.polygon) for room in house.rooms)
    return any(room.id == face.room and inside(point, room.polygon) for room in house.rooms)


def wall_of(house: HouseSpec, opening: Opening) -> str:
    """Id of a wall face that the opening is in, empty for none."""
    cuts = ((line.face.id, line.cut(opening)) for line in walls.face_lines(house))
    return next((id for id, (begin, end) in cuts if end - begin > 1e-6), "")


def _slab(piece: WallSlab) -> Mesh:
    """A piece of wall; its texture is relative to the house's origin, so that it continues from piece to piece."""
    x, y, _ = piece.centre
    return slab(piece.centre, piece.half, piece.yaw, x * math.cos(piece.yaw) + y * math.sin(piece.yaw))


def _baseboard(piece: WallSlab) -> Mesh:
    """A board on both faces of the slab; the board inside the wall is never visible."""
    (x, y, _), (a, b, h) = piece.centre, piece.half
    height = min(_BOARD_M, 2 * h)
    return slab((x, y, height / 2), (a + _BOARD_OUT_M, b + _BOARD_OUT_M, height / 2), piece.yaw)


def _cap(piece: WallSlab) -> Mesh:
    (x, y, _), (a, b, _) = piece.centre, piece.half
    return slab((x, y, piece.top + _CAP_M / 2), (a, b, _CAP_M / 2), piece.yaw)
