"""Moves, turns, stretches and joins meshes, and makes surfaces from grids of points.

Texture coordinates are in metres until `hthor.looks.materials.piece` converts them into repeats of a texture.
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from hthor.looks.meshes.mesh import Mesh, Piece
from hthor.types import Vec3

_NO_AREA = 1e-11


def surface(points: Any, uv: Any, normals: Any = None) -> Mesh:
    """A mesh from ``points`` (N, M, 3) and ``uv`` (N, M, 2); the outside is in the direction d/dN x d/dM of the points.

    ``normals`` (N, M, 3) are smooth by default, also across seams where points coincide.
    """
    n, m = points.shape[:2]
    corner = np.arange(n * m).reshape(n, m)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    vertices = np.asarray(points, np.float64).reshape(-1, 3)
    faces = faces[_areas(vertices, faces) > _NO_AREA]
    across = smooth(vertices, faces) if normals is None else np.asarray(normals).reshape(-1, 3)
    return mesh(vertices, faces, np.asarray(uv).reshape(-1, 2), across)


def mesh(vertices: Any, faces: Any, uv: Any, normals: Any) -> Mesh:
    """A mesh with the types of `Mesh`, its normals scaled to unit length."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit = np.where(length > 0.0, normals / np.maximum(length, 1e-12), (0.0, 0.0, 1.0))
    floats = (np.ascontiguousarray(array, "f4") for array in (vertices, uv, unit))
    points, texture, across = floats
    return Mesh(points, np.ascontiguousarray(faces, "i4"), texture, across)


def smooth(vertices: Any, faces: Any) -> Any:
    """Area-weighted normals (V, 3), not of unit length; vertices at the same place have the same normal."""
    _, same = np.unique(np.round(vertices, 6), axis=0, return_inverse=True)
    same = same.reshape(-1)
    cross = _crosses(vertices, faces)
    total = np.zeros((same.max() + 1, 3))
    for corner in range(3):
        np.add.at(total, same[faces[:, corner]], cross)
    return total[same]


def _crosses(vertices: Any, faces: Any) -> Any:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _areas(vertices: Any, faces: Any) -> Any:
    return np.linalg.norm(_crosses(vertices, faces), axis=1) / 2.0


def moved(shape: Mesh, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
    """The mesh, moved by (``x``, ``y``, ``z``) [m]."""
    return shape._replace(vertices=shape.vertices + np.array((x, y, z), np.float32))


def stretched(shape: Mesh, x: float, y: float, z: float) -> Mesh:
    """The mesh with its coordinates times ``x``, ``y`` and ``z``, all positive."""
    factors = np.array((x, y, z))
    return mesh(shape.vertices * factors, shape.faces, shape.uv, shape.normals / factors)


def turned(shape: Mesh, axis: str, angle: float) -> Mesh:
    """The mesh turned by ``angle`` [rad] about the x, y or z axis, right-handed."""
    c, s = math.cos(angle), math.sin(angle)
    u, v = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[u, u], matrix[u, v], matrix[v, u], matrix[v, v] = c, -s, s, c
    return mesh(shape.vertices @ matrix.T, shape.faces, shape.uv, shape.normals @ matrix.T)


def merged(*shapes: Mesh) -> Mesh:
    """One mesh made of several, at least one."""
    starts = np.cumsum([0, *(len(shape.vertices) for shape in shapes[:-1])])
    faces = np.concatenate([shape.faces + start for shape, start in zip(shapes, starts, strict=True)])
    joined = (np.concatenate([shape[k] for shape in shapes]) for k in (0, 2, 3))
    vertices, uv, normals = joined
    return mesh(vertices, faces, uv, normals)


def bounds(pieces: Iterable[Piece]) -> tuple[Any, Any]:
    """The lowest and the highest corner of all pieces [m]."""
    corners = np.concatenate([piece.mesh.vertices for piece in pieces])
    return corners.min(0).astype(float), corners.max(0).astype(float)


def fitted(pieces: Iterable[Piece], lo: Vec3, hi: Vec3) -> list[Piece]:
    """The pieces, moved and stretched together so that they fill the box from ``lo`` to ``hi`` [m]."""
    every = list(pieces)
    low, high = bounds(every)
    factors = (np.array(hi) - lo) / np.maximum(high - low, 1e-9)

    def place(shape: Mesh) -> Mesh:
        return mesh((shape.vertices - low) * factors + lo, shape.faces, shape.uv, shape.normals / factors)

    return [piece._replace(mesh=place(piece.mesh)) for piece in every]
