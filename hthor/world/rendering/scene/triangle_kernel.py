"""Compiled: what a ray meets first among many triangles, by a tree of boxes around them."""

import math

import numba
import numpy as np

from hthor.geometry.ray_casting import Floats, Ints

_LEAF = 6
"""[count] A box with so few triangles is not divided."""
_DEEP = 64
"""[count] More boxes never wait: a tree that halves its triangles is not as deep."""


@numba.njit(cache=True, error_model="numpy")
def build_tree(corners: Floats) -> tuple[Floats, Ints, Ints]:
    """The tree of boxes around triangles.

    Args:
        corners: (F, 3, 3) [m].

    Returns:
        boxes (B, 6): least and greatest corner; links (B, 2): for a divided box the number of its first part, whose
        neighbour is the second, and -1; for another box its first triangle in ``order`` and how many they are; order
        (F,): the triangles.
    """
    count = len(corners)
    order = np.arange(count)
    middles = np.empty((count, 3))
    for f in range(count):
        for a in range(3):
            middles[f, a] = (corners[f, 0, a] + corners[f, 1, a] + corners[f, 2, a]) / 3.0
    boxes, links = np.empty((2 * count + 1, 6)), np.empty((2 * count + 1, 2), np.int64)
    spans = np.empty((2 * count + 1, 2), np.int64)
    spans[0, 0], spans[0, 1] = 0, count
    made, box = 1, 0
    while box < made:
        first, last = spans[box, 0], spans[box, 1]
        for a in range(3):
            boxes[box, a], boxes[box, 3 + a] = math.inf, -math.inf
        for k in range(first, last):
            for c in range(3):
                for a in range(3):
                    value = corners[order[k], c, a]
                    boxes[box, a], boxes[box, 3 + a] = min(boxes[box, a], value), max(boxes[box, 3 + a], value)
        if last - first <= _LEAF:
            links[box, 0], links[box, 1] = first, last - first
        else:
            axis = 0
            for a in range(1, 3):
                if boxes[box, 3 + a] - boxes[box, a] > boxes[box, 3 + axis] - boxes[box, axis]:
                    axis = a
            part = order[first:last]
            order[first:last] = part[np.argsort(middles[part, axis], kind="mergesort")]
            half = (first + last) // 2
            spans[made, 0], spans[made, 1] = first, half
            spans[made + 1, 0], spans[made + 1, 1] = half, last
            links[box, 0], links[box, 1] = made, -1
            made += 2
        box += 1
    return boxes[:made], links[:made], order


@numba.njit(cache=True, error_model="numpy")
def _first_hit(
    corners: Floats, boxes: Floats, links: Ints, order: Ints, origin: Floats, way: Floats, reach: float, any_hit: bool
) -> tuple[float, int]:
    """[m] How far a ray goes, at most ``reach``, and which triangle stops it, -1 for none.

    With ``any_hit`` only whether it is stopped matters.
    """
    stack = np.empty(_DEEP, np.int64)
    stack[0], waiting, best, which = 0, 1, reach, -1
    inverse = np.empty(3)
    for a in range(3):
        inverse[a] = 1.0 / way[a] if way[a] != 0.0 else math.inf
    while waiting:
        waiting -= 1
        box = stack[waiting]
        near, far = 0.0, best
        for a in range(3):
            if way[a] == 0.0:
                if origin[a] < boxes[box, a] or origin[a] > boxes[box, 3 + a]:
                    far = -1.0
                continue
            low = (boxes[box, a] - origin[a]) * inverse[a]
            high = (boxes[box, 3 + a] - origin[a]) * inverse[a]
            near, far = max(near, min(low, high)), min(far, max(low, high))
        if near > far:
            continue
        if links[box, 1] < 0:
            stack[waiting], stack[waiting + 1] = links[box, 0], links[box, 0] + 1
            waiting += 2
            continue
        for k in range(links[box, 0], links[box, 0] + links[box, 1]):
            distance = _hit(corners[order[k]], origin, way)
            if 0.0 < distance < best:
                best, which = distance, order[k]
                if any_hit:
                    return best, which
    return best, which


@numba.njit(cache=True, error_model="numpy")
def _hit(corner: Floats, origin: Floats, way: Floats) -> float:
    """[m] How far along a ray a triangle is, from either side; -1 where the ray misses it."""
    ux, uy, uz = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    vx, vy, vz = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    px, py, pz = way[1] * vz - way[2] * vy, way[2] * vx - way[0] * vz, way[0] * vy - way[1] * vx
    det = ux * px + uy * py + uz * pz
    if abs(det) < 1e-12:
        return -1.0
    tx, ty, tz = origin[0] - corner[0, 0], origin[1] - corner[0, 1], origin[2] - corner[0, 2]
    u = (tx * px + ty * py + tz * pz) / det
    if u < 0.0 or u > 1.0:
        return -1.0
    qx, qy, qz = ty * uz - tz * uy, tz * ux - tx * uz, tx * uy - ty * ux
    v = (way[0] * qx + way[1] * qy + way[2] * qz) / det
    if v < 0.0 or u + v > 1.0:
        return -1.0
    return (vx * qx + vy * qy + vz * qz) / det  # type: ignore[no-any-return]


@numba.njit(cache=True, error_model="numpy")
def _is_back(corner: Floats, way: Floats) -> bool:
    """Whether a ray meets a triangle from behind."""
    ux, uy, uz = corner[1, 0] - corner[0, 0], corner[1, 1] - corner[0, 1], corner[1, 2] - corner[0, 2]
    vx, vy, vz = corner[2, 0] - corner[0, 0], corner[2, 1] - corner[0, 1], corner[2, 2] - corner[0, 2]
    towards = way[0] * (uy * vz - uz * vy) + way[1] * (uz * vx - ux * vz) + way[2] * (ux * vy - uy * vx)
    return bool(towards > 0.0)


@numba.njit(cache=True, error_model="numpy", nogil=True)
def openness(
    corners: Floats,
    boxes: Floats,
    links: Ints,
    order: Ints,
    points: Floats,
    normals: Floats,
    ways: Floats,
    reach: float,
) -> tuple[Floats, Floats]:
    """How open each point is to its surroundings, from 0 in a crack to 1 on a wide plain; and the share of its rays
    that meet a triangle from behind, which is 1 inside a closed body.

    Args:
        points, normals: (N, 3) [m] and unit vectors. ways: (R, 3) unit vectors about +z, distributed as a cosine.
        reach: [m] what is farther away does not count; what is nearer counts the more.
    """
    found, behind = np.empty(len(points)), np.empty(len(points))
    way = np.empty(3)
    for n in range(len(points)):
        nx, ny, nz = normals[n, 0], normals[n, 1], normals[n, 2]
        sign = 1.0 if nz >= 0.0 else -1.0
        a = -1.0 / (sign + nz)
        b = nx * ny * a
        total, backs = 0.0, 0
        for r in range(len(ways)):
            x, y, z = ways[r, 0], ways[r, 1], ways[r, 2]
            way[0] = x * (1.0 + sign * nx * nx * a) + y * b + z * nx
            way[1] = x * sign * b + y * (sign + ny * ny * a) + z * ny
            way[2] = -x * sign * nx - y * ny + z * nz
            far, which = _first_hit(corners, boxes, links, order, points[n], way, reach, False)
            total += far / reach
            if which >= 0 and _is_back(corners[which], way):
                backs += 1
        found[n], behind[n] = total / len(ways), backs / len(ways)
    return found, behind


@numba.njit(cache=True, error_model="numpy", nogil=True)
def unhidden(
    corners: Floats, boxes: Floats, links: Ints, order: Ints, points: Floats, normals: Floats, lamp: Floats
) -> Floats:
    """(N,) Whether each point faces a lamp and nothing is between them, 0 or 1."""
    found = np.zeros(len(points))
    way = np.empty(3)
    for n in range(len(points)):
        for a in range(3):
            way[a] = lamp[a] - points[n, a]
        if way[0] * normals[n, 0] + way[1] * normals[n, 1] + way[2] * normals[n, 2] <= 0.0:
            continue
        if _first_hit(corners, boxes, links, order, points[n], way, 1.0, True)[1] < 0:
            found[n] = 1.0
    return found
