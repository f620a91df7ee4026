"""Which parts of furniture a robot has looked at from close enough to detect what lies there."""

import math
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.knowledge import resting_points
from hthor.agents.skills.viewpoints import nearest_outline_point
from hthor.geometry.plane import wrap
from hthor.types import BodySpec, Pose, Thing, Vec2, Vec3

_INSET_M = 0.08
"""[m] How far from an edge the middle of an object lies at least. Our choice: half the width of an apple."""
_MARGIN_M = 0.05
"""[m] Points farther away than the detector's range less this do not count as looked at. Our choice."""
_VIEW = 0.45
"""[ratio] Part of the field of view to either side in which points count as looked at. Our choice."""


class SurfaceSurvey:
    """The points of all known surfaces of furniture, and which of them are still to be looked at."""

    def __init__(self, body: BodySpec) -> None:
        self.body, self._range = body, body.sight_range - _MARGIN_M
        self._points: dict[str, NDArray[np.float64]] = {}
        self._open: dict[str, NDArray[np.bool_]] = {}

    def add(self, things: Iterable[Thing]) -> None:
        """Take in furniture that was not known before."""
        for thing in things:
            if thing.id not in self._points:
                points = np.array(resting_points(thing, _INSET_M), dtype=np.float64).reshape(-1, 3)
                low = abs(points[:, 2] - self.body.eye) < self._range  # the rest is too high or low for this body
                self._points[thing.id] = points[low]
                self._open[thing.id] = np.ones(int(low.sum()), dtype=np.bool_)

    def left(self, thing: str) -> tuple[Vec3, ...]:
        """The points [m] of a thing that are still to be looked at."""
        return tuple((x, y, z) for x, y, z in self._points[thing][self._open[thing]].tolist())

    def is_left(self, thing: str) -> bool:
        """Whether a thing has any such points."""
        return bool(self._open[thing].any())

    def drop(self, thing: str) -> None:
        """Look at a thing no more."""
        self._open[thing][:] = False

    def see(self, pose: Pose, things: Iterable[Thing], open_to: Callable[[Vec2, Vec2], bool]) -> None:
        """Note what is in view at a pose.

        Args:
            things: the furniture whose surfaces are not hidden behind a door.
            open_to: whether no wall is between a spot and the edge of a thing, as `viewpoints.Routes`.
        """
        here = (pose.x, pose.y)
        for thing in things:
            near = math.dist(here, thing.centre[:2]) < self._range + math.hypot(*thing.size[:2])
            if not near or not self.is_left(thing.id):
                continue
            seen = self._in_view(pose, self._points[thing.id])
            if seen.any() and open_to(here, nearest_outline_point(thing, here)):
                self._open[thing.id] &= ~seen

    def _in_view(self, pose: Pose, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(N,) whether points (N, 3) are within range and in the field of view."""
        dx, dy, dz = (points - (pose.x, pose.y, self.body.eye)).T
        apart = np.hypot(dx, dy)
        turn = np.abs(np.vectorize(wrap, otypes=[float])(np.arctan2(dy, dx) - pose.gaze))
        tilt = np.abs(np.arctan2(dz, apart) - pose.pitch)
        wide, high = (_VIEW * angle for angle in self.body.fov)
        seen: NDArray[np.bool_] = (np.hypot(apart, dz) <= self._range) & (turn <= wide) & (tilt <= high)
        return seen
