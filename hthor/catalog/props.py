"""Parametric small things with few parts, and things that hang on walls."""

from hthor.catalog.kind import Form
from hthor.catalog.solids import box, pillar, rest, rounded
from hthor.types import Part, Rgba, Vec3

ZERO = (0.0, 0.0, 0.0)


def block(size: Vec3, *, rgba: Rgba) -> Form:
    """One box."""
    return Form(parts=(box(size, ZERO, size, rgba),))


def ball(size: Vec3, *, rgba: Rgba) -> Form:
    """One sphere, or the roundest possible solid of this size."""
    return Form(parts=(rounded(size, ZERO, size, rgba),))


def stack(size: Vec3, *, low: Rgba, high: Rgba, split: float, narrow: float) -> Form:
    """A foot up to the share ``split`` of the height, with the share ``narrow`` of the width; full width above it."""
    w, d, h = size
    a, b = (1 - narrow) / 2, (1 + narrow) / 2
    foot = rounded(size, (a * w, a * d, 0.0), (b * w, b * d, split * h), low)
    return Form(parts=(foot, rounded(size, (0.0, 0.0, split * h), size, high)))


def plate(size: Vec3, *, glaze: Rgba) -> Form:
    """A flat dish on a foot, with room for a small object on it."""
    w, d, h = size
    form = stack(size, low=glaze, high=glaze, split=0.5, narrow=0.7)
    return Form(parts=form.parts, surfaces=(rest(size, "dish", (0.15 * w, 0.15 * d), (0.85 * w, 0.85 * d), h),))


def bottle(size: Vec3, *, glass: Rgba, cap: Rgba) -> Form:
    """A body with a neck and a cap."""
    w, d, h = size
    neck, at = 0.16 * min(w, d), (w / 2, d / 2)
    parts = (
        rounded(size, ZERO, (w, d, 0.68 * h), glass),
        pillar(size, at, neck, 0.68 * h, 0.92 * h, glass),
        pillar(size, at, 1.15 * neck, 0.92 * h, h, cap),
    )
    return Form(parts=parts)


def mug(size: Vec3, *, glaze: Rgba) -> Form:
    """A cup with its handle to the right; a cup without a handle if there is no room for one."""
    w, d, h = size
    if w <= 1.05 * d:
        return ball(size, rgba=glaze)
    cup = rounded(size, ZERO, (d, d, h), glaze)
    return Form(parts=(cup, box(size, (d, 0.42 * d, 0.2 * h), (w, 0.58 * d, 0.8 * h), glaze)))


def pan(size: Vec3, *, metal: Rgba, handle: Rgba) -> Form:
    """A round body with its handle to the front."""
    w, d, h = size
    if d <= 1.05 * w:
        return ball(size, rgba=metal)
    body = rounded(size, ZERO, (w, w, h), metal)
    return Form(parts=(body, box(size, (0.44 * w, w, 0.6 * h), (0.56 * w, d, 0.9 * h), handle)))


def book(size: Vec3, *, cover: Rgba, pages: Rgba) -> Form:
    """A closed book lying flat, whose pages project from the cover on three sides; no part of it is thin."""
    w, d, h = size
    parts = (
        box(size, (0.0, 0.01 * d, 0.0), (0.98 * w, 0.99 * d, h), cover),
        box(size, (0.02 * w, 0.0, 0.15 * h), (w, d, 0.85 * h), pages),
    )
    return Form(parts=parts)


def remote_control(size: Vec3, *, body: Rgba, key: Rgba) -> Form:
    """A flat stick with a power key and a field of keys."""
    w, d, h = size
    parts = (
        box(size, ZERO, (w, d, 0.85 * h), body),
        box(size, (0.35 * w, 0.85 * d, 0.85 * h), (0.65 * w, 0.93 * d, h), key),
        box(size, (0.2 * w, 0.2 * d, 0.85 * h), (0.8 * w, 0.75 * d, 0.95 * h), (0.55, 0.56, 0.58, 1.0)),
    )
    return Form(parts=parts)


def cushion(size: Vec3, *, fabric: Rgba) -> Form:
    """A flat square cushion that is thickest in the middle."""
    w, d, h = size
    middle = box(size, (0.1 * w, 0.1 * d, 0.0), (0.9 * w, 0.9 * d, h), fabric)
    return Form(parts=(middle, box(size, (0.0, 0.0, 0.2 * h), (w, d, 0.7 * h), fabric)))


def loaf(size: Vec3, *, crust: Rgba) -> Form:
    """A loaf with rounded shoulders."""
    w, d, h = size
    top = box(size, (0.1 * w, 0.04 * d, 0.6 * h), (0.9 * w, 0.96 * d, h), crust)
    return Form(parts=(box(size, ZERO, (w, d, 0.6 * h), crust), top))


def laptop(size: Vec3, *, body: Rgba, screen: Rgba) -> Form:
    """A keyboard with an upright screen at its back."""
    w, d, h = size
    t, lid = 0.1 * h, min(0.012, 0.1 * d)
    parts = (
        box(size, ZERO, (w, d, t), body),
        box(size, (0.0, 0.0, t), (w, lid, h), body),
        box(size, (0.03 * w, lid, 1.5 * t), (0.97 * w, 1.2 * lid, 0.97 * h), screen),
    )
    return Form(parts=parts)


def television(size: Vec3, *, body: Rgba, screen: Rgba) -> Form:
    """A flat screen on a foot."""
    w, d, h = size
    foot, neck = 0.04 * h, 0.1 * h
    back, front = 0.38 * d, 0.58 * d
    parts = (
        box(size, (0.25 * w, 0.0, 0.0), (0.75 * w, d, foot), body),
        box(size, (0.45 * w, back, foot), (0.55 * w, front, neck), body),
        box(size, (0.0, back, neck), (w, front, h), body),
        box(size, (0.015 * w, front, neck + 0.015 * w), (0.985 * w, 0.6 * d, h - 0.015 * h), screen),
    )
    return Form(parts=parts)


def lamp(size: Vec3, *, metal: Rgba, shade: Rgba, hood: float) -> Form:
    """A foot, a pole and a shade; the shade is the upper share ``hood`` of the height."""
    w, d, h = size
    at, r = (w / 2, d / 2), min(0.015, 0.1 * w, 0.1 * d)
    low = (1 - hood) * h
    parts = (
        pillar(size, at, 0.3 * min(w, d), 0.0, 0.03 * h, metal),
        pillar(size, at, r, 0.03 * h, low, metal),
        rounded(size, (0.0, 0.0, low), size, shade),
    )
    return Form(parts=parts)


def plant(size: Vec3, *, pot: Rgba, leaf: Rgba) -> Form:
    """A pot, a stem and a head of leaves."""
    w, d, h = size
    at, r = (w / 2, d / 2), min(w, d)
    parts = (
        pillar(size, at, 0.3 * r, 0.0, 0.35 * h, pot),
        pillar(size, at, 0.04 * r, 0.35 * h, 0.55 * h, leaf),
        rounded(size, (0.0, 0.0, 0.55 * h), size, leaf),
        rounded(size, (0.15 * w, 0.15 * d, 0.42 * h), (0.85 * w, 0.85 * d, 0.55 * h), leaf),
    )
    return Form(parts=parts)


def painting(size: Vec3, *, frame: Rgba, sky: Rgba, land: Rgba) -> Form:
    """A framed landscape."""
    w, d, h = size
    x, y, z = 0.07 * w, 0.8 * d, 0.07 * h
    parts = (
        box(size, ZERO, (w, y, h), frame),
        box(size, (x, y, z), (w - x, d, 0.45 * h), land),
        box(size, (x, y, 0.45 * h), (w - x, d, h - z), sky),
    )
    return Form(parts=parts)


def mirror(size: Vec3, *, frame: Rgba, glass: Rgba) -> Form:
    """A pane in a frame."""
    w, d, h = size
    x, z = 0.06 * min(w, h), 0.06 * min(w, h)
    parts = (box(size, ZERO, (w, 0.7 * d, h), frame), box(size, (x, 0.7 * d, z), (w - x, d, h - z), glass))
    return Form(parts=parts)


def clock(size: Vec3, *, rim: Rgba, face: Rgba) -> Form:
    """A round dial on a wall; a box if its width and height differ."""
    w, d, h = size
    if abs(w - h) > 1e-6:
        return mirror(size, frame=rim, glass=face)
    dial = Part(shape="cylinder", centre=(0.0, -0.1 * d, 0.0), half=(w / 2, 0.4 * d, h / 2), rgba=rim, axis="y")
    front = Part(shape="cylinder", centre=(0.0, 0.4 * d, 0.0), half=(0.44 * w, 0.1 * d, 0.44 * h), rgba=face, axis="y")
    return Form(parts=(dial, front))


def bin_(size: Vec3, *, body: Rgba, rim: Rgba) -> Form:
    """A bin with a rim."""
    w, d, h = size
    body_part = rounded(size, (0.05 * w, 0.05 * d, 0.0), (0.95 * w, 0.95 * d, 0.93 * h), body)
    return Form(parts=(body_part, rounded(size, (0.0, 0.0, 0.93 * h), size, rim)))


def figure(size: Vec3, *, rgba: Rgba) -> Form:
    """A plinth, a trunk and a head: statues and soft toys."""
    w, d, h = size
    parts = (
        box(size, ZERO, (w, d, 0.15 * h), rgba),
        pillar(size, (w / 2, d / 2), 0.32 * min(w, d), 0.15 * h, 0.72 * h, rgba),
        pillar(size, (w / 2, d / 2), 0.22 * min(w, d), 0.72 * h, h, rgba),
    )
    return Form(parts=parts)


def trunk(size: Vec3, *, body: Rgba, lid: Rgba, handle: Rgba) -> Form:
    """A chest with an overhanging lid and handles at its left and right ends."""
    w, d, h = size
    parts = (
        box(size, (0.05 * w, 0.02 * d, 0.0), (0.95 * w, 0.98 * d, 0.72 * h), body),
        box(size, (0.035 * w, 0.0, 0.72 * h), (0.965 * w, d, h), lid),
        box(size, (0.0, 0.35 * d, 0.52 * h), (w, 0.65 * d, 0.6 * h), handle),
    )
    return Form(parts=parts)
