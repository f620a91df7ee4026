"""Bathroom fixtures: toilet, bathtub, shower and its head, towels, paper."""

import math

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.furniture import plain
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece


def _oval(rows: list[tuple[float, float, float, float]], sides: int = 28) -> Mesh:
    """A body with egg-shaped horizontal sections: rows of (half width, back y, front y, z), from the bottom up."""
    angle = np.linspace(0.0, 2 * math.pi, sides + 1)
    points = []
    for half, back, front, z in rows:
        y = (back + front) / 2 + (front - back) / 2 * np.sin(angle)
        x = half * np.cos(angle) * (1.0 - 0.12 * np.sin(angle))
        points.append(np.stack([x, y, np.full_like(angle, z)], -1))
    grid = np.stack(points, 1)
    uv = np.stack(np.broadcast_arrays(angle[:, None], np.arange(len(rows))[None, :] * 0.1), -1)
    return shaping.surface(grid, uv)


def toilet(draft: Draft) -> list[Piece]:
    """A tank with a button, an egg-shaped bowl on a foot, and a closed lid."""
    w, d, h = draft.size
    x, y, tank, seat = w / 2, d / 2, 0.28 * d, 0.50 * h
    white = materials.ceramic(draft.color(0))
    back = tank - y
    bowl = _oval([(0.0, back, 0.5 * back, 0.0), (0.58 * x, back - 0.05, 0.50 * y, 0.0),
        (0.56 * x, back - 0.05, 0.50 * y, 0.10 * h), (0.60 * x, back - 0.05, 0.58 * y, 0.22 * h),
        (0.84 * x, back - 0.04, 0.93 * y, 0.40 * h), (0.90 * x, back - 0.02, 0.985 * y, 0.46 * h),
        (0.90 * x, back - 0.02, 0.985 * y, seat - 0.008), (0.0, 0.0, 0.0, seat - 0.008), ])  # fmt: skip
    lid = _oval([(0.0, 0.0, 0.0, seat - 0.004), (0.90 * x, back + 0.015, y - 0.004, seat - 0.004),
        (0.93 * x, back + 0.012, y, seat + 0.010), (0.90 * x, back + 0.015, y - 0.008, seat + 0.026),
        (0.0, 0.0, 0.0, seat + 0.032)])  # fmt: skip
    body = [bowl, lid, solids.box((-0.62 * x, -y + 0.01, 0.0), (0.62 * x, back, 0.48 * h), 0.03, 2),
        solids.box((0.02 - x, -y, 0.45 * h), (x - 0.02, back, 0.955 * h), 0.03, 2), solids.box((-x, -y, 0.95 * h),
        (x, back + 0.008, h), 0.012, 2)]  # fmt: skip
    button = solids.cylinder((0.0, back - 0.5 * tank, h - 0.001), 0.022, 0.004, "z", 16)
    button = shaping.moved(button, z=-0.001)
    return [*(materials.piece(shape, white) for shape in body), materials.piece(button, materials.chrome())]


def bathtub(draft: Draft) -> list[Piece]:
    """A tub with a broad rim, rounded walls inside, a tap and a drain."""
    w, d, h = draft.size
    x, y, rest = w / 2, d / 2, draft.surfaces[0]
    floor, half, long = rest.centre[2], rest.half[0], rest.half[1]
    white = materials.ceramic(draft.color(0))
    rows = [_rounded(x - 0.012, y - 0.012, 0.03, 0.0), _rounded(x - 0.012, y - 0.012, 0.03, h - 0.05),
        _rounded(x, y, 0.03, h - 0.045), _rounded(x, y, 0.03, h - 0.012), _rounded(x - 0.006, y - 0.006, 0.03, h),
        _rounded(half + 0.01, long + 0.01, 0.10, h), _rounded(half, long, 0.10, h - 0.012),
        _rounded(half, long, 0.10, floor + 0.08), _rounded(half * 0.985, long * 0.99, 0.09, floor + 0.02),
        _rounded(half * 0.955, long * 0.975, 0.07, floor), _rounded(0.0, 0.0, 0.0, floor)]  # fmt: skip
    grid = np.stack(rows, 1)
    around = np.arange(len(grid))[:, None] * 0.1
    uv = np.stack(np.broadcast_arrays(around, np.arange(len(rows))[None, :] * 0.1), -1)
    tub = shaping.surface(grid, uv)
    at = -y + 0.045
    tap = sweeps.tube(
        [(0.0, at, h - 0.04), (0.0, at + 0.03, h - 0.010), (0.0, at + 0.09, h - 0.012), (0.0, at + 0.13, h - 0.05)],
        0.009,
        8,
    )
    drain = solids.cylinder((0.0, 0.75 * long, floor), 0.03, 0.004, "z", 16)
    return [materials.piece(tub, white), *(materials.piece(s, materials.chrome()) for s in (tap, drain))]


def _rounded(x: float, y: float, radius: float, z: float, steps: int = 5) -> np.ndarray:
    """A closed horizontal rectangle with round corners, counter-clockwise."""
    points, inner_x, inner_y = [], (x - radius) * (x > radius), (y - radius) * (y > radius)
    for quarter, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for k in range(steps):
            a = math.pi / 2 * (quarter + k / (steps - 1))
            points.append((sx * inner_x + radius * math.cos(a), sy * inner_y + radius * math.sin(a), z))
    return np.array([*points, points[0]])


def shower(draft: Draft) -> list[Piece]:
    """A tray with a drain, glass in slim rails on two sides, and a pipe with a broad head and a valve."""
    w, d, h = draft.size
    x, y = w / 2, d / 2
    low = 0.05 * h
    white, steel = materials.ceramic(draft.color(0)), materials.chrome()
    found = [
        materials.piece(solids.box((-x, -y, 0.0), (x, y, low), 0.02, 2), white),
        materials.piece(solids.cylinder((0.0, 0.0, low), 0.045, 0.003, "z", 20), steel),
    ]
    panes = [part for part in draft.parts if part.rgba[3] < 0.99]
    for part in panes:
        (px, py, pz), (a, b, e) = part.centre, part.half
        for s in (-1.0, 1.0):
            rail = solids.box((px - max(a, 0.008), py - max(b, 0.008), pz + s * e - (0.02 if s > 0 else 0.0)),
                (px + max(a, 0.008), py + max(b, 0.008), pz + s * e + (0.0 if s > 0 else 0.02)), 0.002)  # fmt: skip
            found.append(materials.piece(rail, steel))
            at_x, at_y = (px, py + s * b) if a < b else (px + s * a, py)
            post = solids.box((at_x - 0.009, at_y - 0.009, pz - e), (at_x + 0.009, at_y + 0.009, pz + e), 0.002)
            found.append(materials.piece(post, steel))
    at = 0.035 - y
    path = sweeps.bend(
        (0.0, at, 0.48 * h), (0.0, at, 0.90 * h), (0.0, at + 0.05, 0.965 * h), (0.0, at + 0.20, 0.97 * h), steps=5
    )
    fittings = [
        sweeps.tube(path, 0.011, 8),
        solids.cylinder((0.0, at + 0.22, 0.955 * h), 0.09, 0.016, "z", 24),
        solids.cylinder((0.0, at - 0.02, 0.5 * h), 0.05, 0.03, "y", 18),
        sweeps.tube([(0.0, at, 0.5 * h), (0.055, at + 0.02, 0.49 * h)], 0.008, 8),
    ]
    found += [materials.piece(shape, steel) for shape in fittings]
    glass = [plain.piece(part, materials.glass()) for part in panes]
    return [*shaping.fitted(found, (-x, -y, 0.0), (x, y, h)), *glass]


def shower_head(draft: Draft) -> list[Piece]:
    """A round head on a bent pipe that comes out of the wall."""
    w, d, h = draft.size
    r = w / 2
    path = sweeps.bend(
        (0.0, -d / 2, 0.92 * h),
        (0.0, -0.1 * d, 0.86 * h),
        (0.0, d / 2 - r, 0.4 * h),
        (0.0, d / 2 - r, 0.15 * h),
        steps=4,
    )
    head = [(0.0, 0.0), (0.92 * r, 0.0), (r, 0.04 * h), (0.9 * r, 0.10 * h), (0.25 * r, 0.17 * h), (0.0, 0.17 * h)]
    shapes = [
        sweeps.tube(path, 0.010, 8),
        shaping.moved(solids.lathe(head, 24), 0.0, d / 2 - r),
        solids.cylinder((0.0, 0.006 - d / 2, 0.92 * h), 0.08 * h, 0.012, "y", 16),
    ]
    return [materials.piece(shape, materials.chrome()) for shape in shapes]


def towel_holder(draft: Draft) -> list[Piece]:
    """A rod between two brackets."""
    w, d, h = draft.size
    shapes = [sweeps.tube([(-0.46 * w, 0.3 * d, 0.5 * h), (0.46 * w, 0.3 * d, 0.5 * h)], 0.008, 10)]
    for s in (-1.0, 1.0):
        shapes += [
            solids.cylinder((s * (w / 2 - h / 2), 0.006 - d / 2, 0.5 * h), h / 2, 0.012, "y", 16),
            sweeps.tube([(s * 0.455 * w, -d / 2, 0.5 * h), (s * 0.455 * w, 0.4 * d, 0.5 * h)], 0.010, 8),
        ]
    return [materials.piece(shape, materials.chrome()) for shape in shapes]


def towel(draft: Draft) -> list[Piece]:
    """A towel over a rod, in soft folds, with a border near its lower edge."""
    w, d, h = draft.size
    down = np.concatenate([np.linspace(0.0, 0.06, 5), np.linspace(0.12, 1.0, 9)])
    across = np.linspace(-1.0, 1.0, 15)
    u, v = np.meshgrid(across, down, indexing="ij")
    wave = 0.10 * d * np.sin(7.0 * u + 1.0) * np.minimum(v * 3, 1.0)
    bend = 0.42 * d * np.sqrt(np.clip(1.0 - (1.0 - v / 0.06) ** 2, 0.0, 1.0)) * (v < 0.06) + 0.42 * d * (v >= 0.06)
    front = np.stack([u * w / 2 * (1.0 - 0.02 * np.sin(np.pi * v)), bend - 0.05 * d + wave, h - v * h], -1)
    back = front * (1.0, -0.9, 1.0) + (0.0, -0.04 * d, 0.0)
    uv = np.stack([front[..., 0], -front[..., 2]], -1)
    coat = materials.cloth(draft.color(0), "terry")
    sheets = [sweeps.sheet(front[::-1].copy(), uv[::-1], 0.006), sweeps.sheet(back, uv, 0.006)]
    stripe = front[::-1, 11:13] + (0.0, 0.0012, 0.0)
    r, g, b = (min(1.0, channel + 0.25) for channel in draft.color(0)[:3])
    pale = materials.cloth((r, g, b, 1.0), "terry")
    band = shaping.surface(stripe, uv[::-1, 11:13])
    return [*(materials.piece(shape, coat) for shape in sheets), materials.piece(band, pale)]


def toilet_paper(draft: Draft) -> list[Piece]:
    """A roll that stands on its end, with a cardboard core."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    paper = [(0.40 * r, 0.02 * h), (0.94 * r, 0.0), (r, 0.03 * h), (r, 0.97 * h), (0.94 * r, h), (0.40 * r, 0.98 * h)]
    core = [(0.40 * r, 0.99 * h), (0.36 * r, 0.99 * h), (0.36 * r, 0.01 * h)]
    return [
        materials.piece(solids.lathe(paper, 24), materials.cloth(draft.color(0), "felt")),
        materials.piece(solids.lathe(core, 16), materials.tinted("cardboard", c.CARDBOARD)),
    ]


def soap(draft: Draft) -> list[Piece]:
    """A worn bar of soap."""
    w, d, h = draft.size
    shape = solids.box((-w / 2, -d / 2, 0.0), (w / 2, d / 2, h), 0.42 * h, 3)
    mark = sweeps.ring((0.0, 0.0, 0.985 * h), 0.22 * w, 0.03 * h, "z", 18, 5)
    coat = materials.paint(draft.color(0), 0.4)
    return [materials.piece(shape, coat), materials.piece(shaping.stretched(mark, 1.2, 0.8, 1.0), coat)]
