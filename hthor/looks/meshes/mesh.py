"""Triangle meshes with texture coordinates, and what they are made of."""

from typing import Any, NamedTuple

from msgspec import Struct

from hthor.types import Rgba


class Mesh(NamedTuple):
    """Triangles. ``vertices`` (V, 3) float32 [m]; ``faces`` (F, 3) int32, counter-clockwise seen from outside; ``uv``
    (V, 2) float32, one unit a repeat of the texture, (0, 0) the picture's upper left corner; ``normals`` (V, 3) float32
    unit vectors.
    """

    vertices: Any
    faces: Any
    uv: Any
    normals: Any


class Material(Struct, frozen=True, kw_only=True):
    """What a mesh is made of. ``texture`` names one of `hthor.looks.textures`, empty for plain ``rgba``.

    A texture is multiplied by ``rgba``. ``specular`` and ``shininess`` are 0 to 1, as is ``emission``, its own light.
    """

    rgba: Rgba = (1.0, 1.0, 1.0, 1.0)
    texture: str = ""
    specular: float = 0.1
    shininess: float = 0.2
    emission: float = 0.0


class Piece(NamedTuple):
    """One mesh of a thing in the thing's local frame; ``moves`` names the `hthor.types.Joint` it moves with."""

    mesh: Mesh
    material: Material
    moves: str = ""
