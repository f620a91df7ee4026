"""A packed trunk that two people carry together."""

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import solids, sweeps
from hthor.looks.meshes.mesh import Mesh, Piece

_RIM = 0.7
"""Height at which the lid begins, as a share of the whole height."""


def trunk(draft: Draft) -> list[Piece]:
    """A canvas chest with a raised lid, wooden battens, brass corners, two leather straps and a handle at each end."""
    w, d, h = draft.size
    x, y, low = 0.46 * w, 0.47 * d, 0.03 * h
    body = solids.box((-x, -y, low), (x, y, _RIM * h), 0.012)
    lid = solids.box((-x - 0.006, -y - 0.006, (_RIM + 0.008) * h), (x + 0.006, y + 0.006, 0.965 * h), 0.03, 2)
    wood, brass = materials.wood(c.OAK), materials.metal((0.80, 0.62, 0.30, 1.0))
    leather, canvas = materials.leather(draft.colors()[-1]), materials.cloth(draft.color(0), "canvas")
    return [
        materials.piece(body, canvas),
        materials.piece(lid, canvas),
        *(materials.piece(one, wood) for one in _battens(draft, x, y)),
        *(materials.piece(one, brass) for one in (*_corners(h, x, y, low), *_lock(h, y))),
        *(materials.piece(one, leather) for one in (*_straps(draft, y), *_handles(draft, x))),
    ]


def _battens(draft: Draft, x: float, y: float) -> list[Mesh]:
    """Slats around the foot and the rim, and along the lid."""
    h, t = draft.size[2], 0.008
    found = [
        solids.box((-x - t, -y - t, z * h), (x + t, y + t, (z + tall) * h), 0.004)
        for z, tall in ((0.0, 0.07), (0.62, 0.06), (_RIM + 0.012, 0.055))
    ]
    return found + [
        solids.box((-x - 0.004, v * y - 0.022, 0.955 * h), (x + 0.004, v * y + 0.022, 0.985 * h), 0.004)
        for v in (-0.62, 0.0, 0.62)
    ]


def _corners(h: float, x: float, y: float, low: float) -> list[Mesh]:
    """Caps on the corners of body and lid."""
    a, t = 0.035, 0.011
    spans = ((low - 0.01, low + 2 * a), ((_RIM + 0.01) * h, (_RIM + 0.13) * h), (0.88 * h, 0.972 * h))
    sides = [(sorted((s * (x + t), s * (x - a))), sorted((v * (y + t), v * (y - a)))) for s in (-1, 1) for v in (-1, 1)]
    return [
        solids.box((west, south, bottom), (east, north, top), 0.0, 0)
        for (west, east), (south, north) in sides
        for bottom, top in spans
    ]


def _lock(h: float, y: float) -> list[Mesh]:
    plate = solids.box((-0.035, y, 0.56 * h), (0.035, y + 0.016, 0.80 * h), 0.006)
    return [plate, solids.cylinder((0.0, y + 0.014, 0.64 * h), 0.012, 0.012, "y", 14)]


def _straps(draft: Draft, y: float) -> list[Mesh]:
    """Two belts that go all the way around."""
    w, _, h = draft.size
    return [
        solids.box((s * 0.27 * w - 0.024, -y - 0.012, 0.0), (s * 0.27 * w + 0.024, y + 0.012, h), 0.008)
        for s in (-1.0, 1.0)
    ]


def _handles(draft: Draft, x: float) -> list[Mesh]:
    """A bow at each end."""
    w, d, h = draft.size
    r, a, z = 0.011, 0.15 * d, 0.54 * h
    out = w / 2 - r
    return [
        sweeps.tube(
            sweeps.bend((s * x, -a, z), (s * out, -0.7 * a, z), (s * out, 0.7 * a, z), (s * x, a, z), steps=3), r, 8
        )
        for s in (-1.0, 1.0)
    ]
