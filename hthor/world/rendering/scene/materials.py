"""The materials of floors, walls and trim of a house."""

from msgspec import structs

from hthor.looks import Material, materials, textures
from hthor.types import Wall

CEILING = Material(rgba=(0.95, 0.95, 0.94, 1.0), emission=0.38, specular=0.0)
TRIM = Material(rgba=(0.93, 0.92, 0.90, 1.0), emission=0.12, specular=0.15, shininess=0.3)
THRESHOLD = Material(rgba=(0.46, 0.36, 0.27, 1.0), specular=0.15)
GLASS = materials.glass((0.80, 0.90, 0.95, 0.14))
LAWN = Material(rgba=(0.52, 0.64, 0.36, 1.0), emission=0.60, specular=0.0)
LAWN_ABOVE = Material(rgba=(0.47, 0.58, 0.33, 1.0), emission=0.20, specular=0.0)
"""The lawn as bright as the horizon, for views through windows, and darker, for the view from above."""
_WALL_GLOW, _FLOOR_GLOW = 0.10, 0.04
"""Light from all sides in addition to that of the lamps."""


def floor(name: str) -> Material:
    """The material of a floor by the name that the house gives it."""
    return structs.replace(materials.floor(name), emission=_FLOOR_GLOW)


def is_exterior(face: Wall) -> bool:
    """Whether a face is outdoors; ProcTHOR's own files mark that only in the id."""
    return face.room == "exterior" or face.id.startswith("wall|exterior|")


def wall(face: Wall) -> Material:
    """A wall face's material, in the colour that the house gives it; without any, an outdoor face is of brick."""
    name = face.material or ("brick" if is_exterior(face) else "")
    return structs.replace(materials.wall(name, face.rgb), emission=_WALL_GLOW)


def repeat(material: Material) -> float:
    """Side [m] of one repeat of the material's texture."""
    return textures.scale(material.texture) or 1.0
