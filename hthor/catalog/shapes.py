"""Parametric furniture without doors: tables, open cabinets, shelves, seats, beds.

Every function builds a thing of any positive size [m] whose parts fill its bounding box. The functions measure z from
the floor upwards and y from the back to the front (see ``solids``).
"""

from hthor.catalog.colors import IRON, WHITE
from hthor.catalog.kind import Form
from hthor.catalog.solids import box, pillar, rest, rest_on_top, rounded
from hthor.types import Part, Rgba, Vec3


def _legs(size: Vec3, leg: float, height: float, rgba: Rgba) -> tuple[Part, ...]:
    w, d, _ = size
    corners = ((0.0, 0.0), (w - leg, 0.0), (0.0, d - leg), (w - leg, d - leg))
    return tuple(box(size, (x, y, 0.0), (x + leg, y + leg, height), rgba) for x, y in corners)


def table(size: Vec3, *, wood: Rgba, legs: Rgba) -> Form:
    """A table top on four legs."""
    w, d, h = size
    t, leg = min(0.04, 0.3 * h), min(0.06, 0.2 * w, 0.2 * d)
    plate = box(size, (0.0, 0.0, h - t), (w, d, h), wood)
    return Form(parts=(plate, *_legs(size, leg, h - t, legs)), surfaces=(rest_on_top(size),))


def low_table(size: Vec3, *, wood: Rgba, legs: Rgba) -> Form:
    """A table top on four legs with a board between the legs."""
    w, d, h = size
    form = table(size, wood=wood, legs=legs)
    e, z, t = min(0.03, 0.1 * w, 0.1 * d), 0.3 * h, min(0.02, 0.1 * h)
    return Form(parts=(*form.parts, box(size, (e, e, z), (w - e, d - e, z + t), wood)), surfaces=form.surfaces)


def tv_stand(size: Vec3, *, wood: Rgba) -> Form:
    """A low cabinet, open in front, divided in the middle."""
    w, d, h = size
    t, b = min(0.03, 0.15 * h, 0.1 * w), min(0.015, 0.1 * d)
    parts = (
        box(size, (0.0, 0.0, h - t), (w, d, h), wood),
        box(size, (0.0, 0.0, 0.0), (w, d, t), wood),
        box(size, (0.0, 0.0, t), (t, d, h - t), wood),
        box(size, (w - t, 0.0, t), (w, d, h - t), wood),
        box(size, ((w - t) / 2, b, t), ((w + t) / 2, d, h - t), wood),
        box(size, (t, 0.0, t), (w - t, b, h - t), IRON),
    )
    return Form(parts=parts, surfaces=(rest_on_top(size),))


def shelf(size: Vec3, *, wood: Rgba) -> Form:
    """A bookcase with a board about every 0.38 m; its top counts as a board if a person can see onto it."""
    w, d, h = size
    t, b = min(0.025, 0.05 * h, 0.1 * w), min(0.012, 0.1 * d)
    gaps = max(1, min(5, round(h / 0.38)))
    step = (h - t) / gaps
    boards = tuple(box(size, (t, b, i * step), (w - t, d, i * step + t), wood) for i in range(gaps))
    shell = (
        box(size, (0.0, 0.0, h - t), (w, d, h), wood),
        box(size, (0.0, 0.0, 0.0), (t, d, h - t), wood),
        box(size, (w - t, 0.0, 0.0), (w, d, h - t), wood),
        box(size, (t, 0.0, 0.0), (w - t, b, h - t), wood),
    )
    rests = tuple(
        rest(size, f"board {i + 1}", (t, b), (w - t, d), i * step + t, step - t) for i in range(gaps) if step - t > 0.0
    )
    return Form(parts=(*shell, *boards), surfaces=(*rests, rest_on_top(size)) if h <= 1.4 else rests)


def bed(size: Vec3, *, frame: Rgba, blanket: Rgba) -> Form:
    """A mattress in a frame, its headboard at the back."""
    w, d, h = size
    head, low, top = min(0.08, 0.1 * d), 0.28 * h, 0.55 * h
    fold = head + 0.3 * (d - head)
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, head, h), frame),
        box(size, (0.0, head, 0.0), (w, d, low), frame),
        box(size, (0.02 * w, head, low), (0.98 * w, fold, top), WHITE),
        box(size, (0.0, fold, low), (w, d, top), blanket),
    )
    e = min(0.05, 0.05 * w, 0.05 * d)
    return Form(parts=parts, surfaces=(rest(size, "mattress", (e, head + e), (w - e, d - e), top),))


def sofa(size: Vec3, *, fabric: Rgba, cushion: Rgba, seats: int) -> Form:
    """A seat of one or more cushions between a back and two arms."""
    w, d, h = size
    arm, back = min(0.16, 0.16 * w), min(0.24, 0.28 * d)
    base, seat, rail = 0.3 * h, 0.52 * h, 0.74 * h
    width = (w - 2 * arm) / seats
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, back, h), fabric),
        box(size, (0.0, back, 0.0), (arm, d, rail), fabric),
        box(size, (w - arm, back, 0.0), (w, d, rail), fabric),
        box(size, (arm, back, 0.04 * h), (w - arm, d, base), fabric),
        *(
            box(size, (arm + i * width, back, base), (arm + (i + 1) * width, d, seat), cushion)
            for i in range(seats)  # without gaps, in which a pen would be lost
        ),
    )
    e = min(0.03, 0.05 * d)
    return Form(parts=parts, surfaces=(rest(size, "seat", (arm + e, back + e), (w - arm - e, d - e), seat),))


def chair(size: Vec3, *, wood: Rgba, seat: Rgba) -> Form:
    """A seat on four legs with an upright back."""
    w, d, h = size
    z, t, back, leg = 0.5 * h, min(0.04, 0.1 * h), min(0.04, 0.15 * d), min(0.04, 0.2 * w, 0.2 * d)
    parts = (
        box(size, (0.0, 0.0, z - t), (w, d, z), seat),
        box(size, (0.0, 0.0, z), (w, back, h), wood),
        *_legs(size, leg, z - t, wood),
    )
    e = min(0.02, 0.05 * w, 0.05 * d)
    return Form(parts=parts, surfaces=(rest(size, "seat", (e, back + e), (w - e, d - e), z),))


def stool(size: Vec3, *, seat: Rgba, legs: Rgba) -> Form:
    """A seat on a column and a foot."""
    w, d, h = size
    t, r = min(0.06, 0.25 * h), 0.12 * min(w, d)
    parts = (
        rounded(size, (0.0, 0.0, h - t), (w, d, h), seat),
        pillar(size, (w / 2, d / 2), r, 0.0, h - t, legs),
        rounded(size, (0.1 * w, 0.1 * d, 0.0), (0.9 * w, 0.9 * d, 0.06 * h), legs),
    )
    a = 0.15
    return Form(parts=parts, surfaces=(rest(size, "seat", (a * w, a * d), ((1 - a) * w, (1 - a) * d), h),))


def ottoman(size: Vec3, *, fabric: Rgba) -> Form:
    """A padded block."""
    w, d, h = size
    low = box(size, (0.04 * w, 0.04 * d, 0.0), (0.96 * w, 0.96 * d, 0.3 * h), IRON)
    return Form(parts=(low, box(size, (0.0, 0.0, 0.3 * h), (w, d, h), fabric)), surfaces=(rest_on_top(size),))
