"""Which solids an object touches or overlaps, computed from the engine's exact shapes."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from hthor.houses.space.obstacles import STEP_M
from hthor.world.model import geoms
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.engine import mujoco
from hthor.world.model.geom_index import GeomIndex
from hthor.world.state.movable_object import MovableObject

OVERLAP_M = 0.005
"""[m] Solids may not overlap by more than this."""
CONTACT_M = 0.003
"""[m] Solids count as touching up to this distance."""
FLOOR = "floor"
_MEETS = geoms.MOVABLE["conaffinity"]


class OverlapTest:
    """Asks the engine for distances between shapes."""

    def __init__(self, env: LazyComposerEnv, geoms: GeomIndex) -> None:
        self._env, self._geoms = env, geoms

    def touched(self, item: MovableObject) -> list[str]:
        """Owners of the solids that an object touches at its pose in the engine, the closest first.

        For an object on the floor, or on what is as flat as a rug, the first owner is `FLOOR`.
        """
        model, data, index = self._env.model, self._env.data, self._geoms
        closest: dict[str, float] = {}
        for geom in range(item.geoms.start, item.geoms.stop):
            if data.geom_xpos[geom, 2] - _extent(model, data, index, geom) < CONTACT_M:
                closest[FLOOR] = -math.inf
            for other in self._near(item, geom, CONTACT_M):
                gap = mujoco.mj_geomDistance(model, data, geom, other, 1.0, None)
                if gap < CONTACT_M:
                    owner = str(index.owner[other])
                    closest[owner] = min(gap, closest.get(owner, math.inf))
                    if index.fixed[other] and _top(model, data, index, other) <= STEP_M:
                        closest[FLOOR] = -math.inf
        return sorted(closest, key=lambda owner: (closest[owner], owner))

    def beside(self, geoms: Iterable[int], numbers: Any) -> list[int]:
        """Numbers of the objects that touch one of these geoms; ``numbers`` (N,): the object of each, -1 for none."""
        model, data, radius = self._env.model, self._env.data, self._geoms.radius
        others = np.flatnonzero((numbers >= 0) & (model.geom_contype & _MEETS != 0))
        found: set[int] = set()
        for geom in geoms:
            apart = np.linalg.norm(data.geom_xpos[others] - data.geom_xpos[geom], axis=1)
            for other in others[apart < radius[others] + radius[geom] + CONTACT_M].tolist():
                number = int(numbers[other])
                if number == numbers[geom] or number in found:
                    continue
                if mujoco.mj_geomDistance(model, data, geom, other, 1.0, None) < CONTACT_M:
                    found.add(number)
        return sorted(found)

    def inside(self, item: MovableObject, deep: float = OVERLAP_M) -> str:
        """Id of a thing, wall or object that the object overlaps at its pose in the engine, empty for none.

        Overlaps of less than ``deep`` [m] do not count. A carried object counts as solid here.
        """
        model, data, index = self._env.model, self._env.data, self._geoms
        mujoco.mj_kinematics(model, data)
        for geom in range(item.geoms.start, item.geoms.stop):
            if data.geom_xpos[geom, 2] - _extent(model, data, index, geom) < -deep:
                return FLOOR
            for other in self._near(item, geom):
                if mujoco.mj_geomDistance(model, data, geom, other, 1.0, None) < -deep:
                    return str(index.owner[other])
        return ""

    def depths(self, item: MovableObject, deep: float) -> dict[str, float]:
        """Owners of the solids that the object overlaps by more than ``deep`` [m] where its shapes are now, and by how
        much; the floor is not among them.
        """
        model, data = self._env.model, self._env.data
        found: dict[str, float] = {}
        for geom in range(item.geoms.start, item.geoms.stop):
            for other in self._near(item, geom):
                over = -float(mujoco.mj_geomDistance(model, data, geom, other, 1.0, None))
                if over > deep:
                    owner = str(self._geoms.owner[other])
                    found[owner] = max(over, found.get(owner, 0.0))
        return found

    def _near(self, item: MovableObject, geom: int, gap: float = 0.0) -> list[int]:
        """Solids of other owners whose bounding spheres are within ``gap`` [m] of that of solid ``geom``."""
        model, data, radius = self._env.model, self._env.data, self._geoms.radius
        solid = (model.geom_contype & _MEETS) != 0
        solid &= model.geom_type != int(mujoco.mjtGeom.mjGEOM_PLANE)
        solid[item.geoms] = False
        others = np.flatnonzero(solid)
        apart = np.linalg.norm(data.geom_xpos[others] - data.geom_xpos[geom], axis=1)
        near: list[int] = others[apart < radius[others] + radius[geom] + gap].tolist()
        return near


def _top(model: Any, data: Any, index: GeomIndex, geom: int) -> float:
    """Height [m] of the highest point of a solid."""
    return float(data.geom_xpos[geom, 2]) + _extent(model, data, index, geom)


def _extent(model: Any, data: Any, index: GeomIndex, geom: int) -> float:
    """Half the height [m] of a solid."""
    shape, half, up = model.geom_type[geom], index.half[geom], data.geom_xmat[geom, 6:9]
    if shape == int(mujoco.mjtGeom.mjGEOM_SPHERE):
        return float(half[0])
    if shape == int(mujoco.mjtGeom.mjGEOM_CYLINDER):
        return float(abs(up[2]) * half[2] + half[0] * np.hypot(up[0], up[1]))
    return float(np.abs(up) @ half)
