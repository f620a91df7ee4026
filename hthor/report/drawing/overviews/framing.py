"""Chooses viewpoints from which a whole house is in the picture, and those from which given points are best seen."""

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from hthor.types import HouseSpec, Vec3
from hthor.world import World
from hthor.world.rendering.viewpoint import Viewpoint

ELEVATION = math.radians(52.0)
"""[rad] How steeply the camera looks down: steep enough to see over low walls, and flat enough to see furniture."""
FOV = math.radians(30.0)
"""[rad] Vertical field of view of overviews."""
_LOW_M, _MARGIN, _FARTHEST_M, _ROUNDS = 1.6, 0.97, 200.0, 3
"""[m] height that has to be in the picture; the share of the picture that it may fill; the farthest camera [m]; how
often the picture is centred."""
_TRIED, _APART = 24, math.radians(75.0)
"""How many directions are tried, and how far apart the chosen ones are at least [rad]."""
_COARSE = (320, 256)
"""Pixels of the pictures in which it is tested what hides what."""
_HIDDEN_M = 0.25
"""[m] A point is hidden if something is this much nearer to the camera."""


def frame_house(house: HouseSpec, azimuth: float, size: tuple[int, int]) -> Viewpoint:
    """The nearest viewpoint in a direction from which the whole house is in pictures of ``size``.

    Args:
        azimuth: [rad] the direction from the house to the camera, counter-clockwise from +x.
    """
    xs, ys = zip(*(corner for room in house.rooms for corner in room.polygon), strict=True)
    corners = np.array([(x, y, z) for x, y in zip(xs, ys, strict=True) for z in (0.0, _LOW_M)])
    target: Vec3 = ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2, 0.0)
    for _ in range(_ROUNDS):
        distance = _nearest(target, azimuth, corners, size)
        target = _centred(_viewpoint(target, azimuth, distance), corners, distance)
    return _viewpoint(target, azimuth, _nearest(target, azimuth, corners, size))


def _nearest(target: Vec3, azimuth: float, corners: NDArray[np.float64], size: tuple[int, int]) -> float:
    """The least distance [m] from which all corners are in the picture."""
    near, far = 1.0, _FARTHEST_M
    while far - near > 0.01:
        middle = (near + far) / 2
        fits = _fits(_viewpoint(target, azimuth, middle), corners, size)
        near, far = (near, middle) if fits else (middle, far)
    return far


def _centred(viewpoint: Viewpoint, corners: NDArray[np.float64], distance: float) -> Vec3:
    """A target with as much of the house to its left as to its right, and above as below."""
    ahead, left, up = viewpoint.axes @ (corners - np.array(viewpoint.eye)).T
    shift = [distance * float((part / ahead).max() + (part / ahead).min()) / 2 for part in (left, up)]
    x, y, z = np.array(viewpoint.target) + shift[0] * viewpoint.axes[1] + shift[1] * viewpoint.axes[2]
    return (float(x), float(y), float(z))


def _viewpoint(target: Vec3, azimuth: float, distance: float) -> Viewpoint:
    flat = distance * math.cos(ELEVATION)
    x, y = target[0] + flat * math.cos(azimuth), target[1] + flat * math.sin(azimuth)
    return Viewpoint(eye=(x, y, target[2] + distance * math.sin(ELEVATION)), target=target, fov=FOV)


def _fits(viewpoint: Viewpoint, corners: NDArray[np.float64], size: tuple[int, int]) -> bool:
    ahead, left, up = viewpoint.axes @ (corners - np.array(viewpoint.eye)).T
    wide, high = viewpoint.tangents(size)
    inside = (np.abs(left) <= _MARGIN * wide * ahead) & (np.abs(up) <= _MARGIN * high * ahead)
    return bool(((ahead > 0.0) & inside).all())


def visible(world: World, viewpoint: Viewpoint, points: Sequence[Vec3]) -> NDArray[np.bool_]:
    """(N,) whether each of the points [m] is seen from the viewpoint, with walls cut low."""
    depth = world.overview(viewpoint, "depth", _COARSE, "fast")
    found = viewpoint.project(np.array(points, float).reshape(-1, 3), _COARSE)
    columns = np.clip(np.round(found[:, 0]).astype(int), 0, _COARSE[0] - 1)
    rows = np.clip(np.round(found[:, 1]).astype(int), 0, _COARSE[1] - 1)
    return np.asarray(depth[rows, columns] > found[:, 2] - _HIDDEN_M)


def best_azimuths(world: World, points: Sequence[Vec3], count: int) -> list[float]:
    """Directions [rad] well apart from which most of the points are seen, in counter-clockwise order.

    Of equally good choices the first is taken; the same world gives the same directions.
    """
    tried = [2.0 * math.pi * (number + 0.5) / _TRIED for number in range(_TRIED)]
    seen = [int(visible(world, frame_house(world.house, one, _COARSE), points).sum()) for one in tried]
    choices = [
        chosen
        for chosen in combinations(range(_TRIED), count)
        if all(_between(tried[a], tried[b]) >= _APART for a, b in combinations(chosen, 2))
    ]
    best = max(choices, key=lambda chosen: sum(seen[number] for number in chosen))
    return [tried[number] for number in best]


def _between(one: float, other: float) -> float:
    """The angle between two directions [rad]."""
    return abs((one - other + math.pi) % (2.0 * math.pi) - math.pi)
