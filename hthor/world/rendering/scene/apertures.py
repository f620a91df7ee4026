"""Meshes that fill the holes in walls: frames, thresholds, doors, windows.

Frames are boxes that reach into the wall and project a little from it, so that no two faces lie in one plane.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from hthor.geometry import plane
from hthor.houses.space.solids import WALL_M
from hthor.looks import Mesh, Piece
from hthor.looks.furniture import building
from hthor.types import HouseSpec, Joint, Opening, Rgba, Vec2, Vec3
from hthor.world.model import door_geometry
from hthor.world.rendering.scene import materials
from hthor.world.rendering.scene.scene_mesh import INSIDE, SceneMesh, slab
from hthor.world.rendering.scene.shell import wall_of

_CASING_M, _LINING_M, _PROUD_M = 0.06, 0.02, 0.018
_GAP_M, _STRIP_M = 0.003, 0.006
"""[m] The gap between door and frame, and the height of a threshold."""
_SILL_M, _STEP_M = 0.06, 0.008
"""[m] How far a window's sill and a door's threshold project from the wall."""
_SASH_M, _BAR_M = 0.045, 0.03
_SASH_DEEP, _BAR_DEEP, _CROSS_DEEP = (-0.022, 0.022), (-0.016, 0.016), (-0.014, 0.014)
ENTRANCE: Rgba = (0.42, 0.28, 0.19, 1.0)


class OpeningFrame:
    """An opening's own frame: ``s`` along it from its middle, ``t`` across it, ``z`` up [m]."""

    def __init__(self, opening: Opening) -> None:
        (ax, ay), (bx, by) = opening.a, opening.b
        self.x, self.y, self.yaw = (ax + bx) / 2, (ay + by) / 2, math.atan2(by - ay, bx - ax)
        self.half = math.dist(opening.a, opening.b) / 2
        self.low, self.high = opening.low, opening.high

    def at(self, s: float, t: float) -> Vec2:
        """The house-frame coordinates [m] of a point of the opening's frame."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return (self.x + cos * s - sin * t, self.y + sin * s + cos * t)

    def box(self, s: Vec2, t: Vec2, z: Vec2) -> Mesh:
        """A box between these limits [m] of the opening's frame."""
        x, y = self.at((s[0] + s[1]) / 2, (t[0] + t[1]) / 2)
        half = ((s[1] - s[0]) / 2, (t[1] - t[0]) / 2, (z[1] - z[0]) / 2)
        return slab((x, y, (z[0] + z[1]) / 2), half, self.yaw)


def apertures(house: HouseSpec) -> Iterator[SceneMesh]:
    """Frames of all openings, complete windows, and the doors that are never opened."""
    for opening in house.openings:
        hole = OpeningFrame(opening)
        if opening.kind == "window":
            yield from _window(opening.id, hole)
            continue
        # The frame of a doorway without a door belongs to the wall, because the doorway itself is empty.
        hung = opening.openable or not opening.passable
        yield from _frame(opening.id if hung else wall_of(house, opening) or opening.id, hole)
        if not opening.passable:
            yield from _shut(opening, hole)


def _frame(owner: str, hole: OpeningFrame) -> Iterator[SceneMesh]:
    across = (-WALL_M / 2 - _PROUD_M, WALL_M / 2 + _PROUD_M)
    inner, outer = hole.half - _LINING_M, hole.half + _CASING_M
    top = hole.high + _CASING_M
    yield SceneMesh(owner, hole.box((-outer, -inner), across, (0.0, top)), materials.TRIM)
    yield SceneMesh(owner, hole.box((inner, outer), across, (0.0, top)), materials.TRIM)
    yield SceneMesh(owner, hole.box((-inner, inner), across, (hole.high - _LINING_M, top)), materials.TRIM, INSIDE)
    sill = WALL_M / 2 + _STEP_M
    yield SceneMesh(owner, hole.box((-inner, inner), (-sill, sill), (0.0, _STRIP_M)), materials.THRESHOLD)


def _window(owner: str, hole: OpeningFrame) -> Iterator[SceneMesh]:
    """A frame around the hole that shows on both sides of the wall, a sill, a sash with its bars, and glass."""
    across = (-WALL_M / 2 - _PROUD_M, WALL_M / 2 + _PROUD_M)
    inner, outer = hole.half - _LINING_M, hole.half + _CASING_M
    low, high = hole.low + _LINING_M, hole.high - _LINING_M
    bottom, top = hole.low - _CASING_M, hole.high + _CASING_M
    jut = WALL_M / 2 + _SILL_M
    for s, t, z in (
        ((-outer, -inner), across, (bottom, top)),
        ((inner, outer), across, (bottom, top)),
        ((-inner, inner), across, (bottom, low)),
        ((-inner, inner), across, (high, top)),
        ((-inner, inner), (-jut, jut), (low - 0.03, low + 0.004)),  # no wider, because curtains hang next to it
    ):
        yield SceneMesh(owner, hole.box(s, t, z), materials.TRIM)
    yield from _sash(owner, hole, inner, low, high)


def _sash(owner: str, hole: OpeningFrame, inner: float, low: float, high: float) -> Iterator[SceneMesh]:
    rim, bar = _SASH_M, _BAR_M / 2
    glass, floor, head = inner - rim, low + rim, high - rim
    yield SceneMesh(owner, hole.box((-inner, -glass), _SASH_DEEP, (low, high)), materials.TRIM)
    yield SceneMesh(owner, hole.box((glass, inner), _SASH_DEEP, (low, high)), materials.TRIM)
    yield SceneMesh(owner, hole.box((-glass, glass), _SASH_DEEP, (low, floor)), materials.TRIM)
    yield SceneMesh(owner, hole.box((-glass, glass), _SASH_DEEP, (head, high)), materials.TRIM)
    columns, rows = max(1, round(2 * glass / 0.75)), 2 if high - low > 1.0 else 1
    for k in range(1, columns):
        s = -glass + 2 * glass * k / columns
        yield SceneMesh(owner, hole.box((s - bar, s + bar), _BAR_DEEP, (floor, head)), materials.TRIM)
    for k in range(1, rows):
        z = floor + (head - floor) * k / rows
        yield SceneMesh(owner, hole.box((-glass, glass), _CROSS_DEEP, (z - bar, z + bar)), materials.TRIM)
    yield SceneMesh(owner, hole.box((-glass, glass), (-0.003, 0.003), (floor, head)), materials.GLASS)


def _shut(opening: Opening, hole: OpeningFrame) -> Iterator[SceneMesh]:
    """A door that is never opened; a double door where the opening is wide."""
    inner, height = hole.half - _LINING_M - _GAP_M, opening.high - _LINING_M - 2 * _GAP_M - _STRIP_M
    z = _STRIP_M + _GAP_M
    if hole.half < door_geometry.DOUBLE_M / 2:
        yield from placed_meshes(
            opening.id, building.door_leaf(2 * inner, height, ENTRANCE), (hole.x, hole.y, z), hole.yaw
        )
        return
    for side in (-1, 1):
        at = (*hole.at(side * (inner + _GAP_M / 2) / 2, 0.0), z)
        pieces = building.door_leaf(inner - _GAP_M / 2, height, ENTRANCE)
        yield from placed_meshes(opening.id, pieces, at, hole.yaw if side < 0 else hole.yaw + math.pi)


def leaf_meshes(opens: door_geometry.Openable, joint: Joint) -> Iterator[SceneMesh]:
    """The door of a doorway that turns on ``joint``, closed, in the house frame."""
    part = next(part for part in opens.parts if part.moves == joint.name)
    (x, y, z), (half, _, tall) = part.centre, part.half
    pieces = building.door_leaf(2 * (half - _GAP_M), 2 * tall - _GAP_M, building.TRIM)
    at = plane.to_house((x, y, z - tall), opens.thing.centre, opens.thing.yaw)
    yield from placed_meshes(opens.id, pieces, at, opens.thing.yaw + (0.0 if joint.anchor[0] < x else math.pi))


def placed_meshes(owner: str, pieces: Iterable[Piece], at: Vec3, yaw: float) -> Iterator[SceneMesh]:
    """Pieces turned by ``yaw`` [rad] and moved to ``at`` [m], house frame."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    turn = np.array(((cos, sin, 0.0), (-sin, cos, 0.0), (0.0, 0.0, 1.0)))
    for mesh, material, _ in pieces:
        vertices = (mesh.vertices @ turn + np.array(at)).astype("f4")
        yield SceneMesh(owner, mesh._replace(vertices=vertices, normals=(mesh.normals @ turn).astype("f4")), material)
