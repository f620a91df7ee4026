"""Shapes made by sweeping lines and outlines: tubes, rings, sheets, extrusions; picture panels."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from hthor.looks.meshes import shaping, solids
from hthor.looks.meshes.mesh import Mesh
from hthor.types import Vec2, Vec3


def tube(path: Sequence[Vec3] | Any, radius: float | Sequence[float], sides: int = 8, *, closed: bool = False) -> Mesh:
    """A round bar along ``path`` (N, 3) [m] with flat ends, or ``closed`` without ends; ``radius`` [m] may vary."""
    line = np.array(path, float)
    if closed:
        line = np.concatenate([line, line[:1]])
    ways = np.gradient(line, axis=0)
    if closed:
        ways[0] = ways[-1] = line[1] - line[-2]
    ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-12)
    across, up = _frames(ways, closed)
    radii = np.broadcast_to(np.asarray(radius, float), (len(line),)) if not closed else np.full(len(line), radius)
    angle = np.linspace(0.0, 2 * math.pi, sides + 1)[:, None, None]
    ring = np.cos(angle) * across[None] + np.sin(angle) * up[None]
    ring[-1] = ring[0]
    points = line[None] + ring * radii[None, :, None]
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    uv = np.stack(np.broadcast_arrays(length[None, :], angle[..., 0] * float(np.max(radii))), -1)
    skin = shaping.surface(points, uv, ring)
    if closed:
        return skin
    ends = [_disc(points[:, 0], -ways[0]), _disc(points[:, -1], ways[-1])]
    return shaping.merged(skin, *ends)


def _frames(ways: Any, closed: bool) -> tuple[Any, Any]:
    """Two unit vectors perpendicular to each direction of a path, carried along it without twisting."""
    first = np.eye(3)[int(np.argmin(np.abs(ways[0])))]
    across = np.empty_like(ways)
    for index, way in enumerate(ways):
        first = first - way * (first @ way)
        first = first / np.linalg.norm(first)
        across[index] = first
    if closed:
        across[-1] = across[0]
    return across, np.cross(ways, across)


def _disc(ring: Any, normal: Any) -> Mesh:
    """A cap on a ring (N, 3) of points, whose last point is its first."""
    count = len(ring) - 1
    vertices = np.concatenate([ring[:-1], ring[:-1].mean(0, keepdims=True)])
    faces = np.array([(k, (k + 1) % count, count) for k in range(count)])
    cross = np.cross(vertices[faces[0, 1]] - vertices[faces[0, 0]], vertices[count] - vertices[faces[0, 0]])
    if float(cross @ normal) < 0.0:
        faces = faces[:, ::-1]
    flat = (vertices - vertices[count]) @ np.linalg.qr(np.stack([normal, *np.eye(3)]).T)[0][:, 1:3]
    return shaping.mesh(vertices, faces, flat, np.broadcast_to(normal, vertices.shape))


def ring(centre: Vec3, radius: float, thickness: float, axis: str = "z", sides: int = 20, round_sides: int = 8) -> Mesh:
    """A torus with ring radius ``radius`` and tube radius ``thickness`` [m]; ``axis`` goes through its hole."""
    angle = np.linspace(0.0, 2 * math.pi, sides, endpoint=False)
    path = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(sides)], -1)
    return shaping.moved(solids.along(tube(path, thickness, round_sides, closed=True), axis), *centre)


def sheet(points: Any, uv: Any, thickness: float = 0.001) -> Mesh:
    """A thin sheet that is visible from both sides: ``points`` (N, M, 3) [m] are its front."""
    front = shaping.surface(points, uv)
    behind = points - thickness * front.normals.reshape(points.shape)
    return shaping.merged(front, shaping.surface(behind.swapaxes(0, 1), np.asarray(uv).swapaxes(0, 1)))


def extruded(outline: Sequence[Vec2] | Any, low: float, high: float, bevel: float = 0.0) -> Mesh:
    """An upright prism on a counter-clockwise, star-shaped ``outline`` [m], its edges cut by ``bevel`` [m]."""
    flat = np.array(outline, float)
    middle = flat.mean(0)
    inner = middle + (flat - middle) * (1.0 - bevel / max(1e-9, float(np.abs(flat - middle).max())))
    rows = (
        [(inner, low), (flat, low + bevel), (flat, high - bevel), (inner, high)]
        if bevel
        else [(flat, low), (flat, high)]
    )
    loop = [np.column_stack([np.vstack([row, row[:1]]), np.full(len(flat) + 1, z)]) for row, z in rows]
    around = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(loop[-1], axis=0), axis=1))])
    walls = [
        shaping.surface(np.stack(pair, 1), np.stack([np.stack([around] * 2, 1), np.stack(pair, 1)[..., 2]], -1))
        for pair in pairwise(loop)
    ]
    caps = [_disc(loop[0], np.array((0.0, 0.0, -1.0))), _disc(loop[-1], np.array((0.0, 0.0, 1.0)))]
    return shaping.merged(*walls, *caps)


def panel(centre: Vec3, width: float, height: float, lean: float = 0.0) -> Mesh:
    """An upright picture that faces +y; its texture fills it once. ``lean`` [rad] tips its top backwards."""
    x, z = width / 2.0, height / 2.0
    points = np.array([[(x, 0.0, -z), (x, 0.0, z)], [(-x, 0.0, -z), (-x, 0.0, z)]])
    flat = shaping.surface(points, [[(0.0, 1.0), (0.0, 0.0)], [(1.0, 1.0), (1.0, 0.0)]])
    return shaping.moved(shaping.turned(flat, "x", lean), *centre)


def lying(centre: Vec3, width: float, depth: float) -> Mesh:
    """A flat picture that is seen from above; its upper edge is towards -y, as for a reader in front of it."""
    return shaping.moved(shaping.turned(panel((0.0, 0.0, 0.0), width, depth), "x", math.pi / 2), *centre)


def bend(start: Vec3, *through: Vec3, steps: int = 6) -> Any:
    """Points (N, 3) of a smooth line from ``start`` through the other points (Catmull-Rom)."""
    knots = np.array([start, *through], float)
    padded = np.concatenate([2 * knots[:1] - knots[1:2], knots, 2 * knots[-1:] - knots[-2:-1]])
    t = np.linspace(0.0, 1.0, steps, endpoint=False)[:, None]
    pieces = []
    for k in range(len(knots) - 1):
        a, b, c, d = padded[k : k + 4]
        pieces.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3))
    return np.concatenate([*pieces, knots[-1:]])
