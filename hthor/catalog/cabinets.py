"""Parametric furniture that opens: base and wall cabinets, wardrobes, chests with a drawer.

Doors turn about the thing's outer edges and drawers slide to the front. Of several drawers only the topmost can be
opened; the others are only visible fronts. When closed, the thing with its handles is ``size[1]`` deep.
"""

from hthor.catalog.colors import IRON, STEEL
from hthor.catalog.kind import Form
from hthor.catalog.solids import PULL, box, hinge, inside, rest_on_top, shell, slide, tray
from hthor.types import Joint, Part, Rgba, Surface, Vec3

_DOORS_M = 1.2
"""[m] A pair of doors is at most this wide; the rest of a longer cabinet cannot be opened."""
_NARROW_M = 0.7
"""[m] A base cabinet that is narrower than this has no doors."""


def _pair(
    size: Vec3, lo: Vec3, hi: Vec3, grip: float, rgba: Rgba, handle: Rgba
) -> tuple[tuple[Part, ...], tuple[Joint, Joint]]:
    """Two doors side by side, each with a handle, ``grip`` [m] deep, at the doors' front ``hi[1]``."""
    (x0, y0, z0), (x1, y1, z1) = lo, hi
    middle, slim = (x0 + x1) / 2, 0.03 * (x1 - x0)
    low, high = z0 + 0.35 * (z1 - z0), z0 + 0.65 * (z1 - z0)
    left, right = (middle - 2 * slim, middle - slim), (middle + slim, middle + 2 * slim)
    parts = (
        box(size, lo, (middle, y1, z1), rgba, moves="left door"),
        box(size, (middle, y0, z0), hi, rgba, moves="right door"),
        box(size, (left[0], y1, low), (left[1], y1 + grip, high), handle, moves="left door"),
        box(size, (right[0], y1, low), (right[1], y1 + grip, high), handle, moves="right door"),
    )
    return parts, (hinge(size, "left door", x0, y1, left=True), hinge(size, "right door", x1, y1, left=False))


def counter(size: Vec3, *, body: Rgba, top: Rgba) -> Form:
    """A kitchen base cabinet under a worktop, with a toe kick and a pair of doors at its left end.

    The rest has no doors. A cabinet too narrow for a pair has none at all: it stands in a corner or ends a row.
    """
    w, d, h = size
    t, toe, leaf = min(0.04, 0.2 * h), min(0.1, 0.2 * h), min(0.02, 0.05 * d)
    if w < _NARROW_M:
        closed = box(size, (0.0, 0.0, toe), (w, d - 2 * leaf, h - t), body)
        kick = box(size, (0.0, 0.0, 0.0), (w, 0.88 * d, toe), IRON)
        return Form(parts=(box(size, (0.0, 0.0, h - t), (w, d, h), top), kick, closed), surfaces=(rest_on_top(size),))
    wide, wall, low = min(w, _DOORS_M), min(0.018, 0.05 * h, 0.05 * w), h - t
    front, lip = d - 3 * leaf, min(0.015, 0.5 * leaf)
    doors, joints = _pair(size, (0.0, front, toe), (wide, front + leaf, low), lip, body, STEEL)
    parts = [
        box(size, (0.0, 0.0, low), (w, d, h), top),
        box(size, (0.0, 0.0, 0.0), (w, 0.88 * d, toe), IRON),
        *shell(size, (0.0, 0.0, toe), (wide, front, low), wall, body, body)[:4],
        *doors,
    ]
    if w - wide > 1e-6:
        parts.append(box(size, (wide, 0.0, toe), (w, front + leaf, low), body))
    cupboard = inside(size, "cupboard", (wall, wall, toe + wall), (wide - wall, 0.97 * front, low))
    return Form(parts=tuple(parts), surfaces=(cupboard, rest_on_top(size)), joints=joints)


def wall_cabinet(size: Vec3, *, body: Rgba, inner: Rgba) -> Form:
    """A kitchen cabinet on the wall: two doors in front of two shelves."""
    return _cupboard(size, body, inner, bottom=0.0, shelf=0.5)


def wardrobe(size: Vec3, *, body: Rgba, inner: Rgba) -> Form:
    """Two tall doors in front of a space for hanging clothes with a shelf above it, on a plinth."""
    return _cupboard(size, body, inner, bottom=min(0.08, 0.1 * size[2]), shelf=0.8)


def _cupboard(size: Vec3, body: Rgba, inner: Rgba, *, bottom: float, shelf: float) -> Form:
    w, d, h = size
    wall, leaf = min(0.018, 0.05 * w, 0.04 * h, 0.05 * d), min(0.02, 0.08 * d)
    grip = min(0.02, 0.06 * d)
    front = d - leaf - grip
    z = bottom + shelf * (h - bottom)
    doors, joints = _pair(size, (0.0, front, bottom), (w, front + leaf, h), grip, body, STEEL)
    board = box(size, (wall, wall, z - wall), (w - wall, 0.95 * front, z), inner)
    plinth = [box(size, (0.0, 0.0, 0.0), (w, 0.95 * front, bottom), body)] if bottom > 0.0 else []
    floor, far = (wall, wall, bottom + wall), (w - wall, 0.95 * front, z - wall)
    rests = (
        inside(size, "bottom", floor, far),
        inside(size, "shelf", (wall, wall, z), (w - wall, 0.95 * front, h - wall)),
    )
    parts = (*plinth, *shell(size, (0.0, 0.0, bottom), (w, front, h), wall, body, inner), board, *doors)
    return Form(parts=parts, surfaces=rests, joints=joints)


def _drawer(
    size: Vec3, lo: Vec3, hi: Vec3, depth: float, rgba: Rgba, front: Rgba
) -> tuple[tuple[Part, ...], Surface, Joint]:
    """A drawer that fills the space from ``lo`` to ``hi`` except for a small gap; its front is its last part."""
    wall, air = min(0.012, 0.1 * (hi[0] - lo[0]), 0.1 * (hi[2] - lo[2])), 0.03 * (hi[2] - lo[2])
    near, far = (lo[0] + air, lo[1] + air, lo[2] + air), (hi[0] - air, hi[1], hi[2] - air)
    parts = tray(size, "drawer", near, far, wall, rgba)
    panel = box(size, (lo[0], hi[1], lo[2]), (hi[0], hi[1] + depth, hi[2]), front, moves="drawer")
    floor, room = (near[0] + wall, near[1] + wall, near[2] + wall), (far[0] - wall, far[1] - wall, hi[2])
    rests = inside(size, "drawer", floor, room, moves="drawer")
    return (*parts[:4], panel), rests, slide("drawer", PULL * (hi[1] - lo[1]))


def dresser(size: Vec3, *, body: Rgba, fronts: Rgba) -> Form:
    """A chest with three drawers one above the other, of which the topmost opens."""
    w, d, h = size
    e, t, wall = min(0.02, 0.1 * d), min(0.03, 0.1 * h), min(0.02, 0.05 * w)
    split, top, x0, x1 = 0.65 * h, h - t, 0.03 * w, 0.97 * w
    drawer, rests, joint = _drawer(size, (wall, wall, split), (w - wall, d - e, top), e, body, fronts)
    parts = (
        box(size, (0.0, 0.0, top), (w, d, h), body),
        box(size, (0.0, 0.0, 0.0), (w, d - e, split), body),
        box(size, (0.0, 0.0, split), (wall, d - e, top), body),
        box(size, (w - wall, 0.0, split), (w, d - e, top), body),
        box(size, (wall, 0.0, split), (w - wall, wall, top), body),
        box(size, (x0, d - e, 0.05 * h), (x1, d, 0.32 * h), fronts),
        box(size, (x0, d - e, 0.35 * h), (x1, d, 0.62 * h), fronts),
        *drawer,
    )
    return Form(parts=parts, surfaces=(rests, rest_on_top(size)), joints=(joint,))


def nightstand(size: Vec3, *, wood: Rgba, front: Rgba) -> Form:
    """A small table with a drawer under its top and a board between its sides."""
    w, d, h = size
    t, wall, e = min(0.025, 0.1 * h), min(0.018, 0.08 * w), min(0.018, 0.08 * d)
    low, top = 0.62 * h, h - t
    drawer, rests, joint = _drawer(size, (wall, wall, low + wall), (w - wall, d - e, top), e, wood, front)
    parts = (
        box(size, (0.0, 0.0, top), (w, d, h), wood),
        box(size, (0.0, 0.0, 0.0), (wall, d - e, top), wood),
        box(size, (w - wall, 0.0, 0.0), (w, d - e, top), wood),
        box(size, (wall, 0.0, low), (w - wall, wall, top), wood),
        box(size, (wall, wall, low), (w - wall, d - e, low + wall), wood),
        box(size, (wall, 0.02 * d, 0.2 * h), (w - wall, 0.9 * d, 0.2 * h + wall), wood),
        *drawer,
    )
    return Form(parts=parts, surfaces=(rests, rest_on_top(size)), joints=(joint,))


def desk(size: Vec3, *, wood: Rgba, body: Rgba) -> Form:
    """A desktop on a side panel and a chest of drawers, closed at the back; the upper drawer opens."""
    w, d, h = size
    t, chest = min(0.035, 0.3 * h), min(0.4, 0.35 * w)
    low, e = h - t, min(0.03, 0.1 * d)
    front, x0, wall = d - e, w - chest, min(0.018, 0.1 * chest)
    split = 0.68 * low
    drawer, rests, joint = _drawer(size, (x0 + wall, wall, split), (w - wall, front, low), 0.5 * e, body, wood)
    parts = (
        box(size, (0.0, 0.0, low), (w, d, h), wood),
        box(size, (0.0, 0.0, 0.0), (min(0.04, 0.1 * w), front, low), body),
        box(size, (x0, 0.0, 0.0), (w, front, split), body),
        box(size, (x0, 0.0, split), (x0 + wall, front, low), body),
        box(size, (w - wall, 0.0, split), (w, front, low), body),
        box(size, (x0 + wall, 0.0, split), (w - wall, wall, low), body),
        box(size, (x0 + 0.05 * chest, front, 0.06 * h), (w - 0.05 * chest, front + 0.5 * e, 0.94 * split), wood),
        box(size, (0.0, 0.0, 0.35 * h), (x0, min(0.02, 0.1 * d), low), body),
        *drawer,
    )
    return Form(parts=parts, surfaces=(rests, rest_on_top(size)), joints=(joint,))
