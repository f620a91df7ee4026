"""Corners of triangles that nobody sees, because they are inside a wall or behind something that touches it.

No light comes there. As colours are blended over triangles, such a corner would darken all of its triangles, of which
others are seen; so it gets the light of the corners around it that are seen.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from hthor.live.gltf.surfaces import edges_of

_INWARD_M, _INWARD = 0.015, 0.3
"""[m] How far towards the middle of its triangles a corner's light is computed, and at most this share of the way."""
_SAME_M = 0.003
"""[m] Corners that are not farther apart are at the same place."""
_APART_M = 1e4
"""[m] Surfaces are so far apart where the nearest corner of the same surface is looked for."""


def inward(vertices: Any, faces: Any) -> Any:
    """Points (V, 3) [m] in the triangles near their corners, where no other surface passes that only meets an edge."""
    middles = vertices[faces].mean(1)
    total, count = np.zeros_like(vertices), np.zeros(len(vertices))
    for side in range(3):
        np.add.at(total, faces[:, side], middles)
        np.add.at(count, faces[:, side], 1.0)
    way = total / np.maximum(count, 1.0)[:, None] - vertices
    way[count == 0] = 0.0
    far = np.linalg.norm(way, axis=1)
    return vertices + way * np.minimum(_INWARD, _INWARD_M / np.maximum(far, 1e-9))[:, None]


def spread_light(light: Any, hidden: Any, vertices: Any, faces: Any, of: Any = 0) -> Any:
    """The light (V, ...) of all corners, that of ``hidden`` ones (V,) taken from those around them.

    It is that of a corner at the same place, else of the corners that triangles lead to, else of the nearest corner,
    all of the same surface, whose number is in ``of`` (V,).
    """
    if not hidden.any() or hidden.all():
        return light
    light, known = light.copy(), ~hidden
    places = np.column_stack([vertices, np.broadcast_to(of, len(vertices)) * _APART_M])
    far, nearest = cKDTree(places[~hidden]).query(places[hidden])
    nearest = np.flatnonzero(~hidden)[nearest]
    same = far < _SAME_M
    light[np.flatnonzero(hidden)[same]] = light[nearest[same]]
    known[np.flatnonzero(hidden)[same]] = True
    edges, _ = edges_of(faces)
    while True:
        ends = np.concatenate([edges, edges[:, ::-1]])
        ends = ends[~known[ends[:, 0]] & known[ends[:, 1]]]
        if not len(ends):
            break
        total, count = np.zeros_like(light), np.zeros(len(light))
        np.add.at(total, ends[:, 0], light[ends[:, 1]])
        np.add.at(count, ends[:, 0], 1.0)
        reached = count > 0
        light[reached] = (total[reached].T / count[reached]).T
        known |= reached
    rest = ~known[hidden] & (far < _APART_M / 2)
    light[np.flatnonzero(hidden)[rest]] = light[nearest[rest]]
    return light
