"""The shadow of an object on the floor: its convex outline seen from above, and how high it reaches."""

import itertools
import math
from typing import Any, NamedTuple

from hthor.geometry import convex
from hthor.types import Vec2
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.engine import mujoco
from hthor.world.model.geom_index import GeomIndex
from hthor.world.state.movable_object import MovableObject

_CORNERS = 12
"""Corners of the outline that stands for a circle; it encloses the circle and is 3.5 % wider at its corners."""
_RIM = tuple(
    (math.cos(angle) / math.cos(math.pi / _CORNERS), math.sin(angle) / math.cos(math.pi / _CORNERS))
    for angle in (2.0 * math.pi * k / _CORNERS for k in range(_CORNERS))
)


class Footprint(NamedTuple):
    """``outline`` [m] counter-clockwise; the object is between the heights ``low`` and ``high`` [m]."""

    outline: tuple[Vec2, ...]
    low: float
    high: float

    def moved(self, by: Vec2) -> "Footprint":
        """The footprint after a shift [m]."""
        dx, dy = by
        return Footprint(tuple((x + dx, y + dy) for x, y in self.outline), self.low, self.high)

    def depth(self, centre: Vec2, radius: float) -> float:
        """How deep [m] a disc is in it, 0 or less for not at all."""
        return convex.disc_overlap(centre, radius, self.outline)[0]


def footprint(item: MovableObject, env: LazyComposerEnv, index: GeomIndex) -> Footprint:
    """The footprint of an object at its pose in the engine."""
    model, data, points = env.model, env.data, list[Vec2]()
    low, high = math.inf, -math.inf
    for geom in range(item.geoms.start, item.geoms.stop):
        centre, turn = data.geom_xpos[geom].tolist(), data.geom_xmat[geom].tolist()
        rows = _extremes(int(model.geom_type[geom]), index.half[geom].tolist(), turn)
        for x, y, z in rows:
            points.append((centre[0] + x, centre[1] + y))
            low, high = min(low, centre[2] + z), max(high, centre[2] + z)
    return Footprint(convex.hull(points), low, high)


def _extremes(shape: int, half: list[float], turn: list[float]) -> list[tuple[float, float, float]]:
    """Points [m] relative to a solid's middle, in the house's axes, whose convex hull contains it."""
    if shape == int(mujoco.mjtGeom.mjGEOM_SPHERE):
        radius = half[0]
        return [(radius * x, radius * y, side * radius) for x, y in _RIM for side in (-1.0, 1.0)]
    if shape == int(mujoco.mjtGeom.mjGEOM_CYLINDER):
        local = [(half[0] * x, half[1] * y, side * half[2]) for x, y in _RIM for side in (-1.0, 1.0)]
    else:
        local = [tuple(s * h for s, h in zip(signs, half, strict=True)) for signs in _signs()]  # type: ignore[misc]
    return [tuple(_row(turn, k, point) for k in range(3)) for point in local]  # type: ignore[misc]


def _signs() -> Any:
    return itertools.product((-1.0, 1.0), repeat=3)


def _row(turn: list[float], k: int, point: tuple[float, float, float]) -> float:
    return turn[3 * k] * point[0] + turn[3 * k + 1] * point[1] + turn[3 * k + 2] * point[2]
