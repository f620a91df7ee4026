"""Things to sit on: sofas, armchairs, chairs, stools, ottomans."""

import math

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece


def _feet(draft: Draft, height: float, inset: float, radius: float = 0.022) -> list[Mesh]:
    w, d, _ = draft.size
    return [
        solids.cylinder((sx * (w / 2 - inset), sy * (d / 2 - inset), height / 2), 0.6 * radius, height, "z", 10, radius)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]


def sofa(draft: Draft) -> list[Piece]:
    """A frame with round arms, and loose cushions for the seat and the back."""
    w, d, h = draft.size
    seat = draft.surfaces[0]
    top, e = seat.centre[2], min(0.03, 0.05 * d)
    arm, back = w / 2 - seat.half[0] - e, d / 2 + seat.centre[1] - seat.half[1] - e
    seats = max(1, sum(part.rgba == draft.color(1) for part in draft.parts)) if len(draft.colors()) > 1 else 1
    base, rail, feet = 0.58 * top, 0.74 * h, 0.05 * h
    x, y, r = w / 2, d / 2, min(0.05, 0.4 * arm, 0.25 * back)
    shell = 0.55 * back
    frame = [
        solids.box((arm - x - 0.01, -y + 0.02, feet), (x - arm + 0.01, y - 0.025, base), 0.015),
        solids.soft((-x, -y + 0.01, feet), (arm - x, y, rail), r, 0.004, 2, 1),
        solids.soft((x - arm, -y + 0.01, feet), (x, y, rail), r, 0.004, 2, 1),
        solids.soft((-x + 0.02, -y, feet), (x - 0.02, shell - y, h), 0.8 * r, 0.0, 2, 1),
    ]
    width, soft = (w - 2 * arm) / seats, []
    for k in range(seats):
        low, high = arm - x + k * width + 0.003, arm - x + (k + 1) * width - 0.003
        soft.append(solids.soft((low, back - y - 0.03, base), (high, y - 0.004, top), 0.03, 0.005))
        soft.append(solids.soft((low, shell - y - 0.03, top - 0.01), (high, back - y + 0.015, 0.97 * h), 0.05, 0.02))
    return [
        *(materials.piece(shape, materials.cloth(draft.color(0))) for shape in frame),
        *(materials.piece(shape, materials.cloth(draft.color(1), "canvas")) for shape in soft),
        *(materials.piece(shape, materials.wood(c.WALNUT)) for shape in _feet(draft, 1.3 * feet, 0.06)),
    ]


def chair(draft: Draft) -> list[Piece]:
    """Four tapered legs, a hollowed seat, and a back of slats between two posts that lean a little."""
    w, d, h = draft.size
    top = draft.surfaces[0].centre[2]
    x, y, t, r = w / 2, d / 2, min(0.03, 0.08 * h), min(0.02, 0.06 * w)
    lean = min(0.03, 0.08 * d)
    frame = []
    for s in (-1.0, 1.0):
        frame.append(
            sweeps.tube([(s * (x - r), y - r, 0.0), (s * (x - 1.6 * r), y - 2.0 * r, top - t)], [0.7 * r, r], 10)
        )
        frame.append(sweeps.tube([(s * (x - r), r - y, 0.0), (s * (x - 1.3 * r), r - y + lean, top - 0.02),
            (s * (x - 1.3 * r), r - y, h - 0.5 * r)], [0.7 * r, r, 0.85 * r], 10))  # fmt: skip
        at = s * (x - 1.4 * r)
        frame.append(solids.box((at - 0.008, 3 * r - y, 0.72 * top), (at + 0.008, y - 3 * r, 0.77 * top)))
    rise = h - top
    for share, tall in ((0.93, 0.14), (0.28, 0.08)):
        z, deep, half = top + share * rise, -y + r + lean * (1.0 - share), 0.5 * tall * rise
        low, high = min(z - half, h - 2 * half), min(z + half, h)
        frame.append(solids.box((1.3 * r - x, deep - 0.011, low), (x - 1.3 * r, deep + 0.011, high), 0.005))
    for k in range(4):
        at = (w - 2.6 * r) * ((k + 1) / 5.0 - 0.5)
        low, high = top + 0.25 * rise, top + 0.90 * rise
        frame.append(sweeps.tube([(at, r - y + 0.72 * lean, low), (at, r - y + 0.08 * lean, high)], 0.009, 8))
    frame.append(solids.box((2 * r - x, 2 * r - y, top - t - 0.045), (x - 2 * r, y - 2.5 * r, top - t), 0.004))
    seat = solids.soft((-x, -y, top - t), (x, y, top), min(0.014, 0.45 * t), 0.0, 2, 1)
    wood, plank = materials.guess(draft.parts[-1].rgba), materials.guess(draft.color(0))
    if not plank.texture:
        plank = materials.leather(draft.color(0))
    return [*(materials.piece(shape, wood) for shape in frame), materials.piece(seat, plank)]


def stool(draft: Draft) -> list[Piece]:
    """A round padded seat on three splayed legs with a ring."""
    w, d, h = draft.size
    seat, legs = materials.guess(draft.color(0)), materials.guess(draft.color(1))
    t, r = min(0.05, 0.25 * h), min(w, d) / 2
    plate = [(0.0, h - t), (0.82 * r, h - t), (0.97 * r, h - 0.8 * t), (r, h - 0.5 * t), (0.985 * r, h - 0.18 * t),
        (0.93 * r, h), (0.0, h)]  # fmt: skip
    under = []
    for k in range(4):
        a = math.pi / 4 + k * math.pi / 2
        under.append(sweeps.tube([(0.86 * r * math.cos(a), 0.86 * r * math.sin(a), 0.0), (0.52 * r * math.cos(a),
            0.52 * r * math.sin(a), h - t)], 0.013, 8))  # fmt: skip
    under.append(sweeps.ring((0.0, 0.0, 0.3 * h), 0.75 * r, 0.009, "z", 24, 6))
    shape = shaping.stretched(solids.lathe(plate, 28), w / (2 * r), d / (2 * r), 1.0)
    return [materials.piece(shape, seat), *(materials.piece(leg, legs) for leg in under)]


def ottoman(draft: Draft) -> list[Piece]:
    """A padded block with a seam, on four feet."""
    w, d, h = draft.size
    x, y, foot = w / 2, d / 2, min(0.08, 0.22 * h)
    coat = materials.cloth(draft.parts[-1].rgba)
    body = solids.soft((-x, -y, foot), (x, y, h - 0.12), 0.02, 0.004, 2, 1)
    lid = solids.soft((-x, -y, h - 0.125), (x, y, h), 0.03, 0.004)
    return [
        materials.piece(body, coat),
        materials.piece(lid, coat),
        *(materials.piece(shape, materials.wood(c.WALNUT)) for shape in _feet(draft, foot + 0.01, 0.07)),
    ]
