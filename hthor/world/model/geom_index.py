"""The compiled model's geoms as plain arrays: their owners, and which of them hide things."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from hthor.geometry.ray_casting import is_blocked
from hthor.types import Vec3
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.composer_task import HouseTask
from hthor.world.model.engine import mujoco

_OPAQUE_ALPHA = 0.5
"""[0..1] Geoms that are less opaque than this, such as glass, hide nothing."""


class GeomIndex:
    """Boxes around all solids, in the layout of `hthor.geometry.ray_casting`, and the list of those that hide things.

    Attributes:
        half: (N, 3) half extents [m]. pos: (N, 3) centres. mat: (N, 9) rotations; both are live views of the engine.
        radius: (N,) bounding radii [m]. owner: id of each geom's thing, seat, room, wall or opening.
        walls: indices of the geoms in ``ids`` that never move, including furniture, largest first. loose: the others.
        ids: indices of the geoms that hide things, largest first; carried objects are not among them.
        fixed: (N,) bool, which geoms are solid and never move, window panes included, which hide nothing.
        names: the owners in alphabetic order. numbers: (N,) index of each geom's owner in ``names``.
        span: owner -> [first, last + 1) of its geoms; for a thing with a door, only of those that never move.
    """

    def __init__(self, env: LazyComposerEnv, task: HouseTask) -> None:
        model, data = env.model, env.data
        self.half = _halves(model)
        self.pos, self.mat = data.geom_xpos, data.geom_xmat.reshape(-1, 9)
        self.radius = np.linalg.norm(self.half, axis=1)
        self.owner = tuple(_owners(model, task))
        self.span = _spans(self.owner)
        self.names = tuple(sorted(set(self.owner)))
        self._number = {owner: number for number, owner in enumerate(self.names)}
        self.numbers = np.array([self._number[owner] for owner in self.owner])
        self._drawn = model.geom_rgba[:, 3] >= _OPAQUE_ALPHA
        solid = (model.geom_contype != 0) & (model.geom_type != int(mujoco.mjtGeom.mjGEOM_PLANE))
        self.fixed = solid & (model.body_weldid[model.geom_bodyid] == 0)
        self.solid, self._glass = solid & self._drawn, np.flatnonzero(self.fixed & ~self._drawn)
        self.walls = self._sorted(self.solid & self.fixed)
        self._moving = self.solid & ~self.fixed
        self.ids = self.loose = np.zeros(0, np.int64)
        self.hide_all_but(())

    def hide_all_but(self, ghosts: Iterable[str]) -> None:
        """Set which objects hide nothing from now on (``ghosts``), because someone carries them."""
        solid = self.solid.copy()
        for id in ghosts:
            solid[slice(*self.span[id])] = False
        self.ids, self.loose = self._sorted(solid), self._sorted(solid & self._moving)

    def _sorted(self, chosen: Any) -> Any:
        """Indices of the chosen geoms, largest first."""
        ids = np.flatnonzero(chosen)
        return ids[np.argsort(-self.radius[ids], kind="stable")]

    def drawn(self, owner: str) -> list[int]:
        """Indices of the opaque geoms of a thing, an object or a seat, whether they hide anything or not."""
        found: list[int] = np.flatnonzero(self._drawn & (self.numbers == self._number.get(owner, -1))).tolist()
        return found

    def hidden(self, eye: Vec3, point: Vec3, ignore: str = "") -> bool:
        """Whether something other than ``ignore`` stands between the two points [m]."""
        ends = np.array(eye), np.array(point)
        return bool(is_blocked(*ends, self.half, self.pos, self.mat, self.radius, self._without(ignore), 0, 0))

    def first(self, start: Vec3, end: Vec3, ignore: str = "") -> str:
        """Owner of a solid, other than ``ignore``, that stands between two points [m]; empty for none. A window pane,
        which hides nothing, is one of them.
        """
        ends, ids = (np.array(start), np.array(end)), np.concatenate((self._without(ignore), self._glass))
        solids = self.half, self.pos, self.mat, self.radius
        met = (self.owner[geom] for geom in ids if is_blocked(*ends, *solids, np.array([geom]), 0, 0))
        return next(met, "") if is_blocked(*ends, *solids, ids, 0, 0) else ""

    def is_around(self, geom: int, point: Vec3, margin: float) -> bool:
        """Whether a point [m] is inside the box around a geom, or no farther from it than ``margin`` along its axes."""
        local = self.mat[geom].reshape(3, 3).T @ (np.array(point) - self.pos[geom])
        return bool((np.abs(local) <= self.half[geom] + margin).all())

    def boxes_but(self, *without: str) -> tuple[Any, Any]:
        """Centres (M, 3) and half extents (M, 3) [m] of upright boxes around all solids of all other owners."""
        keep = self.ids[~np.isin(self.numbers[self.ids], [self._number[owner] for owner in without])]
        rotation = np.abs(self.mat[keep].reshape(-1, 3, 3))
        return self.pos[keep], np.einsum("nij,nj->ni", rotation, self.half[keep])

    def _without(self, owner: str) -> Any:
        number = self._number.get(owner)
        return self.ids if number is None else self.ids[self.numbers[self.ids] != number]


def _halves(model: Any) -> Any:
    half = np.array(model.geom_size)
    sphere = model.geom_type == int(mujoco.mjtGeom.mjGEOM_SPHERE)
    cylinder = model.geom_type == int(mujoco.mjtGeom.mjGEOM_CYLINDER)
    half[sphere] = half[sphere][:, :1]
    half[cylinder] = half[cylinder][:, [0, 0, 1]]
    return half


def _owners(model: Any, task: HouseTask) -> Iterator[str]:
    scopes = {f"{entity.mjcf_model.model}/": name for entity, name in _entities(task)}
    for geom in range(model.ngeom):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, geom)
        scope, slash, _ = name.rpartition("/")
        yield scopes[scope + slash] if slash else task.root_entity.owners[name]


def _entities(task: HouseTask) -> Iterator[tuple[Any, str]]:
    yield from ((prop, prop.id) for prop in task.props)
    yield from ((door, door.id) for door in task.doors)
    yield from ((body, body.seat) for body in task.bodies)


def _spans(owners: tuple[str, ...]) -> dict[str, tuple[int, int]]:
    spans: dict[str, tuple[int, int]] = {}
    for geom, owner in enumerate(owners):
        first, end = spans.get(owner, (geom, geom))
        if end == geom:
            spans[owner] = (first, geom + 1)
    return spans
