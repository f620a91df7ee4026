"""Colours of floors and walls from the names of their materials; knows nothing of geometry."""

from __future__ import annotations

import zlib

from hthor.types import Rgba, Vec3, Wall

_WOODS: tuple[Rgba, ...] = (
    (0.72, 0.56, 0.40, 1.0),
    (0.64, 0.49, 0.36, 1.0),
    (0.78, 0.65, 0.50, 1.0),
    (0.55, 0.42, 0.32, 1.0),
)
_TILES: tuple[Rgba, ...] = ((0.80, 0.81, 0.80, 1.0), (0.72, 0.76, 0.78, 1.0), (0.84, 0.81, 0.75, 1.0))
_CARPETS: tuple[Rgba, ...] = ((0.66, 0.63, 0.60, 1.0), (0.58, 0.62, 0.66, 1.0), (0.70, 0.64, 0.58, 1.0))
_WALLS: tuple[Rgba, ...] = (
    (0.93, 0.91, 0.87, 1.0),
    (0.87, 0.90, 0.91, 1.0),
    (0.90, 0.88, 0.82, 1.0),
    (0.85, 0.89, 0.85, 1.0),
    (0.92, 0.87, 0.84, 1.0),
)
_BRICK: Rgba = (0.66, 0.45, 0.38, 1.0)

PANE: Rgba = (0.70, 0.84, 0.92, 0.25)
DOOR: Rgba = (0.60, 0.46, 0.34, 1.0)
CEILING: Rgba = (0.96, 0.96, 0.95, 1.0)
GROUND: Rgba = (0.62, 0.68, 0.58, 1.0)


def _pick(palette: tuple[Rgba, ...], name: str) -> Rgba:
    return palette[zlib.crc32(name.encode()) % len(palette)]


def floor(material: str) -> Rgba:
    """A floor's colour; names that speak of no known material count as wood."""
    name = material.lower()
    if any(word in name for word in ("tile", "marble", "concrete", "stone", "mosaic", "brick")):
        return _pick(_TILES, material)
    if any(word in name for word in ("carpet", "rug", "fabric")):
        return _pick(_CARPETS, material)
    return _pick(_WOODS, material)


def wall(face: Wall) -> Rgba:
    """A wall face's colour: its own when the house gives one, brick outdoors, else a light plaster."""
    if face.rgb is not None:
        return _opaque(face.rgb)
    if face.room == "exterior" or "brick" in face.material.lower():
        return _BRICK
    return _pick(_WALLS, face.material)


def _opaque(rgb: Vec3) -> Rgba:
    return (rgb[0], rgb[1], rgb[2], 1.0)
