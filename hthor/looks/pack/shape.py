"""Brings a model into hthor's frame, and finds the places on it where objects can lie."""

from typing import Any

import numpy as np

from hthor.looks.meshes import shaping
from hthor.looks.meshes.mesh import Mesh
from hthor.looks.pack.fitting import Rest
from hthor.looks.pack.obj import Group
from hthor.types import Surface, Vec3

_CELL_M = 0.015
_CREASE = 0.5
_SOFT_M = (0.035, 0.06)
_HARD_M = (0.012, 0.02)
"""How far a surface may be below and above the height of its resting place [m]: objects float or sink by no more."""
_HELD = 0.96
"""The share of a resting place that must be level to within these limits."""
_LEAST = 0.5
"""Smallest share of the kind's own surface that a resting place must cover along each side."""


def place_shape(groups: list[Group], size: Vec3, rotation: tuple[float, ...], turns: int) -> tuple[list[Group], Vec3]:
    """The groups with their box's middle at 0, z up, front towards +y, in the catalogue's size; also returns the size.

    The library's own frame has y up and the front towards +z.
    """
    turn = np.array(rotation).reshape(3, 3)
    points = [group.vertices @ turn.T for group in groups]
    used = np.concatenate([p[np.unique(group.faces)] for p, group in zip(points, groups, strict=True)])
    low, high = used.min(0), used.max(0)
    width, depth, height = size
    factors = np.array((width, height, depth)) / np.maximum(high - low, 1e-9)
    axes = np.array(((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
    cos, sin = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[turns % 4]
    axes = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0))) @ axes
    made = []
    for group, p in zip(groups, points, strict=True):
        normals = None if group.normals is None else (group.normals @ turn.T / factors) @ axes.T
        made.append(group._replace(vertices=((p - (low + high) / 2) * factors) @ axes.T, normals=normals))
    return made, ((depth, width, height) if turns % 2 else (width, depth, height))


def mesh(group: Group) -> Mesh:
    """The group as a mesh; missing normals are made smooth except across creases."""
    uv = group.uv * (1.0, -1.0) + (0.0, 1.0)
    if group.normals is not None:
        return shaping.mesh(group.vertices, group.faces, uv, group.normals)
    corners = group.faces.reshape(-1)
    vertices = group.vertices[corners]
    faces = np.arange(len(corners)).reshape(-1, 3)
    return shaping.mesh(vertices, faces, uv[corners], _normals(vertices, faces))


def _normals(vertices: Any, faces: Any) -> Any:
    """A normal for each corner: the mean over the faces at its place that form no crease with its own face."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    unit = cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-12)
    _, place = np.unique(np.round(vertices, 5), axis=0, return_inverse=True)
    place = place.reshape(-1)
    order = np.argsort(place, kind="stable")
    starts = np.flatnonzero(np.diff(place[order], prepend=-1))
    normals = np.repeat(unit, 3, axis=0)
    for group in np.split(order, starts[1:]):
        own = unit[group // 3]
        near = own @ own.T > _CREASE
        normals[group] = near @ cross[group // 3]
    return normals


def find_surfaces(
    meshes: list[Mesh], size: Vec3, places: tuple[Surface, ...], own: Vec3, *, soft: bool
) -> tuple[Rest, ...]:
    """The places of a model where objects can lie: the level parts below the kind's ``places``.

    Args:
        size: of the model [m]. places: those of the kind at its size ``own`` [m]. soft: whether cushions may yield.

    Raises:
        ValueError: if the model lacks one of the places; names it.
    """
    if not places:
        return ()
    field = _heights(meshes, size)
    return tuple(_rest(field, size, place, own, _SOFT_M if soft else _HARD_M) for place in places)


def _rest(field: Any, size: Vec3, place: Surface, own: Vec3, give: tuple[float, float]) -> Rest:
    """Start with the kind's own place, and cut off the least level sides until the rest is level."""
    shape, (x0, x1), (y0, y1) = field.shape, *(_span(field.shape[axis], place, own, axis) for axis in (0, 1))
    height = float(np.median(field[x0:x1, y0:y1]))
    level = (field >= height - give[0]) & (field <= height + give[1])
    least = (_LEAST * (x1 - x0), _LEAST * (y1 - y0))
    while not np.isfinite(height) or level[x0:x1, y0:y1].mean() < _HELD:
        if not np.isfinite(height) or x1 - x0 <= least[0] or y1 - y0 <= least[1]:
            raise ValueError(f"too little of its '{place.name}' is level, so objects would float or sink")
        block = level[x0:x1, y0:y1]
        side = int(np.argmin([block[0].mean(), block[-1].mean(), block[:, 0].mean(), block[:, -1].mean()]))
        x0, x1, y0, y1 = x0 + (side == 0), x1 - (side == 1), y0 + (side == 2), y1 - (side == 3)
    low, high = (round(x0 / shape[0], 4), round(y0 / shape[1], 4)), (round(x1 / shape[0], 4), round(y1 / shape[1], 4))
    return Rest(height=round((height + size[2] / 2) / size[2], 4), low=low, high=high)


def _span(count: int, place: Surface, own: Vec3, axis: int) -> tuple[int, int]:
    low, high = ((place.centre[axis] + sign * place.half[axis]) / own[axis] + 0.5 for sign in (-1.0, 1.0))
    return max(0, round(low * count)), min(count, round(high * count))


def _heights(meshes: list[Mesh], size: Vec3) -> Any:
    """The height of the topmost surface [m] on a grid over the footprint; minus infinity where there is no surface."""
    shape = (max(8, round(size[0] / _CELL_M)), max(8, round(size[1] / _CELL_M)))
    field = np.full(shape, -np.inf)
    step = np.array((size[0] / shape[0], size[1] / shape[1]))
    for one in meshes:
        corners = one.vertices.astype(float)[one.faces]
        flat = (corners[:, :, :2] + np.array(size[:2]) / 2) / step - 0.5
        for points, heights in zip(flat, corners[:, :, 2], strict=True):
            _raise(field, points, heights)
    return field


def _raise(field: Any, points: Any, heights: Any) -> None:
    """Raise the height field by one triangle."""
    low = np.maximum(np.ceil(points.min(0) - 1e-9), 0).astype(int)
    high = np.minimum(np.floor(points.max(0) + 1e-9), np.array(field.shape) - 1).astype(int)
    if (high < low).any():
        return
    (ax, ay), (bx, by), (cx, cy) = points
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    if abs(area) < 1e-12:
        return
    x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1), indexing="ij")
    v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
    w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
    inside = (v >= -1e-9) & (w >= -1e-9) & (v + w <= 1.0 + 1e-9)
    z = heights[0] + v * (heights[1] - heights[0]) + w * (heights[2] - heights[0])
    block = field[low[0] : high[0] + 1, low[1] : high[1] + 1]
    block[inside] = np.maximum(block[inside], z[inside])
