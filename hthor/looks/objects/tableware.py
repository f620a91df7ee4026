"""Tableware and cookware: mugs, bowls, plates, pots, bottles, cutlery."""

import math
from collections.abc import Sequence

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Vec2


def hollow(outer: Sequence[Vec2], wall: float, floor: float, sides: int = 24) -> Mesh:
    """A vessel; ``outer`` is its profile from the middle of the foot up to the rim, ``wall`` its thickness [m]."""
    rim, high = outer[-1]
    inner = [(max(r - wall, 0.0), max(z, floor)) for r, z in reversed(outer[1:-1]) if z > floor]
    lip = [(rim - 0.3 * wall, high + 0.3 * wall), (rim - 0.7 * wall, high + 0.3 * wall), (rim - wall, high)]
    deep = inner[-1][0] if inner else rim - wall
    return solids.lathe([*outer, *lip, *inner, (deep * 0.85, floor), (0.0, floor)], sides)


def mug(draft: Draft) -> list[Piece]:
    """A hollow cylinder with a handle to the right."""
    w, d, h = draft.size
    r = min(w, d) / 2
    glaze, x = materials.ceramic(draft.color(0)), r - w / 2
    outer = [(0.0, 0.0), (0.80 * r, 0.0), (0.93 * r, 0.02 * h), (r, 0.10 * h), (r, 0.97 * h)]
    cup = shaping.moved(hollow(outer, 0.10 * r, 0.07 * h), x)
    found = [materials.piece(cup, glaze)]
    if w > 1.05 * d:
        path = sweeps.bend((x + 0.96 * r, 0.0, 0.80 * h), (w / 2 - 0.012, 0.0, 0.72 * h),
            (w / 2 - 0.007, 0.0, 0.45 * h), (x + 0.96 * r, 0.0, 0.20 * h), steps=5)  # fmt: skip
        found.append(materials.piece(shaping.stretched(sweeps.tube(path, 0.0065, 8), 1.0, 1.25, 1.0), glaze))
    return found


def cup(draft: Draft) -> list[Piece]:
    """A tumbler."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    outer = [(0.0, 0.0), (0.66 * r, 0.0), (0.72 * r, 0.03 * h), (0.90 * r, 0.5 * h), (r, 0.97 * h)]
    return [materials.piece(hollow(outer, 0.08 * r, 0.08 * h), materials.ceramic(draft.color(0)))]


def bowl(draft: Draft) -> list[Piece]:
    """A hemisphere on a foot ring, paler inside."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    outer = [(0.0, 0.0), (0.42 * r, 0.0), (0.45 * r, 0.06 * h), (0.60 * r, 0.14 * h), (0.80 * r, 0.40 * h),
        (0.92 * r, 0.68 * h), (r, 0.97 * h)]  # fmt: skip
    inside = [(0.99 * r, 0.985 * h), (0.90 * r, 0.68 * h), (0.76 * r, 0.40 * h), (0.55 * r, 0.19 * h), (0.0, 0.12 * h)]
    return [
        materials.piece(hollow(outer, 0.05 * r, 0.10 * h), materials.ceramic(draft.color(0))),
        materials.piece(solids.lathe(inside, 24), materials.ceramic(c.CREAM)),
    ]


def plate(draft: Draft) -> list[Piece]:
    """A shallow well in a broad rim with a colored line."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    profile = [(0.0, 0.0), (0.56, 0.0), (0.60, 0.10), (0.80, 0.50), (1.0, 0.94), (0.99, 1.0), (0.82, 0.86),
        (0.66, 0.82), (0.0, 0.82)]  # fmt: skip
    line = [(0.95 * r, 0.985 * h), (0.90 * r, 0.955 * h)]
    return [
        materials.piece(solids.lathe(profile, 32, (r, h)), materials.ceramic(draft.color(0))),
        materials.piece(shaping.moved(solids.lathe(line, 32), z=0.0004), materials.ceramic(c.TEAL)),
    ]


def pot(draft: Draft) -> list[Piece]:
    """A pot with a lid, a knob and two handles."""
    w, d, h = draft.size
    r, steel, dark = 0.86 * min(w, d) / 2, materials.metal(c.STEEL), materials.paint(c.BLACK, 0.4)
    body = [(0.0, 0.0), (0.93 * r, 0.0), (r, 0.05 * h), (r, 0.66 * h), (1.04 * r, 0.68 * h), (1.04 * r, 0.71 * h)]
    lid = [(1.02 * r, 0.71 * h), (1.0 * r, 0.74 * h), (0.6 * r, 0.82 * h), (0.16 * r, 0.85 * h), (0.0, 0.85 * h)]
    knob = [(0.06 * r, 0.84 * h), (0.07 * r, 0.90 * h), (0.17 * r, 0.94 * h), (0.16 * r, 0.99 * h), (0.0, h)]
    ears = []
    for s in (-1.0, 1.0):
        path = [(s * 0.97 * r, -0.3 * r, 0.56 * h), (s * w / 2 * 0.98, -0.24 * r, 0.58 * h),
            (s * w / 2 * 0.98, 0.24 * r, 0.58 * h), (s * 0.97 * r, 0.3 * r, 0.56 * h)]  # fmt: skip
        ears.append(sweeps.tube(path, 0.008, 8))
    return [
        *(materials.piece(solids.lathe(profile, 28), steel) for profile in (body, lid)),
        *(materials.piece(shape, dark) for shape in (solids.lathe(knob, 14), *ears)),
    ]


def pan(draft: Draft) -> list[Piece]:
    """A frying pan with its handle to the front."""
    w, d, h = draft.size
    r = min(w, 0.65 * d) / 2
    at = r - d / 2
    outer = [(0.0, 0.0), (0.78 * r, 0.0), (0.84 * r, 0.06 * h), (r, 0.70 * h)]
    body = shaping.moved(hollow(outer, 0.04 * r, 0.10 * h, 32), 0.0, at)
    path = sweeps.bend(
        (0.0, at + 0.94 * r, 0.62 * h), (0.0, at + 1.2 * r, 0.86 * h), (0.0, d / 2 - 0.01, 0.90 * h), steps=4
    )
    handle = shaping.stretched(sweeps.tube(path, [0.008] * 4 + [0.010] * 5, 8), 1.3, 1.0, 1.0)
    return [
        materials.piece(body, materials.metal(draft.color(0))),
        materials.piece(handle, materials.paint(c.BLACK, 0.3)),
    ]


def kettle(draft: Draft) -> list[Piece]:
    """A bellied kettle with a spout to the front and a handle over it."""
    r, h = 0.40 * min(draft.size[:2]), draft.size[2]
    belly = [(0.0, 0.0), (0.92, 0.0), (1.0, 0.06), (0.98, 0.25), (0.80, 0.50), (0.55, 0.64), (0.50, 0.67),
        (0.2, 0.71), (0.0, 0.72)]  # fmt: skip
    knob = solids.ball((0.0, 0.0, 0.745 * h), (0.14 * r, 0.14 * r, 0.04 * h), 12)
    spout = sweeps.tube(
        [(0.0, 0.6 * r, 0.34 * h), (0.0, 1.05 * r, 0.46 * h), (0.0, 1.4 * r, 0.64 * h)],
        [0.24 * r, 0.17 * r, 0.10 * r],
        10,
    )
    over = sweeps.bend((0.0, -0.62 * r, 0.56 * h), (0.0, -0.60 * r, 0.90 * h), (0.0, 0.0, 0.97 * h),
        (0.0, 0.6 * r, 0.90 * h), (0.0, 0.62 * r, 0.56 * h), steps=4)  # fmt: skip
    steel, dark = materials.chrome(draft.color(0)), materials.paint(c.BLACK, 0.4)
    return [
        *(materials.piece(shape, steel) for shape in (solids.lathe(belly, 28, (r, h)), spout)),
        *(materials.piece(shape, dark) for shape in (sweeps.tube(over, 0.009, 8), knob)),
    ]


def bottle(draft: Draft) -> list[Piece]:
    """A wine-bottle shape with a label and a cap."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    body = [(0.0, 0.01), (0.5, 0.0), (0.93, 0.0), (1.0, 0.02), (1.0, 0.56), (0.94, 0.62), (0.62, 0.71), (0.38, 0.77),
        (0.33, 0.90), (0.38, 0.91), (0.0, 0.91)]  # fmt: skip
    cap = [(0.0, 0.90), (0.41, 0.90), (0.41, 0.985), (0.36, 1.0), (0.0, 1.0)]
    label = [(1.006, 0.16), (1.006, 0.46)]
    tint = draft.color(0)
    return [
        materials.piece(solids.lathe(body, 24, (r, h)), Material(rgba=tint, specular=0.9, shininess=0.9)),
        materials.piece(solids.lathe(label, 24, (r, h)), materials.paint(c.PAPER, 0.1)),
        materials.piece(solids.lathe(cap, 16, (r, h)), materials.paint(draft.color(1), 0.4)),
    ]


def dispenser(draft: Draft) -> list[Piece]:
    """A soap bottle with a pump."""
    w, d, h = draft.size
    r = min(w, d) / 2
    body = [(0.0, 0.0), (0.94, 0.0), (1.0, 0.03), (1.0, 0.58), (0.88, 0.66), (0.42, 0.70), (0.0, 0.70)]
    pump = [(0.40, 0.69), (0.40, 0.77), (0.16, 0.78), (0.16, 0.93), (0.36, 0.94), (0.36, 1.0), (0.0, 1.0)]
    label = [(1.006, 0.15), (1.006, 0.48)]
    nozzle = sweeps.tube([(0.0, 0.0, 0.965 * h), (0.0, 0.8 * r, 0.965 * h), (0.0, 0.92 * r, 0.92 * h)], 0.11 * r, 8)
    white = materials.paint(draft.color(1), 0.5)
    return [
        materials.piece(solids.lathe(body, 24, (r, h)), Material(rgba=draft.color(0), specular=0.6, shininess=0.7)),
        materials.piece(solids.lathe(pump, 14, (r, h)), white),
        materials.piece(nozzle, white),
        materials.piece(solids.lathe(label, 24, (r, h)), materials.paint(c.PAPER, 0.2)),
    ]


def shaker(draft: Draft) -> list[Piece]:
    """A glass body under a domed metal top."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    body = [(0.0, 0.0), (0.95 * r, 0.0), (r, 0.04 * h), (0.88 * r, 0.40 * h), (0.80 * r, 0.68 * h), (0.0, 0.68 * h)]
    top = [(0.84 * r, 0.67 * h), (0.84 * r, 0.80 * h), (0.70 * r, 0.92 * h), (0.36 * r, 0.985 * h), (0.0, h)]
    return [
        materials.piece(solids.lathe(body, 18), materials.ceramic(draft.color(0))),
        materials.piece(solids.lathe(top, 18), materials.chrome()),
    ]


def vase(draft: Draft) -> list[Piece]:
    """A bellied, open vase."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    outer = [(0.0, 0.0), (0.52 * r, 0.0), (0.56 * r, 0.02 * h)]
    for k in range(11):
        t = k / 10
        outer.append(
            (r * (0.56 + 0.44 * math.sin(math.pi * min(t * 1.12, 1.0)) ** 0.9 - 0.08 * t), h * (0.02 + 0.86 * t))
        )
    outer += [(0.42 * r, 0.93 * h), (0.56 * r, 0.985 * h)]
    return [materials.piece(hollow(outer, 0.08 * r, 0.10 * h, 28), materials.ceramic(draft.color(0)))]


def cutlery(draft: Draft) -> list[Piece]:
    """A fork."""
    w, d, _ = draft.size
    tines = [
        sweeps.tube([(x * w * 0.36, 0.30 * d, 0.006), (x * w * 0.40, 0.5 * d, 0.010)], 0.0016, 5)
        for x in (-1, -0.33, 0.33, 1)
    ]
    stem = [(-0.16, -0.5), (0.16, -0.5), (0.10, 0.1), (0.14, 0.18), (-0.14, 0.18), (-0.10, 0.1)]
    palm = [(-0.14, 0.16), (0.14, 0.16), (0.5, 0.24), (0.5, 0.31), (-0.5, 0.31), (-0.5, 0.24)]
    plates = [sweeps.extruded(np.array(outline) * (w, d), 0.002, 0.006) for outline in (stem, palm)]
    return [materials.piece(shape, materials.chrome()) for shape in (*plates, *tines)]


def spoon(draft: Draft) -> list[Piece]:
    """A wooden cooking spoon."""
    w, d, h = draft.size
    bowl = solids.ball((0.0, 0.5 * d - 0.42 * w * 1.4, 0.4 * h), (w / 2, 0.7 * w, 0.4 * h), 16)
    path = np.array([(0.0, -d / 2, 0.4 * h), (0.0, 0.0, 0.5 * h), (0.0, 0.5 * d - w, 0.5 * h)])
    return [materials.piece(shape, materials.wood(draft.color(0))) for shape in (bowl, sweeps.tube(path, 0.006, 8))]
