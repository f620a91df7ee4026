"""Small household things: clocks, bins, baskets, boots, keys, pens."""

import math

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Piece
from hthor.looks.objects.tableware import hollow


def alarm_clock(draft: Draft) -> list[Piece]:
    """Twin bells over a round dial on two feet."""
    _, d, h = draft.size
    r, z = 0.40 * h, 0.46 * h
    coat, steel = materials.paint(draft.color(0), 0.5), materials.chrome()
    drum = solids.cylinder((0.0, 0.0, z), r, 0.86 * d, "y", 24)
    face = sweeps.panel((0.0, 0.44 * d, z), 1.30 * r, 1.30 * r)
    plate = solids.cylinder((0.0, 0.0, z), 0.9 * r, 0.875 * d, "y", 24)
    found = [
        materials.piece(drum, coat),
        materials.piece(plate, materials.paint((0.96, 0.95, 0.91, 1.0), 0.1)),
        materials.piece(face, materials.picture("dial")),
    ]
    for s in (-1.0, 1.0):
        bell = shaping.turned(
            solids.lathe([(0.40 * r, 0.0), (0.38 * r, 0.12 * r), (0.2 * r, 0.26 * r), (0.0, 0.3 * r)], 14),
            "y",
            s * 0.55,
        )
        found.append(materials.piece(shaping.moved(bell, s * 0.62 * r, 0.0, z + 0.92 * r), steel))
        found.append(
            materials.piece(sweeps.tube([(s * 0.5 * r, 0.0, z - 0.8 * r), (s * 0.72 * r, 0.0, 0.0)], 0.006, 8), steel)
        )
    found.append(materials.piece(sweeps.tube([(0.0, 0.0, z + r), (0.0, 0.0, z + 1.28 * r)], 0.005, 8), steel))
    return found


def bin_(draft: Draft) -> list[Piece]:
    """An open waste bin with a rim."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    outer = [(0.0, 0.0), (0.74 * r, 0.0), (0.77 * r, 0.02 * h), (0.95 * r, 0.93 * h), (r, 0.935 * h), (r, 0.985 * h)]
    return [materials.piece(hollow(outer, 0.05 * r, 0.03 * h, 28), materials.paint(draft.color(0), 0.3))]


def hamper(draft: Draft) -> list[Piece]:
    """A wicker basket with a cloth over its rim."""
    w, d, h = draft.size
    x, y = w / 2, d / 2
    wicker = materials.tinted("wicker", (0.78, 0.64, 0.46, 1.0))
    body = solids.box((0.012 - x, 0.012 - y, 0.0), (x - 0.012, y - 0.012, 0.93 * h), 0.05, 2)
    liner = solids.box((-x, -y, 0.82 * h), (x, y, 0.945 * h), 0.03, 2)
    lid = solids.soft((0.004 - x, 0.004 - y, 0.93 * h), (x - 0.004, y - 0.004, h), 0.02, 0.0, 2, 1)
    knob = sweeps.ring((0.0, y - 0.006, 0.9 * h), 0.02, 0.004, "y", 14, 5)
    return [
        materials.piece(body, wicker),
        materials.piece(liner, materials.cloth(draft.color(0), "linen")),
        materials.piece(lid, wicker),
        materials.piece(shaping.moved(knob, 0.0, 0.0, -0.2 * h), materials.leather(c.WALNUT)),
    ]


def boots(draft: Draft) -> list[Piece]:
    """A pair of ankle boots side by side."""
    w, d, h = draft.size
    coat, sole = materials.leather(draft.color(0)), materials.paint(c.BLACK, 0.1)
    leg = [(0.0, 0.2), (0.9, 0.2), (0.84, 0.6), (0.92, 0.97), (0.86, 1.0), (0.76, 1.0), (0.72, 0.7), (0.0, 0.6)]
    found = []
    for s in (-1.0, 1.0):
        at, half = s * 0.26 * w, 0.21 * w
        foot = solids.soft((at - half, -d / 2 + 0.01, 0.005), (at + half, d / 2, 0.36 * h), 0.045, 0.0, 2, 1)
        shaft = shaping.stretched(solids.lathe(leg, 18, (1.0, h)), half, 0.24 * d, 1.0)
        found += [materials.piece(foot, coat), materials.piece(shaping.moved(shaft, at, -0.22 * d), coat)]
        found.append(
            materials.piece(
                solids.box((at - 0.92 * half, -d / 2, 0.0), (at + 0.92 * half, d / 2 - 0.01, 0.03), 0.012), sole
            )
        )
    return found


def keys(_: Draft) -> list[Piece]:
    """Two keys on a ring."""
    found = [materials.piece(sweeps.ring((-0.35, 0.0, 0.09), 0.13, 0.016, "z", 20, 6), materials.chrome())]
    for turn, tint in ((0.28, c.STEEL), (-0.30, c.MUSTARD)):
        bow = solids.cylinder((0.0, 0.0, 0.05), 0.12, 0.03, "z", 16)
        stem = solids.box((0.08, -0.03, 0.035), (0.55, 0.03, 0.065), 0.005)
        bits = [
            solids.box((0.3 + 0.09 * k, 0.02, 0.035), (0.35 + 0.09 * k, 0.06 + 0.02 * (k % 2), 0.065), 0.0, 0)
            for k in range(3)
        ]
        shape = shaping.moved(shaping.turned(shaping.merged(bow, stem, *bits), "z", turn), -0.18, 0.3 * turn)
        found.append(materials.piece(shape, materials.metal(tint)))
    return found


def watch(draft: Draft) -> list[Piece]:
    """A wrist watch that stands on its strap."""
    w, d, h = draft.size
    angle = np.linspace(0.0, 2 * math.pi, 25)
    outer = np.stack([np.cos(angle) * w / 2, np.sin(angle) * h / 2], -1)
    band = []
    for scale, order in ((1.0, 1), (0.90, -1)):
        ring = outer * scale
        y = np.array([-0.30 * d, 0.30 * d])
        points = np.stack([np.stack([ring[:, 0], np.full(25, v), ring[:, 1]], -1) for v in y], 1)[::-order]
        band.append(shaping.surface(points, points[..., :2]))
    for side, order in ((-0.30 * d, 1), (0.30 * d, -1)):
        points = np.stack(
            [np.stack([outer[:, 0] * k, np.full(25, side), outer[:, 1] * k], -1) for k in (0.90, 1.0)], 1
        )[::order]
        band.append(shaping.surface(points, points[..., :2]))
    strap = shaping.moved(shaping.merged(*band), z=h / 2)
    case = solids.cylinder((0.0, 0.0, h - 0.0035), d / 2, 0.007, "z", 22)
    face = sweeps.lying((0.0, 0.0, h + 0.0003), 0.66 * d, 0.66 * d)
    return [materials.piece(strap, materials.leather(draft.color(0))),
        materials.piece(case, materials.chrome()), materials.piece(face, materials.picture("dial_dark"))]  # fmt: skip


def pen(draft: Draft) -> list[Piece]:
    """A ball pen along y."""
    w, d, _ = draft.size
    r = w / 2
    body = [(0.0, -0.5), (0.16, -0.49), (0.7, -0.42), (0.8, -0.36), (0.8, 0.42), (0.3, 0.43), (0.3, 0.5), (0.0, 0.5)]
    clip = solids.box((-0.25 * r, 0.18 * d, 0.8 * r), (0.25 * r, 0.42 * d, r), 0.0, 0)
    tip = solids.box((-r, 0.0, -r), (r, 0.012, 0.8 * r), 0.4 * r)
    return [materials.piece(solids.along(solids.lathe(body, 10, (r, d)), "y"), materials.paint(draft.color(0), 0.5)),
        materials.piece(clip, materials.chrome()), materials.piece(tip, materials.chrome())]  # fmt: skip


def disc(draft: Draft) -> list[Piece]:
    """A compact disc."""
    w, _, h = draft.size
    r = w / 2
    shape = solids.lathe([(0.13 * r, 0.0), (r, 0.0), (r, h), (0.36 * r, h)], 32)
    hub = solids.lathe([(0.36 * r, h), (0.13 * r, h), (0.13 * r, 0.0)], 20)
    return [materials.piece(shape, materials.chrome()), materials.piece(hub, materials.paint(c.WHITE, 0.6))]
