"""The visual model of a house as plain meshes, for programs that draw it themselves, such as a page in a browser."""

from collections.abc import Hashable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hthor.looks import Material, Mesh
from hthor.types import BodySpec, HouseSpec, Vec3
from hthor.world.model.engine import mujoco
from hthor.world.model.geoms import Quaternion
from hthor.world.model.inventory import Contents
from hthor.world.rendering.camera import PoseSnapshot
from hthor.world.rendering.scene.asset_registry import AssetSource
from hthor.world.rendering.scene.compile_scene import SceneBuilder
from hthor.world.rendering.scene.lights import RoomLights
from hthor.world.rendering.scene.pose_sync import PoseSync, seat_frames

STATIC = -1
"""The puppet of what never moves."""


class ScenePart(NamedTuple):
    """One mesh of the visual model.

    Attributes:
        puppet: what it moves with, the number of a row of `SceneParts.poses`; `STATIC` for nothing.
        owner: the id of the thing or the seat that it belongs to. group: see `hthor.world.rendering.scene.scene_mesh`.
        mesh: in the frame of the puppet, or of the house.
    """

    puppet: int
    owner: str
    mesh: Mesh
    material: Material
    group: int


class SceneParts:
    """Everything of one house that can be seen.

    Attributes:
        parts: the meshes. lamps: the places of each room's lamps.
        assets: hash of the furniture pack that looks come from, empty for our own.
        moving: for each puppet, the id of what moves with it; a seat has two, its body and its head.
        hung: for each puppet that is a door or a drawer, its position [m] and quaternion (w, x, y, z) when it is shut.
    """

    def __init__(
        self,
        house: HouseSpec,
        contents: Contents,
        puppets: PoseSync,
        seats: Mapping[str, BodySpec],
        fabric: AssetSource,
    ) -> None:
        self._puppets, self._fabric, self.assets = puppets, fabric, fabric.sha256
        self.lamps = RoomLights(house)
        collector = _Collector()
        builder = SceneBuilder(house, contents, puppets, fabric, collector)
        self.seats = builder.build(seats, self.lamps)
        self.parts = tuple(collector.parts)
        self._followers = np.array(builder.followers, int)
        doors = set(puppets.hung.values())
        self.hung = {number: puppets.rest(body) for number, body in enumerate(builder.followers) if body in doors}
        owners = {part.puppet: part.owner for part in self.parts}
        self.moving = tuple(owners.get(number, "") for number in range(collector.puppets))

    def texture(self, name: str) -> Any:
        """The picture of a material's texture, (H, W, 3) uint8, its first row at v = 0."""
        return self._fabric.texture(name)

    def poses(self, moment: PoseSnapshot) -> NDArray[np.float64]:
        """Where everything that moves is, (P, 7): position [m] and quaternion (w, x, y, z) of each puppet."""
        position, turn = self._puppets.at(moment.qpos)
        poses = np.empty((len(self.moving), 7))
        count = len(self._followers)
        poses[:count, :3], poses[:count, 3:] = position[self._followers], turn[self._followers]
        for seat, places in self.seats.items():
            for place, (at, turned) in zip(places, seat_frames(*moment.seats[seat]), strict=True):
                poses[place, :3], poses[place, 3:] = at, turned
        return poses


class _Collector:
    """A `hthor.world.rendering.scene.asset_registry.Stage` that keeps what is put on it."""

    def __init__(self) -> None:
        self.world: Any = STATIC
        self.parts: list[ScenePart] = []
        self.puppets = 0

    def puppet(self) -> int:
        """The number of a new puppet."""
        self.puppets += 1
        return self.puppets - 1

    def geom(
        self,
        body: Any,
        owner: str,
        mesh: Mesh,
        material: Material,
        group: int = 0,
        key: Hashable = None,  # noqa: ARG002  every mesh is kept
        pos: Vec3 = (0.0, 0.0, 0.0),
        quat: Quaternion = (1.0, 0.0, 0.0, 0.0),
    ) -> None:
        """Keep a mesh, in the frame of its body."""
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, np.array(quat))
        back = turn.reshape(3, 3).T
        moved = mesh._replace(vertices=mesh.vertices @ back + pos, normals=mesh.normals @ back)
        self.parts.append(ScenePart(body, owner, moved, material, group))
