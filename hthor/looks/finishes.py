"""Textures and colors for the names that houses give to floors and walls."""

from functools import lru_cache

from hthor.types import Vec3

Finish = tuple[str, Vec3]
"""Name of a texture, and the color that it should have on average."""

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
    ("tilecream", "tile", (0.84, 0.80, 0.72)),
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
    ("carpetsage", "carpet", (0.56, 0.61, 0.52)),
    ("carpetbeige", "carpet", (0.76, 0.69, 0.59)),
    ("carpet", "carpet", (0.70, 0.65, 0.58)),
    ("rug", "carpet", (0.66, 0.50, 0.44)),
    ("fabric", "carpet", (0.62, 0.58, 0.54)),
    ("wicker", "wicker", (0.78, 0.64, 0.46)),
    ("brick", "brick", (0.70, 0.46, 0.38)),
    ("woodgrey", "planks", (0.56, 0.53, 0.50)),
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
"""Word, texture and color. The first row whose word is in a floor's name (lower-case letters only) decides."""

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


@lru_cache(maxsize=256)
def floor(name: str) -> Finish:
    """A floor's finish by its name; if the name contains no known material, it is wooden boards."""
    return _row(_FLOORS, name)


@lru_cache(maxsize=256)
def wall(name: str) -> Finish:
    """A wall's or a ceiling's finish by its name; if the name contains no known material, it is light plaster."""
    return _row(_WALLS, name)


def _row(table: tuple[tuple[str, str, Vec3], ...], name: str) -> Finish:
    key = "".join(letter for letter in name.lower() if letter.isalpha())
    return next((texture, color) for word, texture, color in table if word in key)
