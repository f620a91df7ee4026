"""Sinks and taps."""

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.furniture import fronts
from hthor.looks.meshes import solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece

Rect = tuple[float, float, float, float]


def sink(draft: Draft) -> list[Piece]:
    """A cabinet with two doors under a steel basin, and a bent tap."""
    w, d, h = draft.size
    rest = draft.surfaces[-1]
    rim = 0.82 * h
    x, y, floor = w / 2, d / 2, rest.centre[2]
    left, right = rest.centre[0] - rest.half[0], rest.centre[0] + rest.half[0]
    near, far = rest.centre[1] - rest.half[1], rest.centre[1] + rest.half[1]
    body, steel = materials.guess(draft.parts[0].rgba), materials.metal(c.STEEL)
    shelf = 0.028
    found = [materials.piece(solids.box((-x, -y, 0.0), (x, 0.96 * d - y - 0.02, floor - 0.004), 0.004), body)]
    low = min(0.10, 0.2 * floor)
    for a, b in ((-x + 0.004, -0.003), (0.003, x - 0.004)):
        leaf = fronts.panelled((a, 0.96 * d - y - 0.02, low), (b, 0.96 * d - y - 0.004, rim - shelf - 0.01))
        found += [materials.piece(shape, body) for shape in leaf]
        at = -0.05 if a < -0.01 else 0.05
        found.append(materials.piece(fronts.grip(at, 0.96 * d - y, y, 0.62 * rim, 0.82 * rim), materials.chrome()))
    hole = (left, near, right, far)
    carcass = _around(
        (-x, -y, x, 0.94 * d - y), (left, near - 0.012, right, far + 0.012), floor - 0.004, rim - shelf, 0.0
    )
    found += [materials.piece(shape, body) for shape in carcass]
    worktop = _around((-x, -y, x, y), hole, rim - shelf, rim, 0.006)
    found += [materials.piece(shape, materials.stone(c.STONE)) for shape in worktop]
    found += [materials.piece(shape, steel) for shape in _basin(left, right, near, far, floor, rim)]
    return [
        *found,
        *(
            materials.piece(shape, materials.chrome())
            for shape in _tap(near - 0.045, near + 0.38 * (far - near), rim, h)
        ),
    ]


def _around(outer: Rect, hole: Rect, low: float, high: float, radius: float) -> list[Mesh]:
    """A horizontal slab with a hole, made of four boxes; rectangles are (left, back, right, front) [m]."""
    (x0, y0, x1, y1), (a, b, e, f) = outer, hole
    return [
        solids.box((x0, y0, low), (a, y1, high), radius),
        solids.box((e, y0, low), (x1, y1, high), radius),
        solids.box((a, y0, low), (e, b, high), radius),
        solids.box((a, f, low), (e, y1, high), radius),
    ]


def _basin(left: float, right: float, near: float, far: float, floor: float, rim: float) -> list[Mesh]:
    """The inside of a basin: a floor with a drain, and four walls that lean a little."""
    t = 0.014
    walls = [
        solids.box((left - t, near - t, floor), (left + 0.001, far + t, rim - 0.002), 0.001),
        solids.box((right - 0.001, near - t, floor), (right + t, far + t, rim - 0.002), 0.001),
        solids.box((left, near - t, floor), (right, near + 0.001, rim - 0.002), 0.001),
        solids.box((left, far - 0.001, floor), (right, far + t, rim - 0.002), 0.001),
    ]
    bottom = solids.box((left - t, near - t, floor - 0.01), (right + t, far + t, floor), 0.001)
    drain = sweeps.ring(((left + right) / 2, (near + far) / 2, floor), 0.03, 0.003, "z", 16, 6)
    return [*walls, bottom, drain]


def _tap(y: float, reach: float, low: float, high: float) -> list[Mesh]:
    """A swan-neck tap with a lever; its spout ends over the basin."""
    r = min(0.012, 0.1 * (high - low))
    rise = high - low
    path = sweeps.bend((0.0, y, low), (0.0, y, low + 0.62 * rise), (0.0, y + 0.25 * (reach - y), high - r),
        (0.0, y + 0.75 * (reach - y), high - 1.6 * r), (0.0, reach, low + 0.55 * rise), steps=4)  # fmt: skip
    return [
        solids.cylinder((0.0, y, low + 0.015), 2.2 * r, 0.03, "z", 16),
        sweeps.tube(path, r, 10),
        sweeps.tube([(2.0 * r, y, low + 0.03), (5.0 * r, y, low + 0.055)], 0.6 * r, 8),
    ]


def faucet(draft: Draft) -> list[Piece]:
    """A tap on a wall plate."""
    w, d, h = draft.size
    y = -d / 2
    path = sweeps.bend(
        (0.0, y, 0.45 * h),
        (0.0, y + 0.5 * d, 0.62 * h),
        (0.0, y + 0.88 * d, 0.5 * h),
        (0.0, y + 0.93 * d, 0.05 * h),
        steps=5,
    )
    shapes = [
        solids.cylinder((0.0, y + 0.012, 0.45 * h), w / 2, 0.024, "y", 18),
        sweeps.tube(path, 0.22 * w, 10),
        sweeps.tube([(0.0, y + 0.3 * d, 0.6 * h), (0.0, y + 0.42 * d, h)], 0.12 * w, 8),
    ]
    return [materials.piece(shape, materials.chrome()) for shape in shapes]
