"""Lamps, candles, and other things on a pole: floor lamps, vacuum cleaners, brushes."""

from hthor.catalog import colors as c
from hthor.looks import materials
from hthor.looks.draft import Draft
from hthor.looks.meshes import shaping, solids, sweeps
from hthor.looks.meshes.mesh import Material, Mesh, Piece

_BULB = materials.glow((1.0, 0.95, 0.8, 1.0), 1.0)


def _shade(low_r: float, top_r: float, low: float, high: float) -> Mesh:
    """An open cone that is also visible from inside."""
    t = 0.003
    profile = [(low_r - t, low), (low_r, low), (top_r, high), (top_r - t, high), (low_r - t, low)]
    return solids.lathe(profile, 28)


def table_lamp(draft: Draft) -> list[Piece]:
    """A bellied ceramic foot, a stem and a lit cloth shade."""
    w, d, h = draft.size
    r, low = min(w, d) / 2, 0.52 * h
    belly = [(0.0, 0.0), (0.44, 0.0), (0.46, 0.02), (0.36, 0.05), (0.54, 0.16), (0.58, 0.24), (0.46, 0.34),
        (0.20, 0.40), (0.12, 0.42), (0.12, 0.46), (0.0, 0.46)]  # fmt: skip
    shade = Material(rgba=draft.colors()[-1], texture="linen", emission=0.55, specular=0.0)
    return [
        materials.piece(solids.lathe(belly, 24, (r, h)), materials.ceramic(c.TEAL)),
        materials.piece(solids.cylinder((0.0, 0.0, 0.52 * h), 0.008, 0.14 * h, "z", 8), materials.metal(c.STEEL)),
        materials.piece(_shade(r, 0.66 * r, low, h), shade),
        materials.piece(solids.ball((0.0, 0.0, 0.66 * h), (0.22 * r, 0.22 * r, 0.07 * h), 12), _BULB),
    ]


def floor_lamp(draft: Draft) -> list[Piece]:
    """A round foot, a slim pole and a lit, drum-shaped shade."""
    w, d, h = draft.size
    r, low = min(w, d) / 2, 0.80 * h
    foot = [(0.0, 0.0), (0.60, 0.0), (0.62, 0.008), (0.56, 0.020), (0.12, 0.030), (0.06, 0.05), (0.0, 0.05)]
    pole = solids.cylinder((0.0, 0.0, 0.5 * low), 0.011, low, "z", 12)
    shade = Material(rgba=draft.colors()[-1], texture="linen", emission=0.55, specular=0.0)
    iron = materials.metal(draft.color(0))
    return [
        materials.piece(solids.lathe(foot, 28, (r, 1.0)), iron),
        materials.piece(pole, iron),
        materials.piece(_shade(r, 0.80 * r, low, h), shade),
        materials.piece(solids.ball((0.0, 0.0, 0.88 * h), (0.2 * r, 0.2 * r, 0.03 * h), 12), _BULB),
    ]


def candle(draft: Draft) -> list[Piece]:
    """A thick wax candle with a wick."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    wax = [(0.0, 0.0), (0.96, 0.0), (1.0, 0.03), (1.0, 0.86), (0.94, 0.90), (0.7, 0.88), (0.0, 0.85)]
    wick = sweeps.tube([(0.0, 0.0, 0.84 * h), (0.0, 0.0, 0.93 * h), (0.06 * r, 0.0, h)], 0.04 * r, 6)
    return [
        materials.piece(solids.lathe(wax, 20, (r, h)), Material(rgba=draft.color(0), emission=0.12, specular=0.3)),
        materials.piece(wick, materials.paint(c.BLACK, 0.0)),
    ]


def vacuum_cleaner(draft: Draft) -> list[Piece]:
    """An upright vacuum cleaner: a broad nozzle, a body with a dust bin, and a slim handle."""
    w, d, h = draft.size
    x, y = w / 2, d / 2
    coat, dark = materials.paint(draft.colors()[-1], 0.5), materials.paint(c.IRON, 0.4)
    knots = ((-0.12, 0.48), (-0.30, 0.80), (-0.42, 0.97), (-0.22, 0.99))
    path = sweeps.bend(*((0.0, back * d, up * h) for back, up in knots), steps=4)
    bin_ = [(0.0, 0.0), (0.26 * w, 0.0), (0.27 * w, 0.02), (0.27 * w, 0.24 * h), (0.22 * w, 0.27 * h), (0.0, 0.27 * h)]
    body = shaping.turned(solids.box((-0.24 * w, -0.16 * d, 0.0), (0.24 * w, 0.10 * d, 0.42 * h), 0.03, 2), "x", 0.10)
    return [
        materials.piece(solids.box((-x, 0.0, 0.008), (x, y, 0.065 * h), 0.02, 2), coat),
        materials.piece(solids.box((-0.96 * x, 0.02, 0.0), (0.96 * x, y - 0.01, 0.014), 0.002), dark),
        materials.piece(shaping.moved(body, 0.0, 0.04 * d, 0.05 * h), coat),
        materials.piece(
            shaping.moved(solids.lathe(bin_, 20), 0.0, 0.14 * d, 0.13 * h),
            Material(rgba=(0.45, 0.5, 0.55, 0.6), specular=0.8),
        ),
        materials.piece(sweeps.tube(path, 0.014, 10), dark),
        *(
            materials.piece(solids.cylinder((s * 0.42 * w, -0.02, 0.05 * h), 0.05 * h, 0.02, "x", 16), dark)
            for s in (-1, 1)
        ),
    ]


def brush(draft: Draft) -> list[Piece]:
    """A toilet brush in its holder."""
    r, h = min(draft.size[:2]) / 2, draft.size[2]
    holder = [(0.0, 0.0), (0.9, 0.0), (1.0, 0.03), (0.92, 0.34), (0.84, 0.36), (0.80, 0.34), (0.0, 0.30)]
    white = materials.ceramic(draft.color(0))
    return [
        materials.piece(solids.lathe(holder, 24, (r, h)), white),
        materials.piece(solids.cylinder((0.0, 0.0, 0.64 * h), 0.011, 0.72 * h, "z", 10), materials.chrome()),
    ]
