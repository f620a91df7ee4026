"""Parts of a house: door leaves and ceiling lamps.

Every function returns pieces in a local frame: x is along the wall, with 0 in the middle of the opening; y is across
the wall, with 0 in the middle of its thickness and the viewer's room towards +y; z is up from the floor (for windows,
from the lower edge). All lengths are in metres.
"""

import math

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.meshes import solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece
from hthor.types import Rgba

TRIM: Rgba = (0.94, 0.93, 0.91, 1.0)
"""The color of doors and their frames."""
LEAF_M = 0.04
"""Thickness of a door leaf [m]."""
_TRIM = materials.paint(TRIM, 0.3)


def _plain(*shapes: Mesh, of: Material = _TRIM) -> list[Piece]:
    return [materials.piece(shape, of) for shape in shapes]


def door_leaf(width: float, height: float, rgba: Rgba = TRIM, panels: int = 2) -> list[Piece]:
    """A leaf ``LEAF_M`` thick, x from -width/2 (hinges) to width/2, z from 0 to ``height``; a lever on both sides.

    It has ``panels`` sunken panels, one above the other, in a raised frame. A wooden ``rgba`` shows its grain.
    """
    x, y, stile = width / 2, LEAF_M / 2, min(0.11, 0.16 * width)
    coat = materials.wood(rgba) if materials.wooden(rgba) else materials.paint(rgba, 0.3)
    rail = (height - stile * (panels + 2)) / panels
    bars = [solids.box((a, -y, 0.0), (b, y, height), 0.003) for a, b in ((-x, stile - x), (x - stile, x))]
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
        near, far = sorted((side * y, side * (y + 0.006)))
        shapes.append(solids.box((x - 0.018, near, z - 0.08), (x + 0.018, far, z + 0.08), 0.002))
        path = sweeps.bend(
            (x, side * y, z + 0.02), (x, side * (y + 0.05), z + 0.02), (x - 0.11, side * (y + 0.05), z + 0.02)
        )
        shapes.append(sweeps.tube(path, 0.008))
    return _plain(*shapes, of=materials.chrome())


def ceiling_lamp(radius: float = 0.19) -> list[Piece]:
    """A flat, lit glass bowl under a ceiling: z from 0 (the ceiling) down to about -radius/2."""
    bowl = [(0.0, -0.5 * radius)] + [
        (radius * math.sin(a), -0.5 * radius * math.cos(a)) for a in (math.pi / 2 * k / 6 for k in range(1, 7))
    ]
    rim = [(0.0, -0.014), (1.05 * radius, -0.014), (1.05 * radius, 0.0), (0.0, 0.0)]
    return [
        *_plain(solids.lathe(bowl, 24), of=materials.glow((1.0, 0.96, 0.88, 1.0), 0.9)),
        *_plain(solids.lathe(rim, 24), of=materials.metal(c.STEEL)),
    ]
