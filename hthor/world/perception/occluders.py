"""Everything that hides something, laid out for `glance`: in groups that lie close together; sees nothing itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numba
import numpy as np

from hthor.world.model.geom_index import GeomIndex

_GROUP_MAX = 8
"""A group is split as long as it has more members than this."""
_GROUPED_RADIUS_MAX_M = 0.8
"""Larger solids are groups of their own: they would make any other group large."""


class Occluders:
    """The solids of one world.

    Attributes:
        spheres: (4, N) middles and radii [m]. boxes: (N, 13) half extents [m], rotations, and geoms. Those that never
            move come first, ``firm`` of them; ``count`` says how many there are.
        groups: (5, G + 1) middles and radii [m] of spheres around groups of those that never move, and where each
            begins; the last column only says where they end.
        version: of the world, when those that move were looked up last.
    """

    def __init__(self, scene: GeomIndex) -> None:
        self._scene = scene
        spheres, boxes = _spheres(scene, scene.walls), _boxes(scene, scene.walls)
        groups = list(_groups(spheres, np.arange(len(scene.walls))))
        order = np.concatenate(groups) if groups else np.zeros(0, np.int64)
        self.firm = self.count = len(order)
        room = len(scene.radius)
        self.spheres, self.boxes = np.zeros((4, room)), np.zeros((room, 13))
        self.spheres[:, : self.firm], self.boxes[: self.firm] = spheres[:, order], boxes[order]
        self.groups = np.zeros((5, len(groups) + 1))
        for number, group in enumerate(groups):
            self.groups[:4, number] = _bounding_sphere(spheres[:, group])
        self.groups[4] = np.concatenate(([0], np.cumsum([len(group) for group in groups])))
        self.version = -1

    def follow(self, version: int) -> None:
        """Look up those that move: one of them has since the last ``version``."""
        self.version = version
        scene, firm = self._scene, self.firm
        self.count = firm + len(scene.loose)
        _copy(scene.pos, scene.radius, scene.half, scene.mat, scene.loose, self.spheres, self.boxes, firm)


def _groups(spheres: Any, members: Any) -> Iterator[Any]:
    """Indices of spheres that lie close together."""
    large = spheres[3, members] > _GROUPED_RADIUS_MAX_M
    for one in members[large]:
        yield np.array([one])
    yield from _bisect(spheres, members[~large])


def _bisect(spheres: Any, members: Any) -> Iterator[Any]:
    if len(members) <= _GROUP_MAX:
        if len(members):
            yield members
        return
    extents = np.ptp(spheres[:3, members], axis=1)
    order = members[np.argsort(spheres[int(np.argmax(extents)), members], kind="stable")]
    middle = len(order) // 2
    yield from _bisect(spheres, order[:middle])
    yield from _bisect(spheres, order[middle:])


def _bounding_sphere(spheres: Any) -> tuple[float, float, float, float]:
    """Middle and radius [m] of a sphere around spheres, a little larger than it need be."""
    middle = 0.5 * (spheres[:3].min(axis=1) + spheres[:3].max(axis=1))
    away = np.sqrt(((spheres[:3].T - middle) ** 2).sum(axis=1)) + spheres[3]
    return (*middle, float(away.max()) + 1e-6)


def _spheres(scene: GeomIndex, geoms: Any) -> Any:
    return np.vstack([scene.pos[geoms].T, scene.radius[geoms]])


def _boxes(scene: GeomIndex, geoms: Any) -> Any:
    return np.column_stack([scene.half[geoms], scene.mat[geoms], geoms])


@numba.njit(cache=True, error_model="numpy")
def _copy(pos: Any, radius: Any, half: Any, mat: Any, loose: Any, spheres: Any, boxes: Any, begin: int) -> None:
    """Write the solids ``loose`` to spheres and boxes, from ``begin`` on."""
    for at in range(len(loose)):
        g, to = loose[at], begin + at
        spheres[0, to], spheres[1, to], spheres[2, to], spheres[3, to] = pos[g, 0], pos[g, 1], pos[g, 2], radius[g]
        for axis in range(3):
            boxes[to, axis] = half[g, axis]
        for entry in range(9):
            boxes[to, 3 + entry] = mat[g, entry]
        boxes[to, 12] = g
