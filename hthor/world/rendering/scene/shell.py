"""Floors, ceilings, walls and baseboards of a house as meshes."""

import math
from collections.abc import Iterator

import numpy as np

from hthor.geometry.plane import rectangular_strips
from hthor.looks import Material, Mesh
from hthor.types import HouseSpec, Room
from hthor.world.rendering.scene import materials, wall_meshes
from hthor.world.rendering.scene.scene_mesh import ABOVE, ALWAYS, INSIDE, SceneMesh, facet, join, slab
from hthor.world.rendering.scene.wall_meshes import WallSlab

_BOARD_M, _BOARD_OUT_M = 0.09, 0.012
"""Height of a baseboard and how far it stands off the wall."""
_CAP_M = 0.006
"""How far above the walls their cut faces are drawn in the view from above."""
CUT = Material(rgba=(0.30, 0.31, 0.33, 1.0), emission=0.4, specular=0.0)


def shell(house: HouseSpec) -> Iterator[SceneMesh]:
    """Everything of the building itself."""
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
    for piece in wall_meshes.wall_slabs(house):
        face, material = piece.face, materials.wall(piece.face)
        group = INSIDE if piece.low > house.height / 2 else ALWAYS
        yield SceneMesh(face.id, scaled(_slab(piece), materials.repeat(material)), material, group)
        if piece.low < 1e-6 and not wall_meshes.is_exterior(face):
            yield SceneMesh(face.id, _baseboard(piece), materials.TRIM)
        if group == ALWAYS and piece.top > house.height - 0.01:
            yield SceneMesh(face.id, _cap(piece), CUT, ABOVE)


def _slab(piece: WallSlab) -> Mesh:
    """Its texture counts from the house's origin, so that it runs on from piece to piece."""
    x, y, _ = piece.centre
    return slab(piece.centre, piece.half, piece.yaw, x * math.cos(piece.yaw) + y * math.sin(piece.yaw))


def _baseboard(piece: WallSlab) -> Mesh:
    """A board on both faces of the slab; the one inside the wall is never seen."""
    (x, y, _), (a, b, h) = piece.centre, piece.half
    height = min(_BOARD_M, 2 * h)
    return slab((x, y, height / 2), (a + _BOARD_OUT_M, b + _BOARD_OUT_M, height / 2), piece.yaw)


def _cap(piece: WallSlab) -> Mesh:
    (x, y, _), (a, b, _) = piece.centre, piece.half
    return slab((x, y, piece.top + _CAP_M / 2), (a, b, _CAP_M / 2), piece.yaw)
