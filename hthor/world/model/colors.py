"""Colours of floors, walls and doors of the physics model."""

from hthor.looks import finishes
from hthor.types import Rgba, Wall

PANE: Rgba = (0.70, 0.84, 0.92, 0.25)
DOOR: Rgba = (0.42, 0.28, 0.20, 1.0)
"""The way out."""
LEAF: Rgba = (0.88, 0.87, 0.85, 1.0)
"""A door between two rooms."""
CEILING: Rgba = (0.96, 0.96, 0.95, 1.0)
GROUND: Rgba = (0.62, 0.68, 0.58, 1.0)


def floor(material: str) -> Rgba:
    """A floor's colour by the name of its material."""
    return (*finishes.floor(material)[1], 1.0)


def wall(face: Wall) -> Rgba:
    """A wall face's colour: its own when the house gives one, brick outdoors when it names nothing."""
    name = face.material or ("brick" if face.room == "exterior" else "")
    return (*(finishes.wall(name)[1] if face.rgb is None else face.rgb), 1.0)
