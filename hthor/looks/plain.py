"""The look of last resort: a kind's own solids, each in its plain colour; knows nothing of particular kinds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from hthor.looks.mesh import Material, Mesh, Piece
from hthor.types import Part, Vec3

_SIDES = 24


def pieces(parts: Iterable[Part]) -> tuple[Piece, ...]:
    """One piece a part."""
    return tuple(Piece(_mesh(part), Material(rgba=part.rgba), part.moves) for part in parts)


def _mesh(part: Part) -> Mesh:
    mesh = {"box": box, "cylinder": cylinder, "sphere": sphere}[part.shape](part.half)
    if part.shape == "cylinder" and part.axis != "z":
        raise NotImplementedError("lying cylinders")
    return mesh._replace(vertices=mesh.vertices + np.array(part.centre, np.float32))


def box(half: Vec3) -> Mesh:
    """A box around the origin."""
    vertices: list[Any] = []
    faces: list[list[int]] = []
    uv: list[tuple[float, float]] = []
    normals: list[Any] = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            base = len(vertices)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner, normal = np.zeros(3), np.zeros(3)
                corner[axis], corner[u], corner[v] = sign * half[axis], a * half[u], b * half[v]
                normal[axis] = sign
                vertices.append(corner)
                normals.append(normal)
                uv.append((corner[u], corner[v]))
            order = ((0, 1, 2), (0, 2, 3)) if sign > 0 else ((0, 2, 1), (0, 3, 2))
            faces += [[base + k for k in triangle] for triangle in order]
    return Mesh(np.array(vertices, "f4"), np.array(faces, "i4"), np.array(uv, "f4"), np.array(normals, "f4"))


def cylinder(half: Vec3) -> Mesh:
    """An upright cylinder around the origin."""
    raise NotImplementedError


def sphere(half: Vec3) -> Mesh:
    """A sphere around the origin."""
    raise NotImplementedError
