"""The movable objects of one episode: the position, support and holder of each."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import numpy as np

from hthor.types import Vec3
from hthor.world.model import geoms as geom_bits
from hthor.world.model.composer_env import LazyComposerEnv, QPose
from hthor.world.model.geom_index import GeomIndex
from hthor.world.model.inventory import MovableSpec
from hthor.world.records import ObjectRecord
from hthor.world.state.bearer import bearer
from hthor.world.state.movable_object import ABSENT_POSITION, MovableObject
from hthor.world.state.overlap_test import OverlapTest
from hthor.world.state.support_surfaces import SupportSurface, SupportSurfaces


class Objects:
    """All movable objects of a world.

    Attributes:
        changes: grows whenever any object's position, holder or support changes. roster: grows whenever an object may
            have entered or left the episode.
        positions: (N, 3) float64 [m], the objects' centres. present: (N,) bool, which objects are in the episode.
        low: numbers of the objects that lie or roll on the floor, lie on others there, or fall.
    """

    def __init__(
        self,
        movables: Iterable[MovableSpec],
        env: LazyComposerEnv,
        geoms: GeomIndex,
        surfaces: SupportSurfaces,
        overlap: OverlapTest,
    ) -> None:
        self._env, self._geoms, self._surfaces, self._overlap = env, geoms, surfaces, overlap
        ordered = sorted(movables, key=lambda movable: movable.id)
        items = [MovableObject(movable, n, env.model, geoms.span[movable.id]) for n, movable in enumerate(ordered)]
        self._items = {item.id: item for item in items}
        self._list = items
        self._trees = np.array([item.tree for item in items], int)
        self._solids = np.full(env.model.ngeom, -1)
        for item in items:
            self._solids[item.geoms] = item.number
        self._homes = {one.id: one.home for one in ordered if one.home is not None}
        self._beneath = {id: surfaces.support(home, self._items[id].size[2]) for id, home in self._homes.items()}
        self.positions = np.full((len(items), 3), ABSENT_POSITION)
        self.present = np.zeros(len(items), np.bool_)
        self._ghosts: set[str] = set()
        self._loose: set[int] = set()
        self._news: set[int] = set()
        self.low: set[int] = set()
        self.changes = self.roster = 0

    def __iter__(self) -> Iterator[MovableObject]:
        return iter(self._list)

    def get(self, id: str) -> MovableObject | None:
        """The object with this id if it is in the episode, else None."""
        item = self._items.get(id)
        return item if item is not None and item.present else None

    def known(self, id: str) -> MovableObject | None:
        """The object with this id, whether it is in the episode or not; None if there is none."""
        return self._items.get(id)

    def news(self) -> list[MovableObject]:
        """The objects that may have changed since the last call, by id; all objects after a reset."""
        news, self._news = self._news, set()
        return [self._list[number] for number in sorted(news)]

    def _moving(self) -> list[MovableObject]:
        """The objects, in no hand, that the engine may have moved in the last tick; by id."""
        awake = np.flatnonzero(self._env.asleep[self._trees] < 0).tolist() if len(self._trees) else []
        items = (self._list[number] for number in sorted({*awake, *self._loose}))
        return [item for item in items if item.present and not item.held_by]

    def wake_beside(self, geoms: Iterable[int]) -> None:
        """Let the engine move the resting objects that touch these solids, which are about to be taken away.

        Without this they would sleep on in the air, as the engine wakes only what something runs into.
        """
        touching = [self._list[number] for number in self._overlap.beside(geoms, self._solids)]
        asleep = [item for item in touching if item.present and not item.held_by and self._env.asleep[item.tree] >= 0]
        if asleep:
            self._loose.update(item.number for item in asleep)
            self._env.wake(item.dof for item in asleep)

    def shove(self, item: MovableObject, pose: QPose, velocity: Sequence[float]) -> None:
        """Put an object that nobody holds at ``pose``, with a velocity (6,) [m/s, rad/s]; call the engine's `touch`
        after the last.
        """
        data = self._env.data
        data.qpos[item.qpos : item.qpos + 7] = pose
        data.qvel[item.dof : item.dof + 6] = velocity
        self._read(item, pose)
        self._loose.add(item.number)
        self.changes += 1

    def reset(self, starts: Mapping[str, tuple[Vec3, float, str]]) -> None:
        """Begin an episode after a reset of the engine; ``starts`` maps id -> (position [m], yaw [rad], support)."""
        for id in sorted(self._ghosts):
            self._collide(self._items[id], True)
        self._loose.clear()
        self.low.clear()
        self.positions[:], self.present[:] = ABSENT_POSITION, False
        for item in self._list:
            item.clear()
            if item.id in starts:
                position, item.yaw, support = starts[item.id]
                item.present, item.position = True, position
                self.positions[item.number], self.present[item.number] = position, True
                home = self._homes.get(item.id)
                beneath = self._beneath[item.id] if home == position else self._below(item)
                item.support = beneath or support
                if not beneath:
                    self._sort(item)
        self._geoms.hide_all_but(())
        self._news.update(range(len(self._list)))
        self.changes += 1
        self.roster += 1

    def take(self, id: str, seat: str, hand: Callable[[], QPose]) -> None:
        """From now on the object is in the hand of ``seat``; ``hand()`` returns the hand's pose."""
        item = self._items[id]
        self._leave(item)
        item.held_by, item.support = seat, ""
        self._news.add(item.number)
        self._loose.discard(item.number)
        self.low.discard(item.number)
        self._collide(item, False)
        self._env.carry(item.tree, item.qpos, item.dof, hand)
        self._after_handling()
        self.follow(id)

    def grip(self, id: str, bearers: tuple[str, ...]) -> None:
        """From now on exactly these seats hold the object by its handles."""
        item = self._items[id]
        item.bearers, item._state = bearers, None
        self._news.add(item.number)
        self.changes += 1

    def put(self, id: str, pose: QPose, support: str) -> None:
        """Let go of the held object at ``pose``, a little above ``support``, or in the air."""
        item = self._items[id]
        item.held_by, item.support = "", support
        self._loose.add(item.number)
        self._read(item, pose)
        if not support:
            self._sort(item)
        self._collide(item, True)
        self._env.release(item.tree, pose)
        self._after_handling()

    def move(self, id: str, pose: QPose, velocity: Vec3 = (0.0, 0.0, 0.0)) -> None:
        """Put an object that nobody holds at ``pose`` with ``velocity`` [m/s]; from then on the engine moves it."""
        item, data = self._items[id], self._env.data
        self._leave(item)
        item.present, item.support = True, ""
        self.present[item.number] = True
        self._loose.add(item.number)
        data.qpos[item.qpos : item.qpos + 7] = pose
        data.qvel[item.dof : item.dof + 6] = (*velocity, 0.0, 0.0, 0.0)
        self._read(item, pose)
        item.support = self._below(item)
        self._sort(item)
        self._env.touch()
        self.changes += 1
        self.roster += 1

    def pose(self, id: str) -> QPose:
        """The present pose of an object."""
        at = self._items[id].qpos
        x, y, z, w, i, j, k = self._env.data.qpos[at : at + 7].tolist()
        return x, y, z, w, i, j, k

    def remove(self, id: str, parking: QPose) -> None:
        """Take an object that nobody holds out of the episode, to the pose ``parking``."""
        item, data = self._items[id], self._env.data
        self._leave(item)
        data.qpos[item.qpos : item.qpos + 7] = parking
        data.qvel[item.dof : item.dof + 6] = 0.0
        item.clear()
        self.positions[item.number], self.present[item.number] = ABSENT_POSITION, False
        self._loose.discard(item.number)
        self.low.discard(item.number)
        self._news.add(item.number)
        self._env.touch()
        self.changes += 1
        self.roster += 1

    def ride(self, ids: Iterable[str], way: Vec3) -> None:
        """Move objects by ``way`` [m] together with the drawer that they lie in."""
        data = self._env.data
        for id in ids:
            item = self._items[id]
            data.qpos[item.qpos : item.qpos + 3] += way
            data.qvel[item.dof : item.dof + 6] = 0.0
            self._read(item, data.qpos[item.qpos : item.qpos + 7].tolist())
            self._loose.add(item.number)
        self._env.touch()
        self.changes += 1

    def records(self) -> tuple[ObjectRecord, ...]:
        """The objects of the episode."""
        return tuple(
            ObjectRecord(
                id=item.id,
                position=item.position,
                yaw=item.yaw,
                support=item.support,
                held_by=item.held_by,
                bearers=item.bearers,
                loose=item.number in self._loose,
                ghost=item.id in self._ghosts,
            )
            for item in self._list
            if item.present
        )

    def restore(self, records: Iterable[ObjectRecord], hand: Callable[[MovableObject], Callable[[], QPose]]) -> None:
        """Go back to these objects, after the engine; ``hand(item)`` gives the pose of the hand that holds one."""
        known = {record.id: record for record in records}
        ghosts = {record.id for record in known.values() if record.ghost}
        for id in sorted(self._ghosts ^ ghosts):
            self._collide(self._items[id], id not in ghosts)
        self._loose.clear()
        self.low.clear()
        self.positions[:], self.present[:] = ABSENT_POSITION, False
        for item in self._list:
            item.clear()
            if (record := known.get(item.id)) is None:
                continue
            item.present, item.position, item.yaw = True, record.position, record.yaw
            item.support, item.held_by, item.bearers = record.support, record.held_by, record.bearers
            self.positions[item.number], self.present[item.number] = item.position, True
            if record.loose:
                self._loose.add(item.number)
            if not item.held_by:
                self._sort(item)
            if item.held_by:
                self._env.carry(item.tree, item.qpos, item.dof, hand(item))
        self._news.update(range(len(self._list)))
        self._after_handling()
        self.roster += 1

    def lying(self, place: SupportSurface) -> tuple[MovableObject, ...]:
        """The objects that lie on a surface, directly or on top of others."""
        return tuple(
            item
            for item in self._list
            if item.present and not item.held_by and place.holds(item.position, item.size[2])
        )

    def follow(self, id: str) -> None:
        """Update a carried object after its holder has moved."""
        item = self._items[id]
        self._env.pin()
        self._read(item, self._env.data.qpos[item.qpos : item.qpos + 7].tolist())
        self.changes += 1

    def at(self, dof: int) -> str:
        """Id of the object that a degree of freedom of the engine belongs to, empty for none."""
        return next((item.id for item in self._list if item.dof <= dof < item.dof + 6), "")

    def reread(self) -> None:
        """Read all objects again after the engine has gone back to an earlier state."""
        for item in self._list:
            if item.present and not item.held_by:
                self._read(item, self._env.data.qpos[item.qpos : item.qpos + 7].tolist())
                self._loose.add(item.number)
        self.changes += 1

    def settle(self) -> list[tuple[MovableObject, Vec3]]:
        """Read from the engine the objects that moved in the last tick, and find the support of those now at rest.

        Returns:
            the objects, by id, each with its position [m] before.
        """
        moved = [(item, item.position) for item in self._moving()]
        for item, _ in moved:
            self._read(item, self._env.data.qpos[item.qpos : item.qpos + 7].tolist())
            self._loose.add(item.number)
            if self._env.asleep[item.tree] >= 0:
                self._loose.discard(item.number)
                item.support = self._below(item) or bearer(item, self.get, self._surfaces, self._overlap)
            self._sort(item)
            self.changes += 1
        return moved

    def _leave(self, item: MovableObject) -> None:
        """Wake what rests on an object, before it leaves its place."""
        if item.present and not item.held_by:
            self.wake_beside(range(item.geoms.start, item.geoms.stop))

    def _read(self, item: MovableObject, pose: Sequence[float]) -> None:
        item.at(pose)
        self.positions[item.number] = item.position
        self._news.add(item.number)

    def _sort(self, item: MovableObject) -> None:
        """Note whether the object is low: at rest on no furniture, dropped or thrown and not yet at rest, or moving and
        no longer above a surface of furniture.
        """
        borne = item.support and (item.number not in self._loose or self._below(item))
        (self.low.discard if borne else self.low.add)(item.number)

    def _below(self, item: MovableObject) -> str:
        return self._surfaces.support(item.position, item.size[2])

    def _collide(self, item: MovableObject, on: bool) -> None:
        bits = geom_bits.MOVABLE if on else geom_bits.GHOST
        self._env.model.geom_contype[item.geoms] = bits["contype"]
        self._env.model.geom_conaffinity[item.geoms] = bits["conaffinity"]
        (self._ghosts.discard if on else self._ghosts.add)(item.id)

    def _after_handling(self) -> None:
        self._geoms.hide_all_but(item.id for item in self._list if item.held_by)
        self.changes += 1
