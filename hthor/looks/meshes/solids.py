"""Solid shapes: rounded box, lathe, cylinder, ball, cushion."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from hthor.looks.meshes import shaping
from hthor.looks.meshes.mesh import Mesh
from hthor.types import Vec2, Vec3

BEVEL_M = 0.012
"""The largest edge radius of boxes that are made without a radius [m]."""
_SHARP_M = 0.004
_CREASE = math.cos(math.radians(40.0))


def box(lo: Vec3, hi: Vec3, radius: float | None = None, steps: int = 1, cells: int = 1) -> Mesh:
    """A box from corner ``lo`` to ``hi`` [m] with rounded edges; u of its texture runs along its longest side.

    Args:
        radius: of the edges [m]; None takes a tenth of the smallest side, at most `BEVEL_M`.
        steps: number of strips in half an edge. cells: number of strips of the flat sides in each direction.
    """
    half, middle = (np.array(hi) - lo) / 2.0, (np.array(hi) + lo) / 2.0
    least = float(half.min())
    r = min(BEVEL_M, 0.2 * least) if radius is None else min(radius, 0.999 * least)
    sharp = least < _SHARP_M / 2.0 if radius is None else radius <= 0.0
    lean, side = _cuts(0 if sharp else steps, cells)
    radius = 0.0 if sharp else r
    sides = [_side(half, radius, lean, side, axis, sign) for axis in range(3) for sign in (1, -1)]
    shape = shaping.merged(*sides)
    uv = shape.uv + np.float32(abs(middle[0]) * 0.37 + abs(middle[1]) * 0.61 + abs(middle[2]) * 0.83)
    return shaping.moved(shape._replace(uv=uv), *middle)


def _cuts(steps: int, cells: int) -> tuple[Any, Any]:
    """For points along one side of a box: their outward lean, and their place on the flat part, -1 to 1."""
    lean = np.tan(np.linspace(math.pi / 4, 0.0, steps + 1))[:-1]
    edge = np.ones(steps)
    lean = np.concatenate([-lean, np.zeros(cells + 1), lean[::-1]])
    return lean, np.concatenate([-edge, np.linspace(-1.0, 1.0, cells + 1), edge])


def _side(half: Any, radius: float, lean: Any, side: Any, axis: int, sign: int) -> Mesh:
    u, v = (axis + 1) % 3, (axis + 2) % 3
    direction = np.zeros((len(lean), len(lean), 3))
    direction[..., u], direction[..., v], direction[..., axis] = lean[:, None], lean[None, :], sign
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    inner = half - radius
    points = np.zeros_like(direction)
    points[..., u], points[..., v] = inner[u] * side[:, None], inner[v] * side[None, :]
    points[..., axis] = inner[axis] * sign
    points += radius * direction
    along, across = (u, v) if half[u] >= half[v] else (v, u)
    uv = np.stack([points[..., along], points[..., across]], -1)
    if sign < 0:
        points, uv, direction = (x.swapaxes(0, 1) for x in (points, uv, direction))
    return shaping.surface(points, uv, direction)


def soft(lo: Vec3, hi: Vec3, radius: float, puff: float = 0.0, steps: int = 2, cells: int = 3) -> Mesh:
    """A padded block: very round edges, and flat sides that sink by ``puff`` [m] towards their rims."""
    half, middle = (np.array(hi) - lo) / 2.0, (np.array(hi) + lo) / 2.0
    x, y, z = (float(a) for a in half)
    body = box((-x, -y, -z), (x, y, z), radius, steps, cells)
    points = body.vertices.astype(float)
    share = points / half
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        rim = np.maximum(np.abs(share[:, u]), np.abs(share[:, v])) ** 6
        points[:, axis] -= np.sign(points[:, axis]) * puff * rim * np.abs(share[:, axis])
    return shaping.moved(shaping.mesh(points, body.faces, body.uv, shaping.smooth(points, body.faces)), *middle)


def lathe(profile: Sequence[Vec2], sides: int = 20, unit: Vec2 = (1.0, 1.0), *, whole: bool = False) -> Mesh:
    """A solid of revolution about z; ``profile`` is its outside from the bottom up, (radius, height) in ``unit`` [m].

    Creases of more than 40 degrees stay sharp. If ``whole``, the texture goes once around and once from end to end;
    otherwise it is in metres.
    """
    angle = np.linspace(0.0, 2.0 * math.pi, sides + 1)
    rows = np.array(profile, float) * unit
    rim = 2.0 * math.pi * float(rows[:, 0].max())
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rows, axis=0), axis=1))])
    scale = (1.0, 1.0 / length[-1]) if whole else (rim, 1.0)
    strips = [_strip(rows, length, first, last, angle, scale) for first, last in _runs(rows)]
    return shaping.merged(*strips)


def _runs(rows: Any) -> list[tuple[int, int]]:
    """First and last rows of the parts of a profile without a crease."""
    step = np.diff(rows, axis=0)
    step = step / np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-12)
    creases = [k for k in range(1, len(step)) if float(step[k - 1] @ step[k]) < _CREASE]
    ends = [0, *creases, len(rows) - 1]
    return [(a, b) for a, b in pairwise(ends) if b > a]


def _strip(rows: Any, length: Any, first: int, last: int, angle: Any, scale: Vec2) -> Mesh:
    run = rows[first : last + 1]
    step = np.diff(run, axis=0)
    across = np.stack([step[:, 1], -step[:, 0]], -1)
    across = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    normal = np.concatenate([across[:1], across[:-1] + across[1:], across[-1:]])
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    points = np.stack([c * run[:, 0], s * run[:, 0], np.broadcast_to(run[:, 1], (len(angle), len(run)))], -1)
    normals = np.stack([c * normal[:, 0], s * normal[:, 0], np.broadcast_to(normal[:, 1], points.shape[:2])], -1)
    around = np.linspace(0.0, 1.0, len(angle))[:, None] * scale[0]
    uv = np.stack(np.broadcast_arrays(around, (length[first : last + 1] * scale[1])[None, :]), -1)
    return shaping.surface(points, uv, normals)


def cylinder(centre: Vec3, radius: float, length: float, axis: str = "z", sides: int = 20, top: float = -1.0) -> Mesh:
    """A cylinder around ``centre`` with bevelled rims, or a cone whose upper radius is ``top`` [m]."""
    r, t, z = radius, radius if top < 0.0 else top, length / 2.0
    b = min(0.004, 0.15 * max(r, t), 0.15 * length)
    low, high = max(r - b, 0.0), max(t - b, 0.0)
    shape = lathe([(0.0, -z), (low, -z), (r, b - z), (t, z - b), (high, z), (0.0, z)], sides)
    return shaping.moved(along(shape, axis), *centre)


def along(shape: Mesh, axis: str) -> Mesh:
    """A shape that stands along z, turned to lie along x or y."""
    if axis == "x":
        return shaping.turned(shape, "y", math.pi / 2)
    return shaping.turned(shape, "x", -math.pi / 2) if axis == "y" else shape


def ball(centre: Vec3, half: Vec3, sides: int = 20, *, whole: bool = False) -> Mesh:
    """An ellipsoid with half extents ``half`` [m] around ``centre``."""
    angle = np.linspace(-math.pi / 2, math.pi / 2, max(6, sides * 2 // 3) + 1)
    profile = [(max(0.0, math.cos(a)), math.sin(a)) for a in angle]
    shape = shaping.stretched(lathe(profile, sides, whole=True), *half)
    if not whole:
        shape = shape._replace(uv=shape.uv * np.array((2.0 * math.pi * half[0], math.pi * half[2]), np.float32))
    return shaping.moved(shape, *centre)


def blob(radius: Callable[[Any, Any], Any], sides: int = 24, rows: int = 16) -> Mesh:
    """A lumpy ball around the origin; ``radius(longitude, latitude)`` [rad] is in [m]. Its texture goes around once."""
    lon, lat = np.meshgrid(np.linspace(0.0, 2 * math.pi, sides + 1), np.linspace(-math.pi / 2, math.pi / 2, rows + 1))
    lon, lat = lon.T, lat.T
    way = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], -1)
    way[:, 0, :2], way[:, -1, :2] = 0.0, 0.0
    way[-1] = way[0]
    reach = np.broadcast_to(radius(lon, lat), lon.shape).copy()
    reach[-1], reach[:, 0], reach[:, -1] = reach[0], reach[0, 0], reach[0, -1]
    uv = np.stack([lon / (2 * math.pi), (lat + math.pi / 2) / math.pi], -1)
    return shaping.surface(way * reach[..., None], uv)


def cushion(centre: Vec3, size: Vec3, cells: int = 12, edge: float = 4.0) -> Mesh:
    """A pillow: two curved sheets that meet in a seam; a higher ``edge`` makes it fuller towards its rim."""
    line = np.sin(np.linspace(-math.pi / 2, math.pi / 2, cells + 1))
    x, y = (a.T for a in np.meshgrid(line, line))
    height = np.sqrt(np.maximum((1.0 - np.abs(x) ** edge) * (1.0 - np.abs(y) ** edge), 0.0))
    up = np.stack([x, y, height], -1) * (np.array(size) / 2.0)
    down = (up * (1.0, 1.0, -1.0)).swapaxes(0, 1)
    halves = [shaping.surface(points, points[..., :2]) for points in (up, down)]
    return shaping.moved(shaping.merged(*halves), *centre)
