"""Meshes of the visual model, cut into small cells so that light, which is computed at corners, looks smooth."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from hthor.looks import Material, Mesh
from hthor.types import Vec2, Vec3

CELL_M = 0.40
"""[m] Size of cells: light is computed at corners, so a wall of only two triangles would be dark in the middle."""
ALWAYS, INSIDE, ABOVE = 0, 4, 5
"""Draw groups: always drawn; not drawn in the view from above, like ceilings; drawn only there, like cut walls."""


class SceneMesh(NamedTuple):
    """A mesh in the house frame. ``owner`` is its owner in a segmentation."""

    owner: str
    mesh: Mesh
    material: Material
    group: int = ALWAYS


def facet(origin: Vec3, u: Vec3, v: Vec3, start: Vec2 = (0.0, 0.0), cell: float = CELL_M) -> Mesh:
    """A rectangle from ``origin`` [m] along ``u`` and ``v`` [m], visible from the side that u x v points to.

    Texture coordinates are metres along u and v, counted from ``start``.
    """
    ends = [math.sqrt(sum(a * a for a in edge)) for edge in (u, v)]
    n, m = (max(1, math.ceil(end / cell)) for end in ends)
    grid = np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, m + 1), indexing="ij")
    s, t = (share.ravel() for share in grid)
    vertices = np.array(origin) + np.outer(s, u) + np.outer(t, v)
    corner = (np.arange(n)[:, None] * (m + 1) + np.arange(m)[None, :]).ravel()
    a, b, c, d = corner, corner + m + 1, corner + m + 2, corner + 1
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    normal = np.cross(u, v) / (ends[0] * ends[1])
    uv = np.stack([start[0] + s * ends[0], start[1] + t * ends[1]], 1)
    normals = np.tile(normal, (len(vertices), 1))
    return Mesh(vertices.astype("f4"), faces.astype("i4"), uv.astype("f4"), normals.astype("f4"))


def slab(centre: Vec3, half: Vec3, yaw: float = 0.0, along: float = 0.0, cell: float = CELL_M) -> Mesh:
    """A box turned by ``yaw`` [rad]; the texture of its long sides has coordinate ``along`` [m] at its middle."""
    (cx, cy, cz), (a, b, h) = centre, half
    x, y = (math.cos(yaw), math.sin(yaw)), (-math.sin(yaw), math.cos(yaw))

    def at(i: float, j: float, k: float) -> Vec3:
        return (cx + x[0] * i * a + y[0] * j * b, cy + x[1] * i * a + y[1] * j * b, cz + k * h)

    ex, ey, ez = (2 * a * x[0], 2 * a * x[1], 0.0), (2 * b * y[0], 2 * b * y[1], 0.0), (0.0, 0.0, 2 * h)
    back_x, back_y = (-ex[0], -ex[1], 0.0), (-ey[0], -ey[1], 0.0)
    low = cz - h
    return join(
        (
            facet(at(-1, -1, -1), ex, ez, (along - a, low), cell),
            facet(at(1, 1, -1), back_x, ez, (along - a, low), cell),
            facet(at(1, -1, -1), ey, ez, (along, low), cell),
            facet(at(-1, 1, -1), back_y, ez, (along, low), cell),
            facet(at(-1, -1, 1), ex, ey, (along - a, 0.0), cell),
            facet(at(-1, 1, -1), ex, back_y, (along - a, 0.0), cell),
        )
    )


def join(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes as one."""
    parts = list(meshes)
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in parts[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in parts]),
        np.concatenate([mesh.faces + offset for mesh, offset in zip(parts, offsets, strict=True)]).astype("i4"),
        np.concatenate([mesh.uv for mesh in parts]),
        np.concatenate([mesh.normals for mesh in parts]),
    )
