"""The meshes of a house as the page's file has them, and finer ones where light needs more corners."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from hthor.world.rendering.scene.scene_parts import ScenePart

_SIDES = ((0, 1), (1, 2), (2, 0))
_OPAQUE = 0.99


class Surface(NamedTuple):
    """A mesh in the frame of the house, or of what it moves with.

    Attributes:
        owner: see `ScenePart`. texture: empty for none. tint (3,), alpha, emission: of its material.
        vertices, normals, uv: (V, 3), (V, 3) and (V, 2). faces: (F, 3). colours: (V, 3), None before they are computed.
    """

    owner: str
    texture: str
    tint: Any
    alpha: float
    emission: float
    vertices: Any
    normals: Any
    uv: Any
    faces: Any
    colours: Any = None

    @classmethod
    def of(cls, part: ScenePart) -> Surface:
        """The surface of a part."""
        mesh, material = part.mesh, part.material
        return cls(
            part.owner,
            material.texture,
            np.array(material.rgba[:3]),
            material.rgba[3],
            material.emission,
            np.asarray(mesh.vertices, float),
            unit(np.asarray(mesh.normals, float)),
            np.asarray(mesh.uv, float),
            np.asarray(mesh.faces),
        )

    @property
    def opaque(self) -> bool:
        """Whether nothing is seen through it."""
        return self.alpha >= _OPAQUE

    @property
    def corners(self) -> Any:
        """(F, 3, 3) [m]."""
        return self.vertices[self.faces]

    def moved(self, position: Any, turn: Any) -> Surface:
        """The same surface turned by the quaternion (w, x, y, z) ``turn``, then moved by ``position`` [m]."""
        about = _rotation(turn)
        return self._replace(vertices=about.apply(self.vertices) + position, normals=about.apply(self.normals))

    def moved_back(self, position: Any, turn: Any) -> Surface:
        """The inverse of `moved`."""
        about = _rotation(turn).inv()
        return self._replace(vertices=about.apply(self.vertices - position), normals=about.apply(self.normals))

    def refined(self, longest_m: float) -> Surface:
        """The same surface with no edge longer than ``longest_m``."""
        rows, faces = np.concatenate([self.vertices, self.normals, self.uv], axis=1), self.faces
        while True:
            edges, _ = edges_of(faces)
            long = np.linalg.norm(rows[edges[:, 0], :3] - rows[edges[:, 1], :3], axis=1) > longest_m
            if not long.any():
                break
            rows, faces = halved(rows, faces, edges[long])
        return self._replace(vertices=rows[:, :3], normals=unit(rows[:, 3:6]), uv=rows[:, 6:], faces=faces)


def edges_of(faces: Any) -> tuple[Any, Any]:
    """The edges (E, 2) of triangles (F, 3), each once, and which three each triangle has, (F, 3)."""
    pairs = np.sort(faces[:, _SIDES], axis=2)
    keys, which = np.unique(_keys(pairs.reshape(-1, 2)), return_inverse=True)
    return np.stack([keys >> 32, keys & 0xFFFFFFFF], 1), which.reshape(-1, 3)


def halved(rows: Any, faces: Any, edges: Any) -> tuple[Any, Any]:
    """Triangles whose corners are ``rows`` (V, K) with these ``edges`` (M, 2) cut in the middle.

    The corners that are added are the last rows, one for each edge in its order; neighbours share them.
    """
    keys = _keys(edges)
    order = np.argsort(keys)
    sorted_keys = keys[order]
    count = len(rows)
    rows = np.concatenate([rows, rows[edges].mean(1)])
    while True:
        found = _keys(np.sort(faces[:, _SIDES], axis=2))
        at = np.minimum(np.searchsorted(sorted_keys, found), len(keys) - 1)
        cut = sorted_keys[at] == found
        touched = cut.any(1)
        if not touched.any():
            return rows, faces
        split, at = faces[touched], at[touched]
        places = rows[split][:, :, :3]
        lengths = np.linalg.norm(places - np.roll(places, -1, axis=1), axis=2)
        side = np.where(cut[touched], lengths, -1.0).argmax(1)
        a, b, c = (np.take_along_axis(split, ((side + k) % 3)[:, None], 1)[:, 0] for k in range(3))
        middle = count + order[np.take_along_axis(at, side[:, None], 1)[:, 0]]
        halves = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
        faces = np.concatenate([faces[~touched], halves])


def unit(vectors: Any) -> Any:
    """Vectors (N, 3) made one long."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)


def _rotation(turn: Any) -> Rotation:
    return Rotation.from_quat(np.roll(turn, -1))


def _keys(pairs: Any) -> Any:
    """A number for each pair of corners (…, 2)."""
    return pairs[..., 0].astype(np.int64) << 32 | pairs[..., 1].astype(np.int64)
