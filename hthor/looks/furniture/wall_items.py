"""Paintings, mirrors, clocks, curtains and switches, which hang on walls; rugs."""

import zlib

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece

_ART = ("landscape_1", "landscape_2", "abstract_1", "landscape_3", "still_life", "landscape_4", "abstract_2")
_RUGS = ("rug_red", "rug_blue", "rug_green")
_NARROW_M = 0.6
"""A curtain narrower than this hangs at one side of a window and is a single panel."""


def _of(draft: Draft, choices: tuple[str, ...]) -> str:
    """A choice that depends on the size and variant of a thing, so that the same thing always looks the same."""
    return choices[(zlib.crc32(repr(draft.size).encode()) + draft.variant) % len(choices)]


def _frame(w: float, d: float, h: float, broad: float) -> list[Mesh]:
    """Four strips of a frame around an upright rectangle, their backs at -d/2, z from 0 to ``h``."""
    x, y, r = w / 2, d / 2, min(0.006, 0.2 * d)
    return [
        solids.box((-x, -y, 0.0), (broad - x, y, h), r),
        solids.box((x - broad, -y, 0.0), (x, y, h), r),
        solids.box((broad - x - r, -y, 0.0), (x - broad + r, y, broad), r),
        solids.box((broad - x - r, -y, h - broad), (x - broad + r, y, h), r),
    ]


def painting(draft: Draft) -> list[Piece]:
    """A framed picture with a mat around it; the picture depends on the thing's size and variant."""
    w, d, h = draft.size
    broad, mat = min(0.045, 0.09 * min(w, h)), min(0.05, 0.09 * min(w, h))
    y = 0.1 * d
    card = solids.box((broad - w / 2, -d / 2, broad), (w / 2 - broad, y, h - broad), 0.0, 0)
    show = sweeps.panel((0.0, y + 0.0008, h / 2), w - 2 * (broad + mat), h - 2 * (broad + mat))
    return [
        *(materials.piece(shape, materials.guess(draft.color(0))) for shape in _frame(w, d, h, broad)),
        materials.piece(card, materials.paint(c.PAPER, 0.02)),
        materials.piece(show, materials.picture(_of(draft, _ART))),
    ]


def mirror(draft: Draft) -> list[Piece]:
    """A bright pane in a slim frame."""
    w, d, h = draft.size
    broad = min(0.035, 0.07 * min(w, h))
    pane = solids.box((broad - w / 2, -d / 2, broad), (w / 2 - broad, 0.1 * d, h - broad), 0.0, 0)
    show = sweeps.panel((0.0, 0.1 * d + 0.0008, h / 2), w - 2 * broad, h - 2 * broad)
    glass = Material(rgba=(0.92, 0.96, 1.0, 1.0), texture="glaze", specular=1.0, shininess=0.95, emission=0.12)
    return [
        *(materials.piece(shape, materials.guess(draft.color(0))) for shape in _frame(w, d, h, broad)),
        materials.piece(pane, materials.paint(c.GREY, 0.2)),
        materials.piece(show, glass),
    ]


def clock(draft: Draft) -> list[Piece]:
    """A round dial in a rim."""
    w, d, h = draft.size
    r = min(w, h) / 2
    rim = [(0.0, -0.5), (1.0, -0.5), (1.0, 0.30), (0.97, 0.5), (0.90, 0.5), (0.87, 0.2), (0.0, 0.2)]
    angle = np.linspace(0.0, 2 * np.pi, 33)
    disc = np.stack([np.stack([np.zeros(33)] * 2, -1), np.stack([np.cos(angle), np.sin(angle)], -1)], 1)
    points = np.stack([disc[..., 0] * 0.88 * r, np.full(disc.shape[:2], 0.2 * d + 0.0008), disc[..., 1] * 0.88 * r], -1)
    uv = np.stack([0.5 - 0.5 * disc[..., 0], 0.5 - 0.5 * disc[..., 1]], -1)
    face = shaping.surface(points, uv)
    return [
        materials.piece(solids.along(solids.lathe(rim, 32, (r, d)), "y"), materials.paint(draft.color(0), 0.5)),
        materials.piece(face, materials.picture("dial")),
    ]


def curtain(draft: Draft) -> list[Piece]:
    """Two pleated panels, drawn a little aside (one panel if narrow), on a rod with knobs."""
    w, d, h = draft.size
    coat, iron = Material(rgba=draft.color(0), specular=0.0, shininess=0.0), materials.metal(c.IRON)
    found = [materials.piece(sweeps.tube([(-0.49 * w, 0.0, h - 0.03), (0.49 * w, 0.0, h - 0.03)], 0.010, 10), iron)]
    found += [
        materials.piece(solids.ball((s * (w / 2 - 0.02), 0.0, h - 0.03), (0.02, 0.02, 0.02), 12), iron)
        for s in (-1.0, 1.0)
    ]
    pair = w > _NARROW_M
    for s in (-1.0, 1.0) if pair else (-1.0,):
        u, v = np.meshgrid(np.linspace(0.0, 1.0, 37), np.linspace(0.0, 1.0, 5), indexing="ij")
        breadth = ((0.31 if pair else 0.95) - 0.03 * np.sin(np.pi * v)) * w
        x = s * (0.475 * w - breadth * u)
        y = (0.20 + (0.14 + 0.10 * v) * np.sin(2 * np.pi * 6.0 * u + 0.5 * v)) * d  # keeps clear of a window's trim
        z = (h - 0.012) * (1.0 - v)
        points, uv = np.stack([x, y, z], -1), np.stack([u * w * 0.6, z], -1)
        if s < 0:
            points, uv = points[::-1], uv[::-1]
        found.append(materials.piece(sweeps.sheet(points.copy(), uv.copy(), 0.003), coat))
    return found


def rug(draft: Draft) -> list[Piece]:
    """A patterned rug with fringes; linen and grey ones are woven in bands."""
    w, d, h = draft.size
    long, fringe = w >= d, min(0.05, 0.05 * max(w, d))
    a, b = (w, d) if long else (d, w)
    body = solids.box((fringe - a / 2, -b / 2, 0.0), (a / 2 - fringe, b / 2, h), 0.4 * h)
    show = sweeps.lying((0.0, 0.0, h + 0.0006), a - 2 * fringe - h, b - h)
    tufts = []
    for k in range(max(6, round(b / 0.05))):
        y = -b / 2 + b * (k + 0.5) / max(6, round(b / 0.05))
        tufts += [
            solids.box((west, y - 0.012, 0.0), (east, y + 0.012, 0.5 * h), 0.0, 0)
            for west, east in ((-a / 2, fringe - a / 2), (a / 2 - fringe, a / 2))
        ]
    tint = draft.color(0)
    named = {c.RUST: "rug_red", c.TERRACOTTA: "rug_red", c.RED: "rug_red", c.BLUE: "rug_blue", c.SKY: "rug_blue",
        c.TEAL: "rug_blue", c.SAGE: "rug_green", c.LEAF: "rug_green", c.LINEN: "rug_bands", c.GREY: "rug_bands",
        c.CREAM: "rug_bands"}  # fmt: skip
    name = named.get(tint) or _of(draft, _RUGS)
    pieces = [
        materials.piece(body, materials.cloth(tint, "felt")),
        materials.piece(show, Material(texture=name, specular=0.0, shininess=0.0)),
        *(materials.piece(shape, materials.cloth(c.CREAM, "felt")) for shape in tufts),
    ]
    if not long:
        pieces = [p._replace(mesh=shaping.turned(p.mesh, "z", np.pi / 2)) for p in pieces]
    return pieces


def light_switch(draft: Draft) -> list[Piece]:
    """A plate with a rocker."""
    w, d, h = draft.size
    white = materials.paint(draft.color(0), 0.4)
    plate = solids.box((-w / 2, -d / 2, 0.0), (w / 2, 0.1 * d, h), 0.003)
    rocker = shaping.turned(
        solids.box((-0.24 * w, -0.3 * d, -0.26 * h), (0.24 * w, 0.3 * d, 0.26 * h), 0.002), "x", 0.06
    )
    return [materials.piece(plate, white), materials.piece(shaping.moved(rocker, 0.0, 0.16 * d, 0.5 * h), white)]
