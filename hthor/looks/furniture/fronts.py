"""Turns a kind's solids into cabinet makers' work: panelled fronts with handles, tapered legs, rounded tops.

Parts that move in the solids also move here, and every solid keeps its place, so that both looks of a thing agree.
"""

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.furniture import plain
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Part, Vec3

_FRONT_M = 0.05
"""A box may be a front if it is no thicker than this from back to front."""
_PROUD_M = 0.004


def joinery(draft: Draft) -> list[Piece]:
    """Draw each part by its shape and place: as a leg, a front or a handle, else as a board."""
    return [piece for part in draft.parts for piece in _worked(draft, part)]


def counter(draft: Draft) -> list[Piece]:
    """Joinery under a worktop of stone."""
    top = max(draft.parts, key=lambda part: (round(_hi(part)[2], 6), part.half[0]))
    under = [
        piece for part in draft.parts if part is not top for piece in (*_worked(draft, part), *_blind(draft, part))
    ]
    return [
        *under,
        plain.piece(top, materials.wood(top.rgba) if materials.wooden(top.rgba) else materials.stone(top.rgba)),
    ]


def cabinet(draft: Draft) -> list[Piece]:
    """A closed cabinet on feet, used for furniture of no particular kind."""
    w, d, h = draft.size
    x, y, foot, lip = w / 2, d / 2, min(0.08, 0.1 * h), min(0.02, 0.05 * d)
    coat, wood = materials.paint(draft.color(0), 0.2), materials.wood(c.OAK)
    body = solids.box((0.005 - x, -y, foot), (x - 0.005, y - lip, h - 0.02), 0.004)
    found = [materials.piece(body, coat), materials.piece(solids.box((-x, -y, h - 0.025), (x, y, h)), wood)]
    for s in (-1.0, 1.0):
        leaf = panelled(
            (min(s * 0.003, s * (x - 0.02)), y - lip, foot + 0.02),
            (max(s * 0.003, s * (x - 0.02)), y - 0.4 * lip - _PROUD_M, h - 0.04),
        )
        found += [materials.piece(shape, coat) for shape in leaf]
        found += [
            materials.piece(
                solids.cylinder((s * (x - 0.05), t * (y - 0.05), foot / 2), 0.015, foot, "z", 10, 0.022), wood
            )
            for t in (-1, 1)
        ]
        grip = Part(
            shape="box", centre=(s * 0.04, y - 0.3 * lip, 0.55 * h), half=(0.008, 0.3 * lip, 0.06 * h), rgba=c.STEEL
        )
        found.append(materials.piece(bar(grip), materials.chrome(c.STEEL)))
    return found


def _blind(draft: Draft, part: Part) -> list[Piece]:
    """Doors drawn on the front of a body that cannot be opened."""
    lo, hi = _lo(part), _hi(part)
    room = draft.size[1] / 2 - hi[1]
    if part.moves or part.half[1] < 0.1 or part.half[2] < 0.15 or not 0.008 < room < 0.06 or hi[0] - lo[0] < 0.15:
        return []
    count = max(1, round((hi[0] - lo[0]) / 0.6))
    edges = np.linspace(lo[0], hi[0], count + 1)
    found = []
    for x0, x1 in pairwise(edges):
        leaf = panelled((x0 + 0.002, hi[1] - 0.003, lo[2] + 0.004), (x1 - 0.002, hi[1] + 0.002, hi[2]))
        found += [materials.piece(shape, _grain(part)) for shape in leaf]
        at, z = x0 + 0.06, (lo[2] + hi[2]) / 2
        grip = Part(
            shape="box", centre=(at, hi[1] + 0.011, z), half=(0.008, 0.007, 0.15 * (hi[2] - lo[2])), rgba=c.STEEL
        )
        found.append(materials.piece(bar(grip), materials.chrome(c.STEEL)))
    return found


def _worked(draft: Draft, part: Part) -> Iterable[Piece]:
    if part.shape != "box" or part.rgba[3] < 0.99:
        return [plain.piece(part)]
    if _is_leg(part):
        return [materials.piece(_leg(part), _grain(part), part.moves)]
    if _is_handle(draft, part):
        return [materials.piece(bar(part), materials.chrome(part.rgba), part.moves)]
    if _is_front(draft, part):
        return _front(draft, part)
    return [plain.piece(part, _grain(part))]


def _grain(part: Part) -> Material:
    return materials.guess(part.rgba)


def _lo(part: Part) -> Any:
    return np.array(part.centre) - part.half


def _hi(part: Part) -> Any:
    return np.array(part.centre) + part.half


def _is_leg(part: Part) -> bool:
    x, y, z = part.half
    return z > 2.5 * max(x, y) and abs(_lo(part)[2]) < 1e-6 and max(x, y) < 0.05 and 0.4 < x / y < 2.5


def _is_handle(draft: Draft, part: Part) -> bool:
    x, y, z = part.half
    ahead = _lo(part)[1] > 0.3 * draft.size[1]
    return bool(part.moves) and ahead and y < 0.03 and min(x, z) < 0.04 and max(x, z) > 2.0 * min(x, z)


def _is_front(draft: Draft, part: Part) -> bool:
    x, y, z = part.half
    near = draft.size[1] / 2 - _hi(part)[1] < 0.06
    return near and 2 * y <= _FRONT_M and min(x, z) > 1.5 * y and x > 0.05 and z > 0.03


def _leg(part: Part) -> Mesh:
    """A leg that tapers towards the floor on the sides that face the middle of the thing."""
    shape = plain.solid(part)
    points = shape.vertices.astype(float)
    share = (points[:, 2] - _lo(part)[2]) / (2 * part.half[2])
    for axis in range(2):
        outer = part.centre[axis] + np.sign(part.centre[axis]) * part.half[axis]
        points[:, axis] = outer + (points[:, axis] - outer) * (0.62 + 0.38 * share)
    return shape._replace(vertices=points.astype(np.float32))


def bar(part: Part) -> Mesh:
    """A round bar on two feet that fills the part; its feet are at the back."""
    lo, hi = _lo(part), _hi(part)
    long = 2 if part.half[2] > part.half[0] else 0
    radius = 0.5 * min(2 * part.half[0], 2 * part.half[2], 0.9 * 2 * part.half[1], 0.022)
    start, end = np.array(part.centre), np.array(part.centre)
    start[long], end[long] = lo[long], hi[long]
    start[1] = end[1] = hi[1] - radius
    rod = sweeps.tube([start, end], radius, 8)
    feet = []
    for share in (0.12, 0.88):
        at = start + share * (end - start)
        feet.append(sweeps.tube([(at[0], lo[1] - 0.002, at[2]), tuple(at)], 0.7 * radius, 6))
    return shaping.merged(rod, *feet)


def _front(draft: Draft, part: Part) -> list[Piece]:
    """A panel in a frame; it gets a handle if the solids have none and there is room for it."""
    lo, hi, coat = _lo(part), _hi(part), _grain(part)
    owned = any(_is_handle(draft, other) and other.moves == part.moves for other in draft.parts if part.moves)
    room = draft.size[1] / 2 - hi[1]
    deep = 2 * part.half[1]
    grip = 0.0 if owned else max(0.0, min(0.014, 0.7 * deep, 0.02) - room)
    face = hi[1] - grip - (0.0 if owned and room > _PROUD_M else _PROUD_M)
    found = [materials.piece(shape, coat, part.moves) for shape in panelled(tuple(lo), (hi[0], face, hi[2]))]
    if not owned:
        shape = _knobs(lo, hi, face + _PROUD_M, draft.size[1] / 2)
        found.append(materials.piece(shape, materials.chrome(c.STEEL), part.moves))
    return found


def panelled(lo: Vec3, hi: Vec3) -> list[Mesh]:
    """A leaf from ``lo`` to ``hi`` with a frame around it that stands out 4 mm to the front."""
    wide = min(0.055, 0.16 * (hi[0] - lo[0]), 0.22 * (hi[2] - lo[2]))
    (x0, y0, z0), (x1, y, z1) = lo, hi
    e = 0.0015  # so that the frames of neighbouring doors do not touch
    y1, a = y + _PROUD_M, min(y, y0 + 0.5 * (y - y0))
    return [
        solids.box((x0, y0, z0), (x1, y, z1), 0.001),
        solids.box((x0 + e, a, z0 + e), (x0 + wide, y1, z1 - e), 0.0),
        solids.box((x1 - wide, a, z0 + e), (x1 - e, y1, z1 - e), 0.0),
        solids.box((x0 + wide, a, z1 - wide), (x1 - wide, y1, z1 - e), 0.0),
        solids.box((x0 + wide, a, z0 + e), (x1 - wide, y1, z0 + wide), 0.0),
    ]


def _knobs(lo: Any, hi: Any, face: float, front: float) -> Mesh:
    """Two knobs in the middle of a broad front, or one in the middle of a narrow front."""
    out = max(0.006, front - face)
    r = min(0.016, 0.2 * float(hi[2] - lo[2]))
    middle, wide = (lo + hi) / 2, float(hi[0] - lo[0])
    places = (-0.27 * wide, 0.27 * wide) if wide > 0.6 else (0.0,)
    profile = [(0.0, -0.002), (0.45 * r, -0.002), (0.45 * r, 0.45 * out), (r, 0.62 * out), (r, 0.85 * out),
        (0.8 * r, out), (0.0, out)]  # fmt: skip
    knob = solids.along(solids.lathe(profile, 12), "y")
    return shaping.merged(*(shaping.moved(knob, middle[0] + x, face, middle[2]) for x in places))


def corners(part: Part) -> tuple[Vec3, Vec3]:
    """The lowest and the highest corner [m] of a part."""
    (x, y, z), (a, b, e) = part.centre, part.half
    return (x - a, y - b, z - e), (x + a, y + b, z + e)


def grip(x: float, y: float, front: float, low: float, high: float) -> Mesh:
    """An upright bar at ``x`` on two feet, from a face at ``y`` to ``front`` and from ``low`` to ``high`` [m]."""
    r = min(0.010, 0.32 * (front - y))
    rod = sweeps.tube([(x, front - r, low), (x, front - r, high)], r, 8)
    feet = [sweeps.tube([(x, y - 0.003, z), (x, front - r, z)], 0.7 * r, 6) for z in (low + 0.03, high - 0.03)]
    return shaping.merged(rod, *feet)
