"""How much of one object in view is visible, and how many others appear close to it."""

import math
from typing import Any

import numba
import numpy as np

from hthor.geometry.ray_casting import Floats
from hthor.types import Vec3
from hthor.world.perception.occlusion_kernel import first_occluder, nearby_occluders
from hthor.world.perception.view_frustum import in_frame, view_axes

BESIDE_RAD = 0.15
"""[rad] Objects whose directions from the eye differ by no more than this appear beside one another; our choice."""
_CORNERS = tuple((x, y, z) for x in (-0.8, 0.8) for y in (-0.8, 0.8) for z in (-0.8, 0.8))
"""Corners of a box in half extents, pulled in so that what it lies on does not hide them."""
_MARGIN = 1.05
"""Factor by which the cone that is searched for occluders is widened, against rounding."""


def sample_points(position: Vec3, size: Vec3, yaw: float, looked_for: tuple[Vec3, ...]) -> Any:
    """(N, 3) points [m] all over an upright box, with those that it is ``looked_for`` at in front."""
    (x, y, z), (w, d, h), cos, sin = position, (extent / 2.0 for extent in size), math.cos(yaw), math.sin(yaw)
    corners = [(x + w * a * cos - d * b * sin, y + w * a * sin + d * b * cos, z + h * c) for a, b, c in _CORNERS]
    return np.array([*looked_for, *corners])


@numba.njit(cache=True, error_model="numpy")
def measure(
    x: float, y: float, z: float, yaw: float, pitch: float, wide: float, high: float,
    points: Floats, index: int, others: Floats, wanted: Floats,
    groups: Floats, spheres: Floats, boxes: Floats, fixed: int, count: int,
) -> Any:  # fmt: skip
    """Share of the points of one target that are in view, and how many others in view appear beside it.

    Args:
        x, y, z, yaw, pitch, wide, high: the eye, see `visibility_kernel.visible_targets`.
        points: (N, 3) [m], all over the target; the first is its middle. index: its row in ``wanted``.
        others: (M, 3) middles [m] of what may be beside it. wanted: (M, 3) 0 or less for what does not count, and the
            range of each one's own geoms, which do not hide it.
        groups, spheres, boxes, fixed, count: `hthor.world.perception.occluders.Occluders.arrays`.

    Returns:
        (2,) the share, 0 to 1, and the number.
    """
    view = view_axes(x, y, z, yaw, pitch, wide, high)
    tx, ty, tz = points[0, 0] - x, points[0, 1] - y, points[0, 2] - z
    apart = math.sqrt(tx * tx + ty * ty + tz * tz)
    size, farthest = 0.0, apart
    for p in range(len(points)):
        dx, dy, dz = points[p, 0] - points[0, 0], points[p, 1] - points[0, 1], points[p, 2] - points[0, 2]
        size = max(size, math.sqrt(dx * dx + dy * dy + dz * dz))
    chosen, chosen_count = np.empty(len(others), dtype=np.int64), 0
    for k in range(len(others)):
        ox, oy, oz = others[k, 0] - x, others[k, 1] - y, others[k, 2] - z
        along = ox * tx + oy * ty + oz * tz
        if k == index or wanted[k, 0] <= 0.0 or along <= 0.0:
            continue
        far = math.sqrt(ox * ox + oy * oy + oz * oz)
        if along >= math.cos(BESIDE_RAD) * far * apart and in_frame(view, ox, oy, oz):
            chosen[chosen_count] = k
            chosen_count += 1
            farthest = max(farthest, far)
    # only what stands in a narrow cone around the target can hide any of this
    half = math.tan(min(1.5, max(BESIDE_RAD, math.asin(min(1.0, size / max(apart, 1e-9)))) * _MARGIN))
    cone = view_axes(x, y, z, math.atan2(ty, tx), math.asin(max(-1.0, min(1.0, tz / max(apart, 1e-9)))), half, half)
    ids, rel = nearby_occluders(cone, farthest + size, groups, spheres, fixed, count)
    seen, beside, last = 0, 0, -1
    for p in range(len(points)):
        ux, uy, uz = points[p, 0] - x, points[p, 1] - y, points[p, 2] - z
        if in_frame(view, ux, uy, uz):
            by = first_occluder(ux, uy, uz, wanted[index, 1], wanted[index, 2], last, ids, rel, boxes)
            seen += by < 0
            last = by if by >= 0 else last
    for c in range(chosen_count):
        k = chosen[c]
        ux, uy, uz = others[k, 0] - x, others[k, 1] - y, others[k, 2] - z
        beside += first_occluder(ux, uy, uz, wanted[k, 1], wanted[k, 2], -1, ids, rel, boxes) < 0
    return seen / len(points), beside
