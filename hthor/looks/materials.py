"""Materials of surfaces: wood, cloth, metal, glass; floors and walls by the names that houses use. No shapes."""

from functools import lru_cache

import numpy as np

from hthor.catalog import colors
from hthor.looks import finishes, textures
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Rgba, Vec3

_WOODS, _METALS, _STONES = ("OAK", "WALNUT", "BIRCH"), ("STEEL", "IRON"), ("STONE",)
_OTHERS = {"CARDBOARD": "cardboard", "LINEN": "linen", "TERRACOTTA": "concrete"}


def tinted(texture: str, rgba: Rgba, specular: float = 0.1, shininess: float = 0.2) -> Material:
    """``texture`` colored so that its average color is ``rgba``, as far as the texture can be that bright."""
    mean = textures.mean(texture)
    r, g, b = (round(min(1.0, channel / max(m, 0.05)), 4) for channel, m in zip(rgba, mean, strict=False))
    return Material(rgba=(r, g, b, rgba[3]), texture=texture, specular=specular, shininess=shininess)


def paint(rgba: Rgba, gloss: float = 0.25) -> Material:
    """A plain coat of paint; ``gloss`` is from 0 for chalk to 1 for a mirror."""
    return Material(rgba=rgba, specular=gloss, shininess=0.2 + 0.6 * gloss)


def wood(rgba: Rgba) -> Material:
    """Lacquered wood of this color."""
    return tinted("wood", rgba, 0.18, 0.35)


def cloth(rgba: Rgba, weave: str = "weave") -> Material:
    """A textile of this color."""
    return tinted(weave, rgba, 0.02, 0.05)


def leather(rgba: Rgba) -> Material:
    """Leather of this color."""
    return tinted("leather", rgba, 0.25, 0.35)


def metal(rgba: Rgba) -> Material:
    """Brushed metal of this color."""
    return tinted("brushed", rgba, 0.6, 0.6)


def chrome(rgba: Rgba = colors.STEEL) -> Material:
    """Polished metal of this color."""
    return Material(rgba=rgba, specular=0.9, shininess=0.85)


def ceramic(rgba: Rgba) -> Material:
    """Glazed ceramic of this color."""
    return Material(rgba=rgba, specular=0.55, shininess=0.75)


def glass(rgba: Rgba = colors.GLASS) -> Material:
    """Clear glass with a tint."""
    return Material(rgba=(*rgba[:3], min(rgba[3], 0.35)), specular=0.9, shininess=0.9)


def stone(rgba: Rgba) -> Material:
    """A polished stone worktop of this color."""
    return tinted("granite", rgba, 0.4, 0.6)


def glow(rgba: Rgba, strength: float = 0.75) -> Material:
    """A lamp shade or a bulb that gives light."""
    return Material(rgba=rgba, emission=strength)


def picture(texture: str, emission: float = 0.0) -> Material:
    """A picture in its own colors; a screen has some ``emission``."""
    return Material(texture=texture, specular=0.15 if emission == 0.0 else 0.3, emission=emission)


_NAMES = {value: name for name, value in reversed(list(vars(colors).items())) if name.isupper()}


@lru_cache(maxsize=1024)
def guess(rgba: Rgba) -> Material:
    """The material that a catalogue color suggests: oak is wood, steel is metal; other colors are paint."""
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
    """Whether a color is that of a wood."""
    return guess(rgba).texture == "wood"


def _brown(rgba: Rgba) -> bool:
    r, g, b, _ = rgba
    return r > g > b and 0.10 < r - b < 0.45 and 0.35 < (g - b) / (r - b) < 0.72 and r < 0.9


def piece(shape: Mesh, material: Material, moves: str = "") -> Piece:
    """A mesh with a material; its texture coordinates are converted from metres into repeats of the texture."""
    repeat = textures.scale(material.texture)
    return Piece(shape._replace(uv=(shape.uv / np.float32(repeat)) if repeat else shape.uv), material, moves)


# ----------------------------------------------------------------------------------------------------- floors and walls


@lru_cache(maxsize=256)
def floor(name: str) -> Material:
    """A floor's material by its name; if the name contains no known material, it is wooden boards."""
    texture, (r, g, b) = finishes.floor(name)
    shine = 0.04 if texture in ("carpet", "wicker") else 0.3
    return tinted(texture, (r, g, b, 1.0), shine, 1.5 * shine)


@lru_cache(maxsize=256)
def wall(name: str, rgb: Vec3 | None = None) -> Material:
    """A wall's or a ceiling's material by its name, in the house's own color if it gives one."""
    texture, (r, g, b) = finishes.wall(name)
    own = (r, g, b) if rgb is None else rgb
    shine = 0.3 if texture.startswith(("tile", "subway", "marble", "checker")) else 0.03
    return tinted(texture, (*own, 1.0), shine, 1.5 * shine)
