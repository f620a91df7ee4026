"""Builders of the meshes of bodies in pictures for people, in the body frame: rounder than `primitives`.

``moves`` is "head" for a mesh that turns with the camera, else empty.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Rgba, Vec2, Vec3

CODE_PART = "pictures"

Row = tuple[float, float, float, float, float]
"""One cross-section of a limb: centre x, y and height z, half width ahead and half width sideways [m]."""
_SIDES = 28


def matte(rgba: Rgba) -> Material:
    """The material of cloth, rubber and skin."""
    return Material(rgba=rgba, specular=0.06, shininess=0.1)


def gloss(rgba: Rgba) -> Material:
    """The material of painted or moulded shells."""
    return Material(rgba=rgba, specular=0.35, shininess=0.5)


def metal(rgba: Rgba) -> Material:
    """The material of metal rods and pins."""
    return Material(rgba=rgba, specular=0.7, shininess=0.7)


def glow(rgba: Rgba) -> Material:
    """The material of lamps and screens."""
    return Material(rgba=rgba, specular=0.2, shininess=0.5, emission=0.6)


def box(centre: Vec3, half: Vec3, material: Material, radius: float = 0.008, moves: str = "") -> Piece:
    """A box with edges of ``radius`` [m]."""
    lo, hi = np.array(centre) - half, np.array(centre) + half
    return Piece(solids.box(tuple(lo), tuple(hi), radius, steps=3), material, moves)


def ball(centre: Vec3, half: Vec3 | float, material: Material, moves: str = "") -> Piece:
    """A ball, or an ellipsoid with half extents ``half`` [m]."""
    extents = (half, half, half) if isinstance(half, float) else half
    return Piece(solids.ball(centre, extents, _SIDES), material, moves)


def rod(centre: Vec3, radius: float, length: float, axis: str, material: Material, moves: str = "") -> Piece:
    """A cylinder along the x, y or z axis, with bevelled rims."""
    return Piece(solids.cylinder(centre, radius, length, axis, _SIDES), material, moves)


def turned(profile: Sequence[Vec2], material: Material, at: Vec3 = (0.0, 0.0, 0.0), moves: str = "") -> Piece:
    """A solid of revolution about a vertical axis, from (radius, height) pairs [m] from the bottom up."""
    return Piece(shaping.moved(solids.lathe(profile, 40), *at), material, moves)


def tire(centre: Vec3, radius: float, half_width: float, material: Material) -> Piece:
    """A wheel with a round tread whose axis points left."""
    w, shoulder = half_width, 0.3 * min(radius, half_width)
    edge = [(radius - shoulder * (1 - math.cos(a)), w - shoulder * (1 - math.sin(a))) for a in (0.0, 0.5, 1.0, 1.57)]
    profile = [(0.0, -w), *((r, -z) for r, z in reversed(edge)), *edge, (0.0, w)]
    return Piece(shaping.moved(solids.along(solids.lathe(profile, 32), "y"), *centre), material)


def tube(path: Any, radius: float | Sequence[float], material: Material, moves: str = "") -> Piece:
    """A round bar along points (N, 3) [m], with a half ball at either end."""
    line = np.array(path, float)
    radii = np.broadcast_to(np.asarray(radius, float), (len(line),))
    bar = sweeps.tube(line, list(radii), 14)
    ends = [solids.ball(tuple(line[k]), (float(radii[k]),) * 3, 14) for k in (0, -1)]
    return Piece(shaping.merged(bar, *ends), material, moves)


def limb(rows: Sequence[Row], material: Material, moves: str = "", fullness: float = 2.0) -> Piece:
    """A surface through cross-sections from the bottom up, closed at both ends; a ``fullness`` above 2 squares them."""
    return Piece(_loft(np.array(rows, float), fullness), material, moves)


def _loft(rows: Any, fullness: float) -> Mesh:
    rows = _smooth(rows)
    ends = rows[[0, -1]].copy()
    ends[:, 3:] = 0.0
    rows = np.concatenate([ends[:1], rows, ends[1:]])
    angle = np.linspace(0.0, 2.0 * math.pi, _SIDES + 1)[:, None]
    cos, sin = np.cos(angle), np.sin(angle)
    x = rows[:, 0] + rows[:, 3] * np.sign(cos) * np.abs(cos) ** (2.0 / fullness)
    y = rows[:, 1] + rows[:, 4] * np.sign(sin) * np.abs(sin) ** (2.0 / fullness)
    z = np.broadcast_to(rows[:, 2], x.shape)
    return shaping.surface(np.stack([x, y, z], -1), np.stack(np.broadcast_arrays(angle * 0.1, rows[:, 2]), -1))


def _smooth(rows: Any, steps: int = 5) -> Any:
    """The given cross-sections with more in between, on a smooth line through them."""
    padded = np.concatenate([2 * rows[:1] - rows[1:2], rows, 2 * rows[-1:] - rows[-2:-1]])
    t = np.linspace(0.0, 1.0, steps, endpoint=False)[:, None]
    parts = []
    for k in range(len(rows) - 1):
        a, b, c, d = padded[k : k + 4]
        parts.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3))
    smooth = np.concatenate([*parts, rows[-1:]])
    smooth[:, 3:] = np.maximum(smooth[:, 3:], 1e-4)
    return smooth
