"""Puts and removes objects directly, to prepare a scene."""

import math
from collections.abc import Sequence

from hthor.errors import HthorError, UnknownName
from hthor.geometry import plane
from hthor.types import HouseSpec, Vec3
from hthor.world import numbers
from hthor.world.model.composer_env import SPEED_MAX_M_S, LazyComposerEnv, QPose
from hthor.world.model.composer_task import HouseTask
from hthor.world.model.geom_index import GeomIndex
from hthor.world.model.geoms import quaternion
from hthor.world.state import support_surfaces
from hthor.world.state.movable_object import MovableObject
from hthor.world.state.objects import Objects
from hthor.world.state.overlap_test import OverlapTest
from hthor.world.state.support_surfaces import SupportSurfaces


class SceneEditor:
    """Puts and removes the objects of one world."""

    def __init__(
        self,
        house: HouseSpec,
        task: HouseTask,
        env: LazyComposerEnv,
        geoms: GeomIndex,
        objects: Objects,
        surfaces: SupportSurfaces,
        overlap: OverlapTest,
    ) -> None:
        self._house = house
        self._env, self._geoms, self._objects, self._surfaces, self._overlap = env, geoms, objects, surfaces, overlap
        self._parking = {prop.id: task.parking(number) for number, prop in enumerate(task.props)}

    def put(self, id: str, position: Sequence[float] | None, on: str, yaw: float, velocity: Sequence[float]) -> None:
        """See `World.put_object`."""
        item = self._idle(id)
        at = None if position is None else numbers.point3("position", position)
        speed = numbers.point3("velocity", velocity, "metres a second")
        yaw = plane.wrap(numbers.number("yaw", yaw, "radians"))
        if math.hypot(*speed) > SPEED_MAX_M_S:
            raise HthorError(f"velocity must be at most {SPEED_MAX_M_S:.0f} m/s, got {math.hypot(*speed):.3g} m/s")
        if on:
            self._objects.move(id, self._on(item, on, at, yaw), speed)
        elif at is not None:
            self._at(item, (*at, *quaternion(yaw)), speed)
        else:
            raise HthorError(f"say where to put {id}: give its position, or what to put it on")

    def remove(self, id: str) -> None:
        """See `World.remove_object`."""
        self._idle(id)
        self._objects.remove(id, self._parking[id])

    def _idle(self, id: str) -> MovableObject:
        item = self._objects.known(id)
        if item is None:
            raise UnknownName("object", id, [one.id for one in self._objects])
        if item.held_by or item.bearers:
            who = " and ".join(item.bearers) or item.held_by
            raise HthorError(f"{id} is in the hand of {who}; have it placed or dropped first")
        return item

    def _on(self, item: MovableObject, on: str, near: Vec3 | None, yaw: float) -> QPose:
        """The free place on the thing nearest to ``near`` or to a surface's middle; inside it only if it has no top."""
        surfaces = self._surfaces.of(on)
        if not surfaces:
            known = sorted({place.thing for place in self._surfaces.all()})
            raise UnknownName("thing to put objects on", on, known)
        if near is None:
            surfaces = tuple(place for place in surfaces if not place.inside) or surfaces
        boxes = self._geoms.boxes_but(on, item.id)
        found = []
        for turn in (yaw, yaw + math.pi / 2):
            w, d = abs(math.cos(turn)), abs(math.sin(turn))
            size = (w * item.size[0] + d * item.size[1], d * item.size[0] + w * item.size[1], item.size[2])
            for order, place in enumerate(surfaces):
                goal = near or place.centre
                spots = support_surfaces.free_spots(place, size, boxes, goal)
                if spots:
                    rank = math.dist(spots[0], goal) if near else float(order)
                    found.append((round(rank, 6), (*spots[0], *quaternion(place.yaw + turn))))
            if found:
                return min(found)[1]
        w, d = item.size[:2]
        raise HthorError(f"no room on {on} for {item.id}, which needs {w:.2f} x {d:.2f} m; remove something first")

    def _at(self, item: MovableObject, pose: QPose, velocity: Vec3) -> None:
        """Put the object exactly at ``pose``; if that is not free, put it back and raise HthorError."""
        indoors = any(plane.inside(pose[:2], room.polygon) for room in self._house.rooms)
        if not indoors or pose[2] > self._house.height:
            at = ", ".join(numbers.format_number(value) for value in pose[:3])
            raise HthorError(f"({at}) is in no room of the house; give a position indoors")
        data = self._env.data
        rows, speeds = slice(item.qpos, item.qpos + 7), slice(item.dof, item.dof + 6)
        old = data.qpos[rows].copy(), data.qvel[speeds].copy()
        data.qpos[rows] = pose
        where = self._overlap.inside(item)
        if where:
            data.qpos[rows], data.qvel[speeds] = old
            self._env.touch()
            x, y, z = pose[:3]
            raise HthorError(f"{item.id} would be inside {where} at ({x:.2f}, {y:.2f}, {z:.2f}); give a free position")
        self._objects.move(item.id, pose, velocity)
