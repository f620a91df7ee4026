"""The light on what stands still: at the corners of its triangles, of which there are more where shadows end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hthor.live.gltf import hidden_corners
from hthor.live.gltf.surfaces import Surface, edges_of, halved, unit

if TYPE_CHECKING:
    from hthor.world.rendering.scene.baked_light import BakedLight

_STEP = 0.06
"""Where light changes more from corner to corner, an edge is cut in the middle. Our choice."""
_SHORTEST_M = (0.3, 0.15, 0.1, 0.06)
"""[m] Edges that are not longer are not cut, in the first and in the later rounds."""

_DOOR = 0.6
"""The least light on doors and drawers. Our choice."""
_SAMPLES = np.array(((1, 1, 1), (8, 1, 1), (1, 8, 1), (1, 1, 8))) / ((3,), (10,), (10,), (10,))
"""Shares of the three corners at the places of a triangle that are looked at."""


class _Heap(NamedTuple):
    """Surfaces as one mesh: ``rows`` (V, 8) place, normal, texture coordinates; ``of`` (V,) the surface of each."""

    rows: Any
    faces: Any
    of: Any


def lit(surfaces: Sequence[Surface], light: BakedLight, most: int, *, whole: bool = False) -> list[Surface]:
    """The surfaces with their colours, and with more triangles where light needs them, up to about ``most``.

    Without ``whole`` they lack the triangles that are inside of walls and other bodies, and surfaces without any others
    are left out. With it they are doors, which are no darker than `_DOOR` anywhere: their inner sides are seen when
    they are open.
    """
    heap = _together(surfaces)
    through = np.array([not one.opaque for one in surfaces])
    shown, hidden = _seen(light, heap, slice(None), through)
    if not whole:
        faces, used = _outside(light, heap, hidden)
        heap, shown, hidden = _Heap(heap.rows[used], faces, heap.of[used]), shown[used], hidden[used]
    for shortest in _SHORTEST_M:
        edges = _uneven(heap, shown, hidden, shortest)[: max(0, most - len(heap.faces)) // 2]
        if not len(edges):
            continue
        first = len(heap.rows)
        rows, faces = halved(heap.rows, heap.faces, edges)
        rows[first:, 3:6] = unit(rows[first:, 3:6])
        heap = _Heap(rows, faces, np.concatenate([heap.of, heap.of[edges[:, 0]]]))
        more, unseen = _seen(light, heap, slice(first, None), through)
        shown, hidden = np.concatenate([shown, more]), np.concatenate([hidden, unseen])
    shown = hidden_corners.spread_light(shown, hidden, heap.rows[:, :3], heap.faces, heap.of)
    found = _apart(surfaces, heap, np.maximum(shown, _DOOR) if whole else shown)
    return [one for one in found if whole or len(one.faces)]


def _seen(light: BakedLight, heap: _Heap, which: slice, through: Any) -> Any:
    """The light at corners, and whether they are hidden; glass has the light of its brighter side."""
    points, normals = hidden_corners.inward(heap.rows[:, :3], heap.faces)[which], heap.rows[which, 3:6]
    shown, hidden = light.light(points, normals)
    glass = through[heap.of[which]]
    if glass.any():
        behind, unseen = light.light(points[glass], -normals[glass])
        shown[glass], hidden[glass] = np.maximum(shown[glass], behind), hidden[glass] & unseen
    return shown, hidden


def _outside(light: BakedLight, heap: _Heap, hidden: Any) -> tuple[Any, Any]:
    """The triangles without those that are inside a wall or another body, and which corners they have."""
    unseen = np.flatnonzero(hidden[heap.faces].all(1))
    corners = heap.rows[heap.faces[unseen], :6]
    inside = np.ones(len(unseen), bool)
    for shares in _SAMPLES:
        sample = np.einsum("c,ncd->nd", shares, corners)
        inside[inside] = light.inside(sample[inside, :3], unit(sample[inside, 3:]))
    used, faces = np.unique(np.delete(heap.faces, unseen[inside], axis=0), return_inverse=True)
    return faces.reshape(-1, 3), used


def _uneven(heap: _Heap, shown: Any, hidden: Any, shortest: float) -> Any:
    """Edges (E, 2) along which the light changes much, those with the greatest change first."""
    edges, _ = edges_of(heap.faces)
    a, b = edges.T
    change = np.abs(shown[a] - shown[b]).max(1) * ~(hidden[a] | hidden[b])
    length = np.linalg.norm(heap.rows[a, :3] - heap.rows[b, :3], axis=1)
    wanted = (change > _STEP) & (length > shortest)
    return edges[wanted][np.argsort(-(change * length)[wanted], kind="stable")]


def _together(surfaces: Sequence[Surface]) -> _Heap:
    counts = [len(one.vertices) for one in surfaces]
    offsets = np.cumsum([0, *counts[:-1]])
    rows = [np.concatenate([one.vertices, one.normals, one.uv], axis=1) for one in surfaces]
    faces = [one.faces.astype(np.int64) + offset for one, offset in zip(surfaces, offsets, strict=True)]
    return _Heap(np.concatenate(rows), np.concatenate(faces), np.repeat(np.arange(len(surfaces)), counts))


def _apart(surfaces: Sequence[Surface], heap: _Heap, shown: Any) -> list[Surface]:
    corners, triangles = np.argsort(heap.of, kind="stable"), heap.of[heap.faces[:, 0]]
    place = np.empty(len(corners), np.int64)
    place[corners] = np.arange(len(corners))
    numbers = np.arange(len(surfaces) + 1)
    ends = np.searchsorted(heap.of[corners], numbers)
    order = np.argsort(triangles, kind="stable")
    spans = np.searchsorted(triangles[order], numbers)
    found = []
    for number, one in enumerate(surfaces):
        own = corners[ends[number] : ends[number + 1]]
        faces = place[heap.faces[order[spans[number] : spans[number + 1]]]] - ends[number]
        rows = heap.rows[own]
        found.append(
            one._replace(
                vertices=rows[:, :3],
                normals=rows[:, 3:6],
                uv=rows[:, 6:],
                faces=faces,
                colours=one.tint * (shown[own] + one.emission),
            )
        )
    return found
