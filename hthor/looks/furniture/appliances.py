"""Stoves, microwave ovens and other machines with a window in their door, such as washers and safes; range hoods."""

import numpy as np

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.furniture import fronts, plain
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Piece
from hthor.types import Part


def stove(draft: Draft) -> list[Piece]:
    """The catalogue's solids with a hob of four rings on top, knobs over the door, and a window in the door."""
    w, d, h = draft.size
    found = _machine(draft)
    found.append(materials.piece(sweeps.lying((0.0, 0.0, h + 0.0008), 0.97 * w, 0.96 * d), materials.picture("hob")))
    moving = [part for part in draft.parts if part.moves]
    top = max((fronts.corners(part)[1][2] for part in moving), default=0.8 * h)
    above = (part for part in draft.parts if not part.moves and part.half[2] < 0.2 * h and part.centre[2] > top)
    face = min(max((fronts.corners(part)[1][1] for part in above), default=d / 2), d / 2 - 0.012)
    for k in range(4):
        at = (k - 1.5) * 0.2 * w
        knob = solids.cylinder((at, face + 0.006, (top + h) / 2 - 0.008), 0.017, 0.018, "y", 14)
        found.append(materials.piece(knob, materials.paint(c.BLACK, 0.4)))
    return found


def microwave(draft: Draft) -> list[Piece]:
    """The catalogue's solids with a window, keys and a display."""
    d = draft.size[1]
    found = _machine(draft)
    still = [part for part in draft.parts if not part.moves and part.half[1] < 0.05 * d]
    if still:
        panel = max(still, key=lambda part: fronts.corners(part)[1][1])
        (x0, _, z0), (x1, y1, z1) = fronts.corners(panel)
        middle, wide, tall = (x0 + x1) / 2, 0.8 * (x1 - x0), z1 - z0
        keys = sweeps.panel((middle, y1 + 0.0008, z0 + 0.36 * tall), wide, 0.5 * tall)
        show = sweeps.panel((middle, y1 + 0.0008, z0 + 0.80 * tall), wide, 0.18 * tall)
        found += [
            materials.piece(keys, materials.picture("keypad")),
            materials.piece(show, materials.picture("digits", 0.5)),
        ]
    return found


def _machine(draft: Draft) -> list[Piece]:
    """A machine with a flat door: a broad door gets a dark window in a frame, a narrow moving part becomes a handle."""
    found = []
    for part in draft.parts:
        broad = part.moves and min(part.half[0], part.half[2]) > 0.08
        if part.moves and not broad:
            found.append(materials.piece(fronts.bar(part), materials.chrome(), part.moves))
        elif broad:
            found += _windowed(draft, part)
        else:
            found.append(plain.piece(part))
    return found


def _windowed(draft: Draft, part: Part) -> list[Piece]:
    (x0, y0, z0), (x1, y1, z1) = fronts.corners(part)
    room, proud = draft.size[1] / 2 - y1, 0.004
    face = y1 if room > 0.006 else y1 - 0.016
    e = 0.14 * min(x1 - x0, z1 - z0)
    frame = solids.box((x0, y0, z0), (x1, face, z1), 0.006)
    pane = solids.box((x0 + e, face - 0.004, z0 + e), (x1 - e, face + 0.5 * proud, z1 - e), 0.002)
    body = materials.metal(c.STEEL) if draft.color(0) != c.WHITE else materials.paint(c.WHITE, 0.5)
    glass = materials.paint(c.BLACK, 0.8)
    if draft.name == "safe":
        body, glass = materials.paint(part.rgba, 0.3), materials.paint(c.GREY, 0.3)
    found = [materials.piece(frame, body, part.moves), materials.piece(pane, glass, part.moves)]
    if room <= 0.006:
        handle = fronts.grip(x1 - 0.35 * e, face, y1, z0 + 0.2 * (z1 - z0), z1 - 0.2 * (z1 - z0))
        found.append(materials.piece(handle, materials.chrome(), part.moves))
    return found


def washer(draft: Draft) -> list[Piece]:
    """A front loader: a round window in its door, a dial and a drawer above it."""
    w, d, h = draft.size
    found = []
    for part in draft.parts:
        if part.moves:
            (x0, y0, z0), (x1, y1, z1) = fronts.corners(part)
            middle, high, r = (x0 + x1) / 2, (z0 + z1) / 2, 0.44 * min(x1 - x0, z1 - z0)
            face = y1 - 0.014
            door = [
                (solids.box((x0, y0, z0), (x1, face, z1), 0.004), materials.paint(c.WHITE, 0.5)),
                (sweeps.ring((middle, face, high), r * 0.86, min(0.0139, 0.12 * r), "y", 28, 8), materials.chrome()),
                (
                    solids.cylinder((middle, face + 0.003, high), 0.80 * r, 0.008, "y", 28),
                    materials.paint((0.10, 0.12, 0.15, 1.0), 0.9),
                ),
            ]
            found += [materials.piece(shape, coat, part.moves) for shape, coat in door]
        else:
            found.append(plain.piece(part, materials.paint(part.rgba, 0.5)))
    face = d / 2 - 0.012
    dial = solids.cylinder((-0.28 * w, face + 0.004, 0.90 * h), 0.028, 0.014, "y", 18)
    show = sweeps.panel((-0.02 * w, face + 0.0022, 0.90 * h), 0.16 * w, 0.05 * h)
    box = solids.box((0.16 * w, face - 0.004, 0.865 * h), (0.44 * w, face + 0.006, 0.935 * h), 0.003)
    return [
        *found,
        materials.piece(dial, materials.chrome()),
        materials.piece(show, materials.picture("digits", 0.5)),
        materials.piece(box, materials.paint(c.WHITE, 0.5)),
    ]


def range_hood(draft: Draft) -> list[Piece]:
    """A chimney over a sloped hood with a row of keys."""
    w, d, h = draft.size
    x, y, low, mid = w / 2, d / 2, 0.09 * h, 0.42 * h
    half = min(0.16, 0.3 * w)
    rings = [((-x, -y), (x, y), low), ((-half, -y), (half, min(y, 2 * half - y)), mid)]
    loops = [
        np.array([(b[0], a[1], z), (b[0], b[1], z), (a[0], b[1], z), (a[0], a[1], z), (b[0], a[1], z)])
        for a, b, z in rings
    ]
    walls = [shaping.surface(np.stack([[loops[0][k], loops[1][k]], [loops[0][k + 1], loops[1][k + 1]]]),
        np.array([[(0.0, 0.0), (0.0, 0.4)], [(0.6, 0.0), (0.6, 0.4)]])) for k in range(4) ]  # fmt: skip
    steel = materials.metal(draft.color(0))
    shapes = [
        solids.box((-x, -y, 0.0), (x, y, low), 0.006),
        solids.box((-half, -y, mid - 0.002), (half, min(y, 2 * half - y), h), 0.004),
        *walls,
    ]
    keys = [solids.cylinder(((k - 1.5) * 0.05, y - 0.001, 0.5 * low), 0.008, 0.004, "y", 10) for k in range(4)]
    found = [materials.piece(shape, steel) for shape in shapes]
    found += [materials.piece(key, materials.paint(c.BLACK, 0.4)) for key in keys]
    return found
