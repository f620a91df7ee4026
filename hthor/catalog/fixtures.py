"""Parametric fixtures: the fridge with its door, basins, bathroom fixtures and a coffee machine."""

from hthor.catalog.colors import GLASS, GREY, STEEL, WHITE
from hthor.catalog.kind import Form
from hthor.catalog.solids import box, hinge, pillar, rest, rounded
from hthor.types import Part, Rgba, Vec3


def fridge(size: Vec3, *, body: Rgba, inner: Rgba) -> Form:
    """A hollow shell with two shelves behind a door that is hinged at the left front edge, as seen from inside.

    When closed, the door seals the shell; when open, it is turned by `solids.SWING_RAD` and the shelves are accessible.
    """
    w, d, h = size
    t, leaf, grip = min(0.05, 0.1 * w, 0.05 * h), min(0.06, 0.12 * d), min(0.03, 0.06 * d)
    front = d - leaf - grip
    low, board = min(0.15, 0.09 * h), min(0.015, 0.02 * h)
    step = (h - t - low) / 3
    floors = (low, low + step, low + 2 * step)
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, t, h), body),
        box(size, (0.0, t, 0.0), (t, front, h), body),
        box(size, (w - t, t, 0.0), (w, front, h), body),
        box(size, (t, t, 0.0), (w - t, front, low), inner),
        box(size, (t, t, h - t), (w - t, front, h), inner),
        *(box(size, (t, t, z - board), (w - t, 0.92 * front, z), inner) for z in floors[1:]),
        box(size, (0.0, front, 0.0), (w, front + leaf, h), body, moves="door"),
        box(size, (0.9 * w, front + leaf, 0.45 * h), (0.94 * w, d, 0.75 * h), GREY, moves="door"),
    )
    e = min(0.03, 0.05 * w, 0.05 * d)
    rests = tuple(
        rest(size, name, (t + e, t + e), (w - t - e, 0.92 * front - e), z, step - board, inside=True)
        for name, z in zip(("bottom", "lower shelf", "upper shelf"), floors, strict=True)
    )
    return Form(parts=parts, surfaces=rests, joints=(hinge(size, "door", 0.0, front + leaf, left=True),))


def _basin(
    size: Vec3, floor: float, rim: float, side: float, back: float, front: float, rgba: Rgba
) -> tuple[Part, ...]:
    w, d, _ = size
    return (
        box(size, (0.0, 0.0, floor), (w, back, rim), rgba),
        box(size, (0.0, d - front, floor), (w, d, rim), rgba),
        box(size, (0.0, back, floor), (side, d - front, rim), rgba),
        box(size, (w - side, back, floor), (w, d - front, rim), rgba),
    )


def sink(size: Vec3, *, body: Rgba, basin: Rgba) -> Form:
    """A basin in a cabinet, its tap at the back."""
    w, d, h = size
    rim = 0.82 * h
    floor = rim - min(0.18, 0.3 * rim)
    side, back, front = min(0.1, 0.12 * w), min(0.13, 0.2 * d), min(0.06, 0.1 * d)
    spout = 0.02 * h
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, 0.96 * d, floor), body),
        *_basin(size, floor, rim, side, back, front, basin),
        pillar(size, (w / 2, back / 2), min(0.02, 0.2 * back, 0.1 * w), rim, h, STEEL),
        box(size, (0.48 * w, back / 2, h - spout), (0.52 * w, 0.45 * d, h), STEEL),
    )
    room = h - spout - floor
    return Form(parts=parts, surfaces=(rest(size, "basin", (side, back), (w - side, d - front), floor, room),))


def bathtub(size: Vec3, *, body: Rgba) -> Form:
    """A tub with a rim on all sides."""
    w, d, h = size
    rim, floor = min(0.08, 0.1 * w, 0.1 * d), 0.25 * h
    bottom = box(size, (0.0, 0.0, 0.0), (w, d, floor), body)
    parts = (bottom, *_basin(size, floor, h, rim, rim, rim, body))
    return Form(parts=parts, surfaces=(rest(size, "tub", (rim, rim), (w - rim, d - rim), floor),))


def shower(size: Vec3, *, tray: Rgba) -> Form:
    """A tray with glass on two sides and a pipe in the corner, its back and left side against walls."""
    w, d, h = size
    t, low, r = min(0.012, 0.05 * w, 0.05 * d), 0.05 * h, min(0.02, 0.05 * w, 0.05 * d)
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, d, low), tray),
        box(size, (w - t, 0.0, low), (w, d, h), GLASS),
        box(size, (0.0, d - t, low), (0.45 * w, d, h), GLASS),
        pillar(size, (w / 2, 2 * r), r, low, 0.96 * h, STEEL),
        rounded(size, (0.4 * w, r, 0.96 * h), (0.6 * w, r + 0.2 * d, 0.98 * h), STEEL),
    )
    return Form(parts=parts)


def toilet(size: Vec3, *, body: Rgba) -> Form:
    """A bowl with its lid down, the tank at the back."""
    w, d, h = size
    tank, seat = 0.28 * d, 0.5 * h
    parts = (
        box(size, (0.0, 0.0, 0.45 * h), (w, tank, h), body),
        box(size, (0.25 * w, 0.0, 0.0), (0.75 * w, 0.75 * d, 0.45 * h), body),
        box(size, (0.1 * w, tank, 0.3 * h), (0.9 * w, d, seat), body),
        box(size, (0.08 * w, tank, seat), (0.92 * w, d, seat + 0.03 * h), WHITE),
    )
    return Form(parts=parts)


def coffee_machine(size: Vec3, *, body: Rgba) -> Form:
    """A tank at the back, a brewing head over a foot, and a jug between head and foot."""
    w, d, h = size
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, 0.45 * d, h), body),
        box(size, (0.0, 0.45 * d, 0.0), (w, d, 0.1 * h), body),
        box(size, (0.0, 0.45 * d, 0.72 * h), (w, d, h), body),
        pillar(size, (w / 2, 0.72 * d), 0.26 * min(w, d), 0.1 * h, 0.55 * h, GLASS),
    )
    return Form(parts=parts)
