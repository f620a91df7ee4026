"""The visual model: a house, its things and bodies in their looks, compiled once."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from hthor.looks import Material, Mesh, Piece
from hthor.types import BodySpec, HouseSpec, Thing
from hthor.world.model import door_geometry, geoms
from hthor.world.model.bodies import bodies
from hthor.world.model.engine import mujoco
from hthor.world.model.inventory import Contents, MovableSpec
from hthor.world.rendering.scene import lights, materials
from hthor.world.rendering.scene.apertures import apertures, leaf_meshes
from hthor.world.rendering.scene.asset_registry import AssetRegistry, AssetSource, Stage
from hthor.world.rendering.scene.lights import RoomLights
from hthor.world.rendering.scene.pose_sync import PoseSync
from hthor.world.rendering.scene.scene_mesh import ABOVE, INSIDE, SceneMesh, join
from hthor.world.rendering.scene.shell import shell

_SHADOW_TEXELS, _SAMPLES = 2048, 0
_EXTENT_M = 30.0
"""[m] Half the side of the square that the sun's shadows cover."""
_STILL = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


class CompiledScene(NamedTuple):
    """The compiled visual model.

    ``owner``: the owner of each geom. ``followers``: for each of the first puppets (mocap bodies), the body of the
    physics model that it follows. ``seats``: seat -> the puppets of its body and head, which are the last puppets.
    """

    model: Any
    owner: tuple[str, ...]
    followers: Any
    seats: Mapping[str, tuple[int, int]]


def compile_scene(
    house: HouseSpec,
    contents: Contents,
    puppets: PoseSync,
    fabric: AssetSource,
    seats: Mapping[str, BodySpec],
    lamps: RoomLights,
) -> CompiledScene:
    """The visual model of a house with these bodies in it."""
    spec = mujoco.MjSpec()
    registry = AssetRegistry(spec, fabric)
    _settings(spec)
    for material, group in ((materials.LAWN, INSIDE), (materials.LAWN_ABOVE, ABOVE)):
        _lawn(spec, registry, material, group)
    builder = SceneBuilder(house, contents, puppets, fabric, registry)
    places = builder.build(seats, lamps)
    model = spec.compile()
    return CompiledScene(model, registry.owners(model), np.array(builder.followers, int), places)


def _settings(spec: Any) -> None:
    spec.visual.headlight.active = 0
    spec.visual.quality.shadowsize, spec.visual.quality.offsamples = _SHADOW_TEXELS, _SAMPLES
    spec.visual.map.shadowclip, spec.visual.map.shadowscale = 1.0, 0.93
    spec.stat.extent = _EXTENT_M
    image, sky = lights.sky(), spec.add_texture()
    sky.name, sky.type, sky.nchannel = "sky", mujoco.mjtTexture.mjTEXTURE_SKYBOX, 3
    sky.height, sky.width, sky.data = image.shape[0], image.shape[1], image.tobytes()


def _lawn(spec: Any, registry: AssetRegistry, material: Material, group: int) -> None:
    lawn = spec.worldbody.add_geom()
    lawn.name, lawn.type, lawn.size = registry.named("outdoors"), mujoco.mjtGeom.mjGEOM_PLANE, (60, 60, 1)
    lawn.pos, lawn.contype, lawn.conaffinity, lawn.group = (0.0, 0.0, -0.05), 0, 0, group
    lawn.material, lawn.rgba = registry.material(material), material.rgba


class SceneBuilder:
    """Puts one house, its things and the bodies in it on a stage.

    Attributes:
        followers: for each of the first puppets, the body of the physics model that it follows.
    """

    def __init__(
        self, house: HouseSpec, contents: Contents, puppets: PoseSync, fabric: AssetSource, stage: Stage
    ) -> None:
        self._house, self._contents, self._puppets = house, contents, puppets
        self._fabric, self._stage = fabric, stage
        self.followers: list[int] = []

    def build(self, seats: Mapping[str, BodySpec], lamps: RoomLights) -> dict[str, tuple[int, int]]:
        """Build everything; for each seat the numbers of the puppets of its body and its head."""
        self._merged((*shell(self._house), *apertures(self._house), *lamps.items()))
        for thing in self._contents.statics:
            self._thing(thing)
        for item in self._contents.movables:
            self._movable(item)
        self._doors()
        first = len(self.followers)
        for seat, spec in seats.items():
            self._body(seat, spec)
        return {seat: (first + 2 * number, first + 2 * number + 1) for number, seat in enumerate(seats)}

    def _merged(self, items: Iterable[SceneMesh]) -> None:
        """Add the parts that never move, merged to one geom for each owner, material and group."""
        heaps: dict[tuple[Any, ...], list[Mesh]] = {}
        for item in items:
            heaps.setdefault((item.owner, item.material, item.group), []).append(item.mesh)
        for (owner, material, group), meshes in heaps.items():
            self._stage.geom(self._stage.world, owner, join(meshes), material, group)

    def _thing(self, thing: Thing) -> None:
        """Add a static thing: its fixed pieces to the world body, pieces on its joints to puppets."""
        frame = (thing.centre, geoms.quaternion(thing.yaw))
        key = (thing.kind, thing.size, thing.variant)
        for joint, pieces in _by_joint(self._fabric.look(*key)).items():
            body, at = self._stage.world, frame
            if joint and (thing.id, joint) in self._puppets.hung:
                body, at = self._follower(self._puppets.hung[thing.id, joint], frame)
            self._pieces(body, thing.id, pieces, (key, joint), at)

    def _movable(self, item: MovableSpec) -> None:
        body = self._puppet(self._puppets.free[item.id])
        key = (item.kind, item.size, item.variant)
        for joint, pieces in _by_joint(self._fabric.look(*key)).items():
            self._pieces(body, item.id, pieces, (key, joint), _STILL)

    def _doors(self) -> None:
        """Add the doors in doorways."""
        for opens in door_geometry.doorway_leaves(self._house):
            for joint in opens.joints:
                body, frame = self._follower(self._puppets.hung[opens.id, joint.name], _STILL)
                for item in leaf_meshes(opens, joint):
                    self._stage.geom(body, item.owner, item.mesh, item.material, item.group, None, *frame)

    def _body(self, seat: str, spec: BodySpec) -> None:
        """Add a seat's figure as two movable parts: its body and its head."""
        puppets = {"": self._puppet(), "head": self._puppet()}
        for moves, pieces in _by_joint(bodies.pieces(spec, seat)).items():
            self._pieces(puppets[moves], seat, pieces, (spec, moves), _STILL)

    def _pieces(self, body: Any, owner: str, pieces: Iterable[Piece], key: Any, frame: Any) -> None:
        heaps: dict[Any, list[Mesh]] = {}
        for piece in pieces:
            heaps.setdefault(piece.material, []).append(piece.mesh)
        for material, meshes in heaps.items():
            mesh = meshes[0] if len(meshes) == 1 else join(meshes)
            self._stage.geom(body, owner, mesh, material, 0, (key, material), *frame)

    def _follower(self, physical: int, frame: Any) -> tuple[Any, Any]:
        """A puppet for a body of the physics, and the house frame ``frame`` relative to that body at rest."""
        return self._puppet(physical), self._puppets.relative(physical, frame)

    def _puppet(self, physical: int | None = None) -> Any:
        if physical is not None:
            self.followers.append(physical)
        return self._stage.puppet()


def _by_joint(pieces: Iterable[Piece]) -> dict[str, list[Piece]]:
    found: dict[str, list[Piece]] = {}
    for piece in pieces:
        found.setdefault(piece.moves, []).append(piece)
    return found
