"""The solids that hide things, arranged for the visibility kernels in groups that lie close together."""

from collections.abc import Iterator

import numba
import numpy as np

from hthor.geometry.ray_casting import Floats, Ints
from hthor.world.model.geom_index import GeomIndex

_GROUP_MAX = 8
"""A group of more solids than this is split."""
_GROUPED_RADIUS_MAX_M = 0.8
"""[m] A solid with a larger radius is a group of its own, because it would enlarge any other group."""

OccluderArrays = tuple[Floats, Floats, Floats, int, int]
"""``groups, spheres, boxes, fixed, count`` of `Occluders`, in the order in which kernels take them."""


class Occluders:
    """The occluding solids of one world.

    Attributes:
        arrays: the arguments of the kernels:
            ``groups`` (5, G + 1), bounding spheres (centres and radii [m]) of groups of solids that never move, and the
            index at which each group begins; the last column only marks the end;
            ``spheres`` (4, N), bounding spheres of the solids [m];
            ``boxes`` (N, 13), their half extents [m], row-major rotations, and numbers of geoms;
            ``fixed``, how many solids, counted from the first, never move; ``count``, how many there are now.
        version: the world's version at the last `follow`.
    """

    def __init__(self, index: GeomIndex) -> None:
        self._index = index
        spheres, boxes = _spheres(index, index.walls), _boxes(index, index.walls)
        members = list(_groups(spheres, np.arange(len(index.walls))))
        order = np.concatenate(members) if members else np.zeros(0, np.int64)
        self._fixed, room = len(order), len(index.radius)
        self._spheres, self._boxes = np.zeros((4, room)), np.zeros((room, 13))
        self._spheres[:, : self._fixed], self._boxes[: self._fixed] = spheres[:, order], boxes[order]
        self._groups = np.zeros((5, len(members) + 1))
        for number, group in enumerate(members):
            self._groups[:4, number] = _bounding_sphere(spheres[:, group])
        self._groups[4] = np.concatenate(([0], np.cumsum([len(group) for group in members])))
        self.arrays: OccluderArrays = (self._groups, self._spheres, self._boxes, self._fixed, self._fixed)
        self.version = -1

    def follow(self, version: int) -> None:
        """Read the poses of the solids that may move; ``version`` is the world's version now."""
        self.version = version
        index, fixed = self._index, self._fixed
        solids = index.pos, index.radius, index.half, index.mat, index.loose
        _copy_solids(*solids, self._spheres, self._boxes, fixed)
        self.arrays = (self._groups, self._spheres, self._boxes, fixed, fixed + len(index.loose))


def _groups(spheres: Floats, members: Ints) -> Iterator[Ints]:
    """Groups of indices of spheres that lie close together."""
    large = spheres[3, members] > _GROUPED_RADIUS_MAX_M
    for one in members[large]:
        yield np.array([one])
    yield from _bisect(spheres, members[~large])


def _bisect(spheres: Floats, members: Ints) -> Iterator[Ints]:
    if len(members) <= _GROUP_MAX:
        if len(members):
            yield members
        return
    extents = np.ptp(spheres[:3, members], axis=1)
    order = members[np.argsort(spheres[int(np.argmax(extents)), members], kind="stable")]
    middle = len(order) // 2
    yield from _bisect(spheres, order[:middle])
    yield from _bisect(spheres, order[middle:])


def _bounding_sphere(spheres: Floats) -> tuple[float, float, float, float]:
    """Centre and radius [m] of a sphere around spheres, slightly enlarged against rounding."""
    middle = 0.5 * (spheres[:3].min(axis=1) + spheres[:3].max(axis=1))
    away = np.sqrt(((spheres[:3].T - middle) ** 2).sum(axis=1)) + spheres[3]
    return (*middle, float(away.max()) + 1e-6)


def _spheres(index: GeomIndex, geoms: Ints) -> Floats:
    return np.vstack([index.pos[geoms].T, index.radius[geoms]])


def _boxes(index: GeomIndex, geoms: Ints) -> Floats:
    return np.column_stack([index.half[geoms], index.mat[geoms], geoms])


@numba.njit(cache=True, error_model="numpy")
def _copy_solids(
    pos: Floats, radius: Floats, half: Floats, mat: Floats, loose: Ints, spheres: Floats, boxes: Floats, begin: int
) -> None:
    """Write the ``loose`` solids to ``spheres`` and ``boxes``, from column and row ``begin`` on."""
    for at in range(len(loose)):
        g, to = loose[at], begin + at
        spheres[0, to], spheres[1, to], spheres[2, to], spheres[3, to] = pos[g, 0], pos[g, 1], pos[g, 2], radius[g]
        for axis in range(3):
            boxes[to, axis] = half[g, axis]
        for entry in range(9):
            boxes[to, 3 + entry] = mat[g, entry]
        boxes[to, 12] = g
