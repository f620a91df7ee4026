"""What surfaces are made of: wood, cloth, metal, glass; floors and walls by the names that houses use; no shapes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from hthor.catalog import colours
from hthor.looks import textures
from hthor.looks.mesh import Material, Mesh, Piece
from hthor.types import Rgba, Vec3

_WOODS = (
    "OAK",
    "WALNUT",
    "BIRCH",
    "PINE",
    "ASH",
    "CHERRY",
    "BEECH",
    "TEAK",
    "MAHOGANY",
    "MAPLE",
    "EBONY",
    "WENGE",
    "WOOD",
)
_METALS = ("STEEL", "IRON", "CHROME", "BRASS", "COPPER", "ALUMINIUM", "GOLD", "SILVER")
_STONES = ("STONE", "GRANITE", "MARBLE", "SLATE", "CONCRETE", "QUARTZ")
_OTHERS = {"CARDBOARD": "cardboard", "LINEN": "linen", "WICKER": "wicker", "CORK": "cork", "TERRACOTTA": "concrete"}


def tinted(texture: str, rgba: Rgba, specular: float = 0.1, shininess: float = 0.2) -> Material:
    """``texture`` coloured so that on the whole it looks ``rgba``, as far as it can be that bright."""
    mean = textures.mean(texture)
    r, g, b = (round(min(1.0, channel / max(m, 0.05)), 4) for channel, m in zip(rgba, mean, strict=False))
    return Material(rgba=(r, g, b, rgba[3]), texture=texture, specular=specular, shininess=shininess)


def paint(rgba: Rgba, gloss: float = 0.25) -> Material:
    """A plain coat; ``gloss`` is 0 for chalk, 1 for a mirror's polish."""
    return Material(rgba=rgba, specular=gloss, shininess=0.2 + 0.6 * gloss)


def wood(rgba: Rgba) -> Material:
    """Lacquered wood of that colour."""
    return tinted("wood", rgba, 0.18, 0.35)


def cloth(rgba: Rgba, weave: str = "weave") -> Material:
    """A textile of that colour."""
    return tinted(weave, rgba, 0.02, 0.05)


def leather(rgba: Rgba) -> Material:
    """Leather of that colour."""
    return tinted("leather", rgba, 0.25, 0.35)


def metal(rgba: Rgba) -> Material:
    """Brushed metal of that colour."""
    return tinted("brushed", rgba, 0.6, 0.6)


def chrome(rgba: Rgba = colours.STEEL) -> Material:
    """Polished metal of that colour."""
    return Material(rgba=rgba, specular=0.9, shininess=0.85)


def ceramic(rgba: Rgba) -> Material:
    """Glazed ware of that colour."""
    return Material(rgba=rgba, specular=0.55, shininess=0.75)


def glass(rgba: Rgba = colours.GLASS) -> Material:
    """Clear glass with a tint."""
    return Material(rgba=(*rgba[:3], min(rgba[3], 0.35)), specular=0.9, shininess=0.9)


def stone(rgba: Rgba) -> Material:
    """A polished worktop of that colour."""
    return tinted("granite", rgba, 0.4, 0.6)


def glow(rgba: Rgba, strength: float = 0.75) -> Material:
    """A shade or a bulb with its own light."""
    return Material(rgba=rgba, emission=strength)


def picture(texture: str, emission: float = 0.0) -> Material:
    """A picture in its own colours; a screen has some ``emission``."""
    return Material(texture=texture, specular=0.15 if emission == 0.0 else 0.3, emission=emission)


_NAMES = {value: name for name, value in reversed(list(vars(colours).items())) if name.isupper()}


@lru_cache(maxsize=1024)
def guess(rgba: Rgba) -> Material:
    """The material that a colour of the catalog speaks of: oak is wood, steel is metal; others are paint."""
    name = _NAMES.get(rgba, "")
    if rgba[3] < 0.99:
        return glass(rgba)
    if name in _WOODS or (not name and _brown(rgba)):
        return wood(rgba)
    if name in _METALS:
        return metal(rgba)
    if name in _STONES:
        return stone(rgba)
    return tinted(_OTHERS[name], rgba) if name in _OTHERS else paint(rgba)


def wooden(rgba: Rgba) -> bool:
    """Whether a colour is that of some wood."""
    return guess(rgba).texture == "wood"


def _brown(rgba: Rgba) -> bool:
    r, g, b, _ = rgba
    return r > g > b and 0.10 < r - b < 0.45 and 0.35 < (g - b) / (r - b) < 0.72 and r < 0.9


def piece(shape: Mesh, material: Material, moves: str = "") -> Piece:
    """A mesh of a material: its texture coordinates turn from metres into repeats of the texture."""
    repeat = textures.scale(material.texture)
    return Piece(shape._replace(uv=(shape.uv / np.float32(repeat)) if repeat else shape.uv), material, moves)


# ----------------------------------------------------------------------------------------------------- floors and walls

_FLOORS: tuple[tuple[str, str, Vec3], ...] = (
    ("checker", "checker", (1.0, 1.0, 1.0)),
    ("terrazzo", "terrazzo", (0.86, 0.84, 0.80)),
    ("herringbone", "herringbone", (0.66, 0.48, 0.31)),
    ("parquet", "parquet", (0.66, 0.48, 0.31)),
    ("terracotta", "tile", (0.72, 0.44, 0.31)),
    ("darktile", "tile_large", (0.36, 0.37, 0.39)),
    ("slate", "tile_large", (0.36, 0.37, 0.39)),
    ("tilegrey", "tile", (0.66, 0.67, 0.68)),
    ("tilestan", "tile_small", (0.80, 0.72, 0.60)),
    ("tilebeige", "tile", (0.82, 0.76, 0.66)),
    ("tileblue", "tile_small", (0.60, 0.70, 0.78)),
    ("subway", "subway", (0.90, 0.90, 0.89)),
    ("smallkitchentile", "tile_small", (0.86, 0.85, 0.82)),
    ("mosaic", "tile_small", (0.70, 0.76, 0.78)),
    ("tile", "tile", (0.86, 0.86, 0.85)),
    ("marble", "marble", (0.90, 0.89, 0.88)),
    ("granite", "granite", (0.80, 0.79, 0.78)),
    ("concrete", "concrete", (0.66, 0.66, 0.65)),
    ("carpetgrey", "carpet", (0.62, 0.61, 0.60)),
    ("carpetblue", "carpet", (0.44, 0.52, 0.62)),
    ("carpetgreen", "carpet", (0.50, 0.57, 0.47)),
    ("carpetbeige", "carpet", (0.76, 0.69, 0.59)),
    ("carpet", "carpet", (0.70, 0.65, 0.58)),
    ("rug", "carpet", (0.66, 0.50, 0.44)),
    ("fabric", "carpet", (0.62, 0.58, 0.54)),
    ("wicker", "wicker", (0.78, 0.64, 0.46)),
    ("brick", "brick", (0.70, 0.46, 0.38)),
    ("greyfloor", "planks_wide", (0.58, 0.57, 0.56)),
    ("worn", "planks_worn", (0.56, 0.44, 0.34)),
    ("black", "planks", (0.20, 0.18, 0.17)),
    ("white", "planks_wide", (0.88, 0.85, 0.80)),
    ("cream", "planks", (0.84, 0.75, 0.61)),
    ("ash", "planks_wide", (0.80, 0.72, 0.60)),
    ("birch", "planks", (0.82, 0.70, 0.52)),
    ("pine", "planks_wide", (0.84, 0.66, 0.42)),
    ("walnut", "planks", (0.44, 0.30, 0.20)),
    ("cherry", "planks", (0.58, 0.32, 0.20)),
    ("dark", "planks", (0.40, 0.28, 0.20)),
    ("brown", "planks", (0.50, 0.35, 0.23)),
    ("red", "planks", (0.52, 0.30, 0.20)),
    ("orange", "planks", (0.74, 0.48, 0.26)),
    ("light", "planks_wide", (0.80, 0.65, 0.46)),
    ("tan", "planks", (0.76, 0.60, 0.42)),
    ("oak", "planks", (0.66, 0.51, 0.37)),
    ("", "planks", (0.62, 0.48, 0.34)),
)
"""The first row whose word is in a floor's name, without spaces and in small letters, says what it is."""

_WALLS: tuple[tuple[str, str, Vec3], ...] = (
    ("redbrick", "brick", (0.62, 0.36, 0.29)),
    ("brickwhite", "brick", (0.90, 0.89, 0.86)),
    ("bricktexwhite", "brick", (0.90, 0.89, 0.86)),
    ("brick", "brick", (0.66, 0.42, 0.34)),
    ("checker", "checker", (1.0, 1.0, 1.0)),
    ("darktile", "tile_large", (0.36, 0.37, 0.39)),
    ("tilestan", "tile", (0.80, 0.72, 0.60)),
    ("subway", "subway", (0.92, 0.92, 0.91)),
    ("drywalltile", "plaster", (0.90, 0.82, 0.58)),
    ("smallkitchentile", "tile_small", (0.88, 0.88, 0.86)),
    ("tileblue", "tile_small", (0.62, 0.74, 0.82)),
    ("tilegreen", "tile_small", (0.66, 0.78, 0.70)),
    ("tilegrey", "tile", (0.74, 0.75, 0.76)),
    ("mosaic", "tile_small", (0.74, 0.80, 0.82)),
    ("tile", "tile", (0.90, 0.90, 0.89)),
    ("pinkmarble", "marble", (0.90, 0.78, 0.75)),
    ("brownmarble", "marble", (0.72, 0.60, 0.50)),
    ("marble", "marble", (0.92, 0.91, 0.90)),
    ("granite", "granite", (0.88, 0.87, 0.86)),
    ("pinkconcrete", "concrete", (0.86, 0.72, 0.68)),
    ("concrete", "concrete", (0.74, 0.74, 0.73)),
    ("wallpaper", "wallpaper", (0.84, 0.84, 0.78)),
    ("stripe", "wallpaper", (0.84, 0.84, 0.78)),
    ("panel", "panels", (0.90, 0.89, 0.86)),
    ("wood", "wood", (0.66, 0.50, 0.35)),
    ("orange", "plaster", (0.90, 0.66, 0.46)),
    ("yellow", "plaster", (0.92, 0.84, 0.60)),
    ("warm", "plaster", (0.93, 0.88, 0.79)),
    ("cream", "plaster", (0.94, 0.91, 0.83)),
    ("sage", "plaster", (0.74, 0.79, 0.70)),
    ("green", "plaster", (0.74, 0.81, 0.72)),
    ("blue", "plaster", (0.72, 0.80, 0.87)),
    ("cool", "plaster", (0.86, 0.89, 0.92)),
    ("grey", "plaster", (0.78, 0.78, 0.77)),
    ("gray", "plaster", (0.78, 0.78, 0.77)),
    ("pink", "plaster", (0.91, 0.80, 0.78)),
    ("", "plaster", (0.94, 0.93, 0.90)),
)


def _row(table: tuple[tuple[str, str, Vec3], ...], name: str) -> tuple[str, Vec3]:
    key = "".join(letter for letter in name.lower() if letter.isalpha())
    return next((texture, colour) for word, texture, colour in table if word in key)


@lru_cache(maxsize=256)
def floor(name: str) -> Material:
    """A floor's material by its name; names that speak of no known material count as wooden boards."""
    texture, (r, g, b) = _row(_FLOORS, name)
    shine = 0.04 if texture in ("carpet", "wicker") else 0.3
    return tinted(texture, (r, g, b, 1.0), shine, 1.5 * shine)


@lru_cache(maxsize=256)
def wall(name: str, rgb: Vec3 | None = None) -> Material:
    """A wall's or a ceiling's material by its name, in its own colour where the house gives one."""
    texture, (r, g, b) = _row(_WALLS, name)
    own = (r, g, b) if rgb is None else rgb
    shine = 0.3 if texture.startswith(("tile", "subway", "marble", "checker")) else 0.03
    return tinted(texture, (*own, 1.0), shine, 1.5 * shine)
