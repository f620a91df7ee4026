"""Compiled test whether boxes block a line of sight.

Every solid is treated as its oriented bounding box, so cylinders and spheres hide slightly more than they should.
Arrays have the layout of MuJoCo's geoms, so that MuJoCo's own arrays can be passed.
"""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@numba.njit(cache=True)  # type: ignore[misc, unused-ignore]
def is_blocked(
    eye: Floats,
    point: Floats,
    half: Floats,
    pos: Floats,
    mat: Floats,
    radius: Floats,
    ids: Ints,
    skip0: int,
    skip1: int,
) -> bool:
    """Whether the segment from ``eye`` to ``point``, (3,) [m], meets any of the boxes ``ids``.

    Args:
        half: (N, 3) half extents [m]. pos: (N, 3) centres [m]. mat: (N, 9) row-major rotations, box to house frame.
        radius: (N,) bounding radii [m]. ids: indices to test. skip0, skip1: the target's own boxes, those in
            [skip0, skip1), are left out.
    """
    ox, oy, oz = eye[0], eye[1], eye[2]
    ux, uy, uz = point[0] - ox, point[1] - oy, point[2] - oz
    length2 = ux * ux + uy * uy + uz * uz
    if length2 == 0.0:
        return False
    for g in ids:
        if skip0 <= g < skip1:
            continue
        px, py, pz = pos[g, 0] - ox, pos[g, 1] - oy, pos[g, 2] - oz
        t = min(1.0, max(0.0, (px * ux + py * uy + pz * uz) / length2))
        ex, ey, ez = px - t * ux, py - t * uy, pz - t * uz
        if ex * ex + ey * ey + ez * ez > radius[g] * radius[g]:
            continue
        near, far = 0.0, 1.0
        for k in range(3):
            o = -(mat[g, k] * px + mat[g, 3 + k] * py + mat[g, 6 + k] * pz)
            v = mat[g, k] * ux + mat[g, 3 + k] * uy + mat[g, 6 + k] * uz
            if abs(v) < 1e-12:
                v = 1e-12
            t1, t2 = (-half[g, k] - o) / v, (half[g, k] - o) / v
            if t1 > t2:
                t1, t2 = t2, t1
            if t1 > near:
                near = t1
            if t2 < far:
                far = t2
        if near <= far:
            return True
    return False
