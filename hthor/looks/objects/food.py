"""Food that is easy to recognize: apple, tomato, lettuce, bread, egg, potato."""

import math
from typing import Any

import numpy as np

from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Rgba

_STEM: Rgba = (0.36, 0.26, 0.15, 1.0)
_CALYX: Rgba = (0.26, 0.46, 0.16, 1.0)


def _skin(texture: str, specular: float) -> Material:
    return Material(texture=texture, specular=specular, shininess=specular)


def _upright(shape: Mesh) -> Mesh:
    """Flip the texture of a shape, so that its first row is at the top."""
    return shape._replace(uv=np.stack([shape.uv[:, 0], 1.0 - shape.uv[:, 1]], -1))


def apple(_: Draft) -> list[Piece]:
    """Broad shoulders around a dimple with a stem and a leaf, narrower below, five faint ribs."""

    def radius(lon: Any, lat: Any) -> Any:
        up = np.sin(lat)
        body = 1.0 + 0.10 * up - 0.06 * up**2 + 0.02 * np.cos(5 * lon) * np.maximum(-up, 0.0) ** 2
        return (
            body - 0.42 * np.exp(-(((np.pi / 2 - lat) / 0.38) ** 2)) - 0.20 * np.exp(-(((np.pi / 2 + lat) / 0.30) ** 2))
        )

    body = _upright(solids.blob(radius, 28, 20))
    stem = sweeps.tube(
        sweeps.bend((0.0, 0.0, 0.55), (0.02, 0.0, 0.80), (0.12, 0.02, 1.0), steps=3), [0.035] * 6 + [0.055], 7
    )
    blade = _blade(0.55, 0.20, 0.10)
    leaf = shaping.moved(shaping.turned(shaping.turned(blade, "y", -0.12), "z", 0.7), 0.03, 0.0, 0.86)
    return [
        materials.piece(body, _skin("apple", 0.5)),
        materials.piece(stem, materials.paint(_STEM, 0.0)),
        materials.piece(leaf, Material(texture="leaf", specular=0.2)),
    ]


def _blade(length: float, width: float, sag: float) -> Mesh:
    """A leaf that grows from the origin along x, visible from both sides; the rib of its texture is along it."""
    t, s = np.linspace(0.0, 1.0, 6), np.linspace(-1.0, 1.0, 5)
    half = width * np.sin(np.pi * t**0.8) ** 0.8
    x = np.broadcast_to(length * t[:, None], (6, 5))
    y = half[:, None] * s[None, :]
    z = -sag * t[:, None] ** 2 + 0.25 * np.abs(y) ** 1.2
    uv = np.stack([np.broadcast_to((s[None, :] + 1) / 2, (6, 5)), np.broadcast_to(t[:, None], (6, 5))], -1)
    return sweeps.sheet(np.stack([x, y, z], -1), uv, 0.004 * length)


def tomato(_: Draft) -> list[Piece]:
    """A flattened ball with soft lobes, and a star of sepals around a stub."""

    def radius(lon: Any, lat: Any) -> Any:
        lobes = 0.028 * np.cos(6 * lon) * np.cos(lat) * (0.4 + 0.6 * np.maximum(np.sin(lat), 0.0))
        return 1.0 + lobes - 0.26 * np.exp(-(((np.pi / 2 - lat) / 0.40) ** 2)) - 0.05 * np.sin(lat) ** 2

    body = _upright(shaping.stretched(solids.blob(radius, 36, 18), 1.0, 1.0, 0.88))
    calyx = [sweeps.tube([(0.0, 0.0, 0.55), (0.01, 0.0, 0.86)], 0.05, 6)]
    for k in range(6):
        leaf = shaping.stretched(_blade(0.62, 0.13, 0.16), 1.0, 1.0, 1.0)
        calyx.append(
            shaping.moved(shaping.turned(leaf, "z", k * math.pi / 3 + 0.2 * math.sin(2.0 * k)), 0.0, 0.0, 0.71)
        )
    return [
        materials.piece(body, _skin("tomato", 0.7)),
        *(materials.piece(shape, materials.paint(_CALYX, 0.05)) for shape in calyx),
    ]


def lettuce(_: Draft) -> list[Piece]:
    """A lumpy heart in three rings of ruffled leaves around it."""

    def radius(lon: Any, lat: Any) -> Any:
        return 0.74 + 0.05 * np.sin(3 * lon + 2 * lat) + 0.04 * np.sin(5 * lon - 3 * lat)

    heart = shaping.moved(shaping.stretched(solids.blob(radius, 20, 12), 1.0, 1.0, 0.98), z=0.02)
    leaves = []
    for ring, (reach, flare, height, count) in enumerate(
        ((0.75, -0.02, 1.45, 3), (0.81, 0.03, 1.05, 4), (0.86, 0.12, 0.62, 5))
    ):
        for k in range(count):
            way = 2 * math.pi * (k + 0.37 * ring) / count
            leaves.append(shaping.turned(_wrap(reach, flare, height, 5 * ring + k), "z", way))
    coat = Material(texture="lettuce", specular=0.12, shininess=0.2)
    pale = Material(rgba=(1.0, 1.0, 0.88, 1.0), texture="lettuce", specular=0.12, shininess=0.2)
    return [materials.piece(heart, pale), *(materials.piece(leaf, coat) for leaf in leaves)]


def _wrap(reach: float, flare: float, height: float, seed: int) -> Mesh:
    """A ruffled leaf that starts below the heart and curls around it up to the latitude ``height`` [rad]."""
    rows, columns = np.array([0.0, 0.35, 0.65, 0.87, 1.0]), np.linspace(-1.0, 1.0, 17)
    tt, ss = np.meshgrid(rows, columns, indexing="ij")
    rim = np.maximum(tt**5, 0.7 * np.abs(ss) ** 6)
    lat = -1.40 + (1.40 + height) * tt * (1.0 - 0.22 * ss**2) + 0.10 * rim * np.sin(13 * ss + 2.0 * seed)
    lon = 1.05 * ss * np.sin(np.pi * np.clip(0.10 + 0.58 * tt, 0.0, 1.0)) ** 0.5
    ruffle = rim * (0.055 * np.sin(9 * ss + 2.1 * seed) + 0.03 * np.sin(21 * ss + seed))
    far = reach + flare * tt**3 + 0.05 * np.sin(np.pi * tt) * (1.0 - ss**2) + ruffle
    points = np.stack([far * np.cos(lat) * np.cos(lon), far * np.cos(lat) * np.sin(lon), far * np.sin(lat)], -1)
    uv = np.stack([0.5 + 0.42 * ss, 1.0 - tt], -1)
    return sweeps.sheet(points.swapaxes(0, 1), uv.swapaxes(0, 1), 0.02)


def bread(draft: Draft) -> list[Piece]:
    """A long loaf, flat at the bottom, with cuts across its top."""
    w, d, h = draft.size
    t, a = np.linspace(-1.0, 1.0, 23), np.linspace(0.0, 2 * math.pi, 17)
    tt, aa = np.meshgrid(t, a, indexing="ij")
    girth = np.maximum(1.0 - np.abs(tt) ** 3.2, 0.0) ** 0.5
    slash = 0.07 * np.maximum(np.cos(5.0 * np.pi * tt * 0.8 + 0.8 * np.cos(aa)), 0.0) ** 6 * np.maximum(np.sin(aa), 0.0)
    x, z = np.cos(aa) * girth, np.sin(aa) * girth * (1.0 - slash / 0.6)
    z = np.where(z < 0.0, np.maximum(z, -0.55), z)
    points = np.stack([x * w / 2, tt * d / 2, z * h], -1)
    points[:, -1] = points[:, 0]
    uv = np.stack([aa / 6.3 * 0.28, tt * d / 2], -1)
    shape = shaping.surface(points.swapaxes(0, 1)[::-1], uv.swapaxes(0, 1)[::-1])
    return [materials.piece(shape, _skin("bread", 0.08))]


def egg(_: Draft) -> list[Piece]:
    """An egg that stands on its broad end."""
    angle = np.linspace(0.0, math.pi, 15)
    profile = [(math.sin(a) * (1.0 + 0.16 * math.cos(a)), -math.cos(a)) for a in angle]
    profile[0], profile[-1] = (0.0, -1.0), (0.0, 1.0)
    return [materials.piece(solids.lathe(profile, 20, whole=True), _skin("egg", 0.2))]


def potato(_: Draft) -> list[Piece]:
    """An uneven tuber."""

    def radius(lon: Any, lat: Any) -> Any:
        return (
            1.0 + 0.09 * np.sin(2 * lon + 1) * np.cos(lat) + 0.06 * np.sin(3 * lat + lon) + 0.04 * np.sin(5 * lon - lat)
        )

    return [materials.piece(solids.blob(radius, 20, 14), _skin("potato", 0.05))]
