"""House plants: a pot of soil, stems and arching leaves."""

import math

import numpy as np

from hthor import seeds
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece

_ROOT = 20
_STEM = (0.30, 0.36, 0.18, 1.0)


def leaf(length: float, width: float, rise: float, sag: float, rows: int = 6) -> Mesh:
    """A leaf that grows from the origin along x, rises and then hangs, folded a little along its rib."""
    t, s = np.linspace(0.0, 1.0, rows), np.linspace(-1.0, 1.0, 3)
    half = width * np.sin(np.pi * np.clip(0.06 + 0.94 * t, 0.0, 1.0) ** 0.75)
    x = np.broadcast_to(length * t[:, None], (rows, 3))
    y = half[:, None] * s[None, :]
    z = (rise * t - sag * t**2.2)[:, None] + 0.22 * np.abs(y)
    uv = np.stack([np.broadcast_to((s[None, :] + 1) / 2, (rows, 3)), np.broadcast_to(t[:, None], (rows, 3))], -1)
    return sweeps.sheet(np.stack([x, y, z], -1), uv, 0.002)


def house_plant(draft: Draft) -> list[Piece]:
    """A plant in a tapered pot; its variant decides the sort: broad leaves, sword-shaped leaves, or a palm."""
    w, d, h = draft.size
    r = min(w, d) / 2
    pot_r, pot_h = 0.46 * r, min(0.30 * h, 0.9 * r)
    outer = [(0.0, 0.0), (0.70 * pot_r, 0.0), (0.74 * pot_r, 0.06 * pot_h), (0.94 * pot_r, 0.85 * pot_h)]
    lip = [(pot_r, 0.86 * pot_h), (pot_r, pot_h), (0.92 * pot_r, pot_h), (0.90 * pot_r, 0.88 * pot_h)]
    soil = [(0.91 * pot_r, 0.90 * pot_h), (0.0, 0.92 * pot_h)]
    blades, stems = (_broad, _swords, _palm)[draft.variant % 3](r, pot_h, h)
    green = Material(texture="leaf", specular=0.25, shininess=0.3)
    return [
        materials.piece(solids.lathe([*outer, *lip], 28), materials.guess(draft.color(0))),
        materials.piece(solids.lathe(soil, 20), Material(texture="soil", specular=0.0)),
        *(materials.piece(shape, materials.paint(_STEM, 0.05)) for shape in stems),
        *(materials.piece(shape, green) for shape in blades),
    ]


def _broad(r: float, low: float, high: float) -> tuple[list[Mesh], list[Mesh]]:
    """Broad leaves in a spiral around three stems, smaller towards the top."""
    blades, stems = [], []
    for k in range(24):
        ring, turn = k / 23.0, 2.4 * k
        z = low + (high - low) * (0.06 + 0.68 * ring)
        reach = r * (0.95 - 0.50 * ring) * (0.85 + 0.3 * seeds.draw(_ROOT, "reach", k))
        shape = leaf(reach, 0.26 * reach + 0.010 * high, (0.55 + 0.5 * ring) * reach, (0.75 - 0.45 * ring) * reach)
        blades.append(_planted(shape, turn, 0.05 * r, z))
    for k in range(3):
        x, y = 0.06 * r * math.cos(2.1 * k), 0.06 * r * math.sin(2.1 * k)
        top = (x, y, low + (0.74 - 0.1 * k) * (high - low))
        stems.append(sweeps.tube([(0.25 * x, 0.25 * y, 0.88 * low), top], [0.012, 0.005], 7))
    return blades, stems


def _swords(r: float, low: float, high: float) -> tuple[list[Mesh], list[Mesh]]:
    """Stiff, upright, sword-shaped leaves that stand close together."""
    blades = []
    for k in range(15):
        tall = (high - low) * (1.0 - 0.45 * (k / 14.0)) * (0.9 + 0.2 * seeds.draw(_ROOT, "tall", k))
        shape = leaf(tall, 0.030 * high + 0.06 * r, 0.10 * r, -0.25 * r * (k / 14.0), 8)
        upright = shaping.turned(shape, "y", -math.pi / 2 + 0.10 + 0.28 * (k / 14.0))
        blades.append(_planted(upright, 2.4 * k, 0.24 * r * (k / 14.0), 0.9 * low))
    return blades, []


def _palm(r: float, low: float, high: float) -> tuple[list[Mesh], list[Mesh]]:
    """Long arching fronds from a short trunk."""
    crown = low + 0.36 * (high - low)
    blades = []
    for k in range(20):
        ring = k / 19.0
        rise = (high - crown) * (0.35 + 1.0 * ring)
        reach = r * (1.0 - 0.45 * ring)
        shape = leaf(reach, 0.09 * r + 0.02 * reach, rise, rise * (1.0 - 0.45 * ring), 8)
        blades.append(_planted(shape, 2.4 * k, 0.02 * r, crown + 0.04 * ring))
    trunk = sweeps.tube(
        [(0.0, 0.0, 0.88 * low), (0.02 * r, 0.0, 0.5 * (low + crown)), (0.0, 0.0, crown + 0.03)], 0.022, 8
    )
    return blades, [trunk]


def _planted(shape: Mesh, turn: float, out: float, z: float) -> Mesh:
    return shaping.moved(shaping.turned(shape, "z", turn), out * math.cos(turn), out * math.sin(turn), z)
