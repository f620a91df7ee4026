"""Meshes and materials as assets of the visual model, each stored once; those of an optional pack come first."""

from collections.abc import Hashable
from typing import Any, Protocol

import msgspec
import numpy as np

from hthor import looks
from hthor.looks import Material, Mesh, Piece
from hthor.looks.pack import Pack
from hthor.types import Vec3
from hthor.world.model.engine import mujoco
from hthor.world.model.geoms import Quaternion

_THIN = 1e-12


class AssetSource:
    """The looks of things: the pack's if it has any for a thing, else our own.

    Attributes:
        sha256: hash of the pack, empty without one.

    Textures of a pack are called ``pack:NAME`` in the visual model, so that their names may equal those of ours.
    """

    def __init__(self, pack: Pack | None = None) -> None:
        self._pack = pack
        self.sha256 = "" if pack is None else pack.sha256

    def look(self, kind: str, size: Vec3, variant: int) -> tuple[Piece, ...]:
        """The pieces of a thing, see `hthor.looks.look`."""
        pieces = None if self._pack is None else self._pack.look(kind, size, variant)
        if pieces is None:
            return looks.look(kind, size, variant)
        return tuple(_marked(piece) for piece in pieces)

    def texture(self, name: str) -> Any:
        """(H, W, 3) uint8, its first row at v = 0."""
        if name.startswith("pack:") and self._pack is not None:
            return np.asarray(self._pack.texture(name.removeprefix("pack:")), np.uint8)
        return looks.textures.image(name)


def _marked(piece: Piece) -> Piece:
    material = piece.material
    if not material.texture:
        return piece
    return piece._replace(material=msgspec.structs.replace(material, texture=f"pack:{material.texture}"))


class Stage(Protocol):
    """Where a `hthor.world.rendering.scene.compile_scene.SceneBuilder` puts what it builds."""

    world: Any

    def puppet(self) -> Any:
        """A new body that moves; puppets are counted in the order in which they are made."""

    def geom(
        self,
        body: Any,
        owner: str,
        mesh: Mesh,
        material: Material,
        group: int = 0,
        key: Hashable = None,
        pos: Vec3 = (0.0, 0.0, 0.0),
        quat: Quaternion = (1.0, 0.0, 0.0, 0.0),
    ) -> None:
        """Add a mesh to ``world`` or a puppet, in its frame; meshes with the same ``key`` are the same."""


class AssetRegistry:
    """Adds geoms to a `mujoco.MjSpec`; the `Stage` of pictures.

    Args:
        spec: the model that is being built. fabric: the source of textures.

    Attributes:
        world: the body of everything that never moves.
    """

    def __init__(self, spec: Any, fabric: AssetSource) -> None:
        self._spec, self._fabric, self.world = spec, fabric, spec.worldbody
        self._meshes: dict[Hashable, str] = {}
        self._materials: dict[Material, str] = {}
        self._owners: list[str] = []
        self._textures: dict[str, str] = {}

    def geom(
        self,
        body: Any,
        owner: str,
        mesh: Mesh,
        material: Material,
        group: int = 0,
        key: Hashable = None,
        pos: Vec3 = (0.0, 0.0, 0.0),
        quat: Quaternion = (1.0, 0.0, 0.0, 0.0),
    ) -> None:
        """Add a mesh to ``body``; meshes with the same ``key`` are stored once."""
        name = self._mesh(mesh, key)
        if name:
            geom = body.add_geom()
            geom.name, geom.type, geom.meshname = self.named(owner), mujoco.mjtGeom.mjGEOM_MESH, name
            geom.contype = geom.conaffinity = 0
            geom.group, geom.material, geom.rgba = group, self.material(material), material.rgba
            geom.pos, geom.quat = pos, quat

    def puppet(self) -> Any:
        """A new body that pictures place where they like."""
        body = self._spec.worldbody.add_body()
        body.mocap = True
        return body

    def named(self, owner: str) -> str:
        """A name for a new geom of ``owner``."""
        self._owners.append(owner)
        return str(len(self._owners) - 1)

    def owners(self, model: Any) -> tuple[str, ...]:
        """The owner of each geom of the compiled model."""
        names = (mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, geom) for geom in range(model.ngeom))
        return tuple(self._owners[int(name)] for name in names)

    def _mesh(self, mesh: Mesh, key: Hashable) -> str:
        if key is not None and key in self._meshes:
            return self._meshes[key]
        vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces)
        corners = vertices[faces]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        faces = faces[area > _THIN]
        name = f"mesh {len(self._meshes)}" if len(faces) else ""
        self._meshes[len(self._meshes) if key is None else key] = name
        if name:
            _store(self._spec.add_mesh(), name, mesh, faces)
        return name

    def material(self, material: Material) -> str:
        """The name of the engine's material for ``material``, which is made at its first use."""
        if material in self._materials:
            return self._materials[material]
        name = f"material {len(self._materials)}"
        made = self._spec.add_material()
        made.name, made.rgba = name, material.rgba
        made.specular, made.shininess, made.emission = material.specular, material.shininess, material.emission
        if material.texture:
            made.textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = self._texture(material.texture)
        self._materials[material] = name
        return name

    def _texture(self, name: str) -> str:
        if name not in self._textures:
            image = np.ascontiguousarray(self._fabric.texture(name))
            made = self._spec.add_texture()
            made.name, made.type = f"texture {len(self._textures)}", mujoco.mjtTexture.mjTEXTURE_2D
            made.height, made.width, made.nchannel = image.shape
            made.data = image.tobytes()
            self._textures[name] = made.name
        return self._textures[name]


def _store(made: Any, name: str, mesh: Mesh, faces: Any) -> None:
    made.name, made.inertia = name, mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    made.uservert = np.asarray(mesh.vertices, "f4").ravel()
    made.usernormal = np.asarray(mesh.normals, "f4").ravel()
    made.usertexcoord = np.asarray(mesh.uv, "f4").ravel()
    corners = faces.astype("i4").ravel()
    made.userface = made.userfacenormal = made.userfacetexcoord = corners
