"""The doors and drawers of one episode: which are open and how they move.

A shut doorway stops bodies and range scans: it is an obstacle on each body's free-space grid. These grids are computed
when a door is first shut, and kept. While all doorways are open, the grids are those of the house.
"""

import copy
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from hthor.geometry import plane
from hthor.houses.space import grid_kernel
from hthor.houses.space.free_space import FreeSpace
from hthor.types import Opening, Thing, ThingState
from hthor.world.model import geoms
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.composer_task import Door
from hthor.world.model.door_geometry import LEAF_M
from hthor.world.records import DoorRecord
from hthor.world.state.body_state import BodyState
from hthor.world.state.support_surfaces import SupportSurfaces


class DoorState:
    """All doors and drawers of one thing, which move together, or all doors of a doorway.

    ``user`` is the seat that opens or closes the doors, empty otherwise. ``solids`` are the engine's numbers of all
    moving shapes, ``geoms`` of those that turn on hinges.
    """

    def __init__(self, door: Door, env: LazyComposerEnv) -> None:
        self.thing: Thing = door.thing
        self.opening: Opening | None = door.opens.opening
        self.parts, self.joints = door.opens.parts, door.joints
        ids = [env.physics.bind(element).element_id for element in door.elements]
        self.qpos = [int(env.model.jnt_qposadr[id]) for id in ids]
        self.dof = [int(env.model.jnt_dofadr[id]) for id in ids]
        self.solids = np.flatnonzero(np.isin(env.model.geom_bodyid, env.model.jnt_bodyid[ids])).tolist()
        hinges = [env.model.jnt_bodyid[id] for id, joint in zip(ids, self.joints, strict=True) if joint.kind == "hinge"]
        self.geoms = np.flatnonzero(np.isin(env.model.geom_bodyid, hinges))
        self.clear()

    def clear(self) -> None:
        """The state at the start of an episode: things closed, doorways open."""
        self.open, self.user = self.opening is not None, ""
        self.share = 1.0 if self.open else 0.0

    @property
    def slides(self) -> bool:
        """Whether drawers are among them."""
        return any(joint.kind == "slide" for joint in self.joints)


class Doors:
    """All things that open, and the doorways with doors.

    Attributes:
        changes: grows whenever a door moves.
    """

    def __init__(self, doors: Iterable[Door], env: LazyComposerEnv, surfaces: SupportSurfaces) -> None:
        self._env, self._surfaces = env, surfaces
        self._leaves = {door.id: DoorState(door, env) for door in sorted(doors, key=lambda door: door.id)}
        self._moved: set[str] = set(self._leaves)
        self.changes = 0

    def __iter__(self) -> Iterator[DoorState]:
        return iter(self._leaves.values())

    def get(self, thing: str) -> DoorState | None:
        """The doors of the thing or doorway with this id, None if it has none."""
        return self._leaves.get(thing)

    def reset(self) -> None:
        """Begin an episode, after the engine was reset: things closed, doorways open."""
        for id in sorted(self._moved):
            leaf = self._leaves[id]
            leaf.clear()
            self._firm(leaf)
        if self._moved:
            self._surfaces.reset()
        self._moved.clear()
        self.changes += 1

    def swing(self, leaf: DoorState, share: float) -> None:
        """Set a door ``share`` of the way open, 0 to 1."""
        for joint, qpos, dof in zip(leaf.joints, leaf.qpos, leaf.dof, strict=True):
            self._env.data.qpos[qpos] = joint.travel * share
            self._env.data.qvel[dof] = 0.0
        leaf.share = share
        self._moved.add(leaf.thing.id)
        self._surfaces.pull(leaf.thing.id, share)
        self._firm(leaf)
        self._env.touch()
        self.changes += 1

    def records(self) -> tuple[DoorRecord, ...]:
        """The doors that have been moved in this episode."""
        leaves = (self._leaves[id] for id in sorted(self._moved))
        return tuple(DoorRecord(leaf.thing.id, leaf.share, leaf.open, leaf.user) for leaf in leaves)

    def restore(self, records: Iterable[DoorRecord]) -> None:
        """Go back to these doors, after the engine."""
        self.reset()
        for record in records:
            leaf = self._leaves[record.id]
            leaf.share, leaf.open, leaf.user = record.share, record.open, record.user
            self._moved.add(record.id)
            self._surfaces.pull(record.id, record.share)
            self._firm(leaf)

    def shut(self) -> dict[str, Opening]:
        """The doorways that are shut, by id."""
        return {leaf.thing.id: leaf.opening for leaf in self if leaf.opening is not None and not leaf.open}

    def _firm(self, leaf: DoorState) -> None:
        """Set what the doors stop: a hinged door stops objects only while it is closed, a drawer always."""
        self._env.model.geom_contype[leaf.geoms] = geoms.SWUNG if leaf.share > 0.0 else geoms.SHUT

    def states(self) -> Iterator[ThingState]:
        """True states of all things that open, and of doorways with doors, whose kind is "door"."""
        for leaf in self:
            yield ThingState(id=leaf.thing.id, kind=leaf.thing.kind, position=leaf.thing.centre, open=leaf.open)


class Doorways:
    """The free-space grids of a world's seats, on which shut doorways are obstacles.

    Args:
        seats: the bodies whose ``space`` is updated. spaces: the same grids by seat, updated as well.
    """

    def __init__(self, seats: Iterable[BodyState], spaces: dict[str, FreeSpace]) -> None:
        self._seats, self._spaces = tuple(seats), spaces
        self._open = dict(spaces)
        self._shut: frozenset[str] = frozenset()
        self._known: dict[tuple[str, frozenset[str]], FreeSpace] = {}

    def update(self, shut: Mapping[str, Opening]) -> None:
        """Set which doorways are shut; all others are open."""
        names = frozenset(shut)
        if names == self._shut:
            return
        self._shut = names
        for seat in self._seats:
            seat.space = self._spaces[seat.name] = self._space(seat.name, shut)

    def _space(self, seat: str, shut: Mapping[str, Opening]) -> FreeSpace:
        whole, key = self._open[seat], (seat, frozenset(shut))
        if shut and key not in self._known:
            self._known[key] = with_obstacles(whole, [leaf_rectangle(opening) for opening in shut.values()])
        return self._known[key] if shut else whole


def leaf_rectangle(opening: Opening) -> tuple[float, float, float, float, float]:
    """The rectangle of a shut door on the floor plan: centre x, y, half width, half depth [m], yaw [rad]."""
    (ax, ay), (bx, by) = opening.a, opening.b
    yaw, half = np.arctan2(by - ay, bx - ax), np.hypot(bx - ax, by - ay) / 2
    return ((ax + bx) / 2, (ay + by) / 2, float(half), LEAF_M / 2, float(yaw))


def in_doorway(seat: BodyState, opening: Opening) -> bool:
    """Whether a body stands where the shut door would be, or so near that the door would block its cell."""
    x, y, half, deep, yaw = leaf_rectangle(opening)
    gap = plane.distance_to_rectangle((seat.pose.x, seat.pose.y), (x, y), (2 * half, 2 * deep), yaw)
    return gap < seat.spec.radius + seat.space.cell


def with_obstacles(space: FreeSpace, rectangles: list[tuple[float, float, float, float, float]]) -> FreeSpace:
    """A copy of a grid with these rectangles as additional obstacles."""
    rows = np.array(rectangles, dtype=float).reshape(-1, 5)
    cut: Any = copy.copy(space)
    cut.__dict__.pop("components", None)
    cut.free = grid_kernel.clear_cells(space.free, rows, *space.origin, space.cell, space.radius)
    cut.raw = grid_kernel.clear_cells(space.raw, rows, *space.origin, space.cell, space.cell / 2)
    cut.free.setflags(write=False)
    cut.raw.setflags(write=False)
    narrowed: FreeSpace = cut
    return narrowed
