"""Triangle meshes with texture coordinates, and their materials."""

from typing import Any, NamedTuple

from msgspec import Struct

from hthor.types import Rgba


class Mesh(NamedTuple):
    """Triangles. ``vertices`` (V, 3) float32 [m]; ``faces`` (F, 3) int32, counter-clockwise seen from outside; ``uv``
    (V, 2) float32, where one unit is one repeat of the texture and (0, 0) is its upper left corner; ``normals`` (V, 3)
    float32 unit vectors.
    """

    vertices: Any
    faces: Any
    uv: Any
    normals: Any


class Material(Struct, frozen=True, kw_only=True):
    """The material of a mesh. ``texture`` names one of `hthor.looks.textures`; if it is empty, ``rgba`` is the color.

    A texture is multiplied by ``rgba``. ``specular``, ``shininess`` and ``emission`` (light of its own) are 0 to 1.
    """

    rgba: Rgba = (1.0, 1.0, 1.0, 1.0)
    texture: str = ""
    specular: float = 0.1
    shininess: float = 0.2
    emission: float = 0.0


class Piece(NamedTuple):
    """One mesh of a thing in the thing's local frame; ``moves`` names the `hthor.types.Joint` that moves it."""

    mesh: Mesh
    material: Material
    moves: str = ""
