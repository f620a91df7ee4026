"""What is built into a house: door leaves and frames, windows, baseboards, rods, ceiling lamps.

Every function returns pieces in one local frame: x runs along the wall with 0 in the middle of the opening, y is across
the wall with 0 in the middle of its thickness and the room that is looked from towards +y, z is up from the floor (from
the lower edge, for windows). All measures are in metres.
"""

from __future__ import annotations

import math

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.meshes import solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Rgba

TRIM: Rgba = (0.94, 0.93, 0.91, 1.0)
"""The colour of frames and baseboards."""
LEAF_M = 0.04
"""How thick a door leaf is."""
CASING_M = 0.06
"""How broad the trim around an opening is."""
BASEBOARD_M = 0.09
"""How high a baseboard is."""
_PROUD_M = 0.012
_TRIM = materials.paint(TRIM, 0.3)


def _plain(*shapes: Mesh, of: Material = _TRIM) -> list[Piece]:
    return [materials.piece(shape, of) for shape in shapes]


def door_leaf(width: float, height: float, rgba: Rgba = TRIM, panels: int = 2) -> list[Piece]:
    """A leaf ``LEAF_M`` thick, x from -width/2 (its hinges) to width/2, z from 0 to ``height``; a lever on both sides.

    Stiles and rails stand proud of ``panels`` sunken panels, one above the other. A wooden ``rgba`` shows its grain.
    """
    x, y, stile = width / 2, LEAF_M / 2, min(0.11, 0.16 * width)
    coat = materials.wood(rgba) if materials.wooden(rgba) else materials.paint(rgba, 0.3)
    rail = (height - stile * (panels + 2)) / panels
    bars = [
        solids.box(
            (s * x, -y, 0.0) if s < 0 else (x - stile, -y, 0.0),
            (stile - x, y, height) if s < 0 else (x, y, height),
            0.003,
        )
        for s in (-1, 1)
    ]
    z = 0.0
    for index in range(panels + 1):
        tall = 2 * stile if index == 0 else stile
        bars.append(solids.box((stile - x, -y, z), (x - stile, y, z + tall), 0.003))
        if index < panels:
            low, high = z + tall, z + tall + rail
            bars.append(solids.box((stile - x, -0.4 * y, low), (x - stile, 0.4 * y, high), 0.002))
            e = min(0.04, 0.1 * width)
            bars.append(solids.box((stile - x + e, -0.75 * y, low + e), (x - stile - e, 0.75 * y, high - e), 0.008))
        z += tall + rail
    return [*_plain(*bars, of=coat), *_levers(x - 0.5 * stile, min(1.05, 0.5 * height))]


def _levers(x: float, z: float) -> list[Piece]:
    y, shapes = LEAF_M / 2, []
    for side in (-1, 1):
        shapes.append(solids.box((x - 0.018, min(side * y, side * (y + 0.006)), z - 0.08),
            (x + 0.018, max(side * y, side * (y + 0.006)), z + 0.08), 0.002))  # fmt: skip
        path = sweeps.bend(
            (x, side * y, z + 0.02), (x, side * (y + 0.05), z + 0.02), (x - 0.11, side * (y + 0.05), z + 0.02)
        )
        shapes.append(sweeps.tube(path, 0.008))
    return _plain(*shapes, of=materials.chrome())


def door_frame(width: float, height: float, depth: float, rgba: Rgba = TRIM) -> list[Piece]:
    """Lining and trim of a clear opening ``width`` by ``height`` through a wall ``depth`` thick.

    The lining takes 1.2 cm inside the opening; the trim lies `CASING_M` broad around it, 1.2 cm proud of both faces.
    """
    x, y, t, e, b = width / 2, depth / 2 + _PROUD_M, 0.012, CASING_M, 0.003
    coat = materials.wood(rgba) if materials.wooden(rgba) else materials.paint(rgba, 0.3)
    shapes = [
        solids.box((-x, -y, 0.0), (t - x, y, height), b),
        solids.box((x - t, -y, 0.0), (x, y, height), b),
        solids.box((-x, -y, height - t), (x, y, height), b),
    ]
    for low, high in ((depth / 2 - 0.001, y), (-y, 0.001 - depth / 2)):
        shapes += [
            solids.box((-x - e, low, 0.0), (-x, high, height + e), b),
            solids.box((x, low, 0.0), (x + e, high, height + e), b),
            solids.box((-x, low, height), (x, high, height + e), b),
        ]
    return _plain(*shapes, of=coat)


def window_frame(width: float, height: float, depth: float, columns: int = 0, rows: int = 0) -> list[Piece]:
    """Lining, trim, sash, mullions, pane and sill of a window in a wall ``depth`` thick; z from 0 to ``height``.

    ``columns`` and ``rows`` of panes default to what suits the size. The sill juts 8 cm into the room (+y).
    """
    across, up = columns or max(1, round(width / 0.75)), rows or (2 if height > 1.0 else 1)
    x, y, e, b, s = width / 2, depth / 2 + _PROUD_M, CASING_M, 0.003, 0.045
    shapes = []
    for lo, hi in (((-x, -y, 0.0), (0.012 - x, y, height)), ((x - 0.012, -y, 0.0), (x, y, height)),
        ((-x, -y, height - 0.012), (x, y, height)), ((-x, -y, 0.0), (x, y, 0.012))):  # fmt: skip
        shapes.append(solids.box(lo, hi, b))
    for low, high in ((depth / 2 - 0.001, y), (-y, 0.001 - depth / 2)):
        for lo, hi in (((-x - e, low, -e), (-x, high, height + e)), ((x, low, -e), (x + e, high, height + e)),
            ((-x, low, height), (x, high, height + e)), ((-x, low, -e), (x, high, 0.0))):  # fmt: skip
            shapes.append(solids.box(lo, hi, b))
    for lo, hi in (((-x, -0.02, 0.0), (s - x, 0.02, height)), ((x - s, -0.02, 0.0), (x, 0.02, height)),
        ((-x, -0.02, 0.0), (x, 0.02, s)), ((-x, -0.02, height - s), (x, 0.02, height))):  # fmt: skip
        shapes.append(solids.box(lo, hi, b))
    for k in range(1, across):
        at = -x + width * k / across
        shapes.append(solids.box((at - 0.014, -0.016, s), (at + 0.014, 0.016, height - s), b))
    for k in range(1, up):
        at = height * k / up
        shapes.append(solids.box((s - x, -0.016, at - 0.014), (x - s, 0.016, at + 0.014), b))
    shapes.append(solids.box((-x - e - 0.02, depth / 2, -0.035), (x + e + 0.02, depth / 2 + 0.08, 0.0), 0.006))
    pane = solids.box((s - x, -0.003, s), (x - s, 0.003, height - s), 0.0, 0)
    return [*_plain(*shapes), *_plain(pane, of=materials.glass((0.80, 0.90, 0.95, 0.16)))]


def baseboard(length: float, rgba: Rgba = TRIM) -> list[Piece]:
    """A board along a wall: x from -length/2 to length/2, its back at y = 0, z from 0 to `BASEBOARD_M`."""
    x, t, h = length / 2, _PROUD_M, BASEBOARD_M
    outline = ((0.0, 0.0), (t, 0.0), (t, 0.75 * h), (0.7 * t, 0.84 * h), (0.45 * t, 0.9 * h), (0.4 * t, h), (0.0, h))
    return _plain(_board(outline, x), of=materials.paint(rgba, 0.3))


def _board(outline: tuple[tuple[float, float], ...], x: float) -> Mesh:
    """A profile in y and z, drawn out along x from -x to x."""
    prism = sweeps.extruded(outline, -x, x)
    swap = [2, 0, 1]
    return prism._replace(vertices=prism.vertices[:, swap], normals=prism.normals[:, swap])


def curtain_rod(length: float) -> list[Piece]:
    """A rod with knobs at its ends and two brackets: x from -length/2, its axis 8 cm in front of y = 0, at z = 0."""
    x, y = length / 2, 0.08
    shapes = [solids.cylinder((0.0, y, 0.0), 0.011, length - 0.05, "x", 10)]
    for side in (-1.0, 1.0):
        shapes.append(solids.ball((side * (x - 0.025), y, 0.0), (0.025, 0.025, 0.025), 12))
        shapes.append(solids.box((side * (x - 0.12) - 0.008, 0.0, -0.02), (side * (x - 0.12) + 0.008, y, 0.01), 0.003))
    return _plain(*shapes, of=materials.metal(c.IRON))


def threshold(width: float, depth: float, rgba: Rgba = c.OAK) -> list[Piece]:
    """A flat strip across a doorway's floor, 6 mm high."""
    shape = solids.box((-width / 2, -depth / 2, 0.0), (width / 2, depth / 2, 0.006), 0.003)
    return _plain(shape, of=materials.wood(rgba))


def ceiling_lamp(radius: float = 0.19) -> list[Piece]:
    """A flat glass bowl under a ceiling: z from 0 (the ceiling) down to about -radius/2, lit."""
    bowl = [(0.0, -0.5 * radius)] + [
        (radius * math.sin(a), -0.5 * radius * math.cos(a)) for a in (math.pi / 2 * k / 6 for k in range(1, 7))
    ]
    rim = [(0.0, -0.014), (1.05 * radius, -0.014), (1.05 * radius, 0.0), (0.0, 0.0)]
    return [
        *_plain(solids.lathe(bowl, 24), of=materials.glow((1.0, 0.96, 0.88, 1.0), 0.9)),
        *_plain(solids.lathe(rim, 24), of=materials.metal(c.STEEL)),
    ]
