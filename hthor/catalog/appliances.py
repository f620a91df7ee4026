"""Parametric kitchen and laundry machines with doors: microwave ovens, stoves, washers."""

from hthor.catalog.colors import BLACK, IRON, STEEL
from hthor.catalog.kind import Form
from hthor.catalog.solids import box, flap, hinge, inside, rest_on_top, shell
from hthor.types import Rgba, Vec3


def oven_front(size: Vec3, *, body: Rgba, glass: Rgba) -> Form:
    """A box with a door hinged at the left and a panel of keys next to it: microwave ovens and safes."""
    w, d, h = size
    wall, leaf = min(0.025, 0.08 * w, 0.08 * h, 0.08 * d), min(0.02, 0.08 * d)
    front, split = d - leaf, 0.76 * w
    parts = (
        *shell(size, (0.0, 0.0, 0.0), (split + wall, front, h), wall, body, STEEL),
        box(size, (split + wall, 0.0, 0.0), (w, front, h), body),
        box(size, (0.0, front, 0.0), (split, d, h), glass, moves="door"),
        box(size, (split, front, 0.0), (w, front + 0.5 * leaf, h), IRON),
    )
    space = inside(size, "inside", (wall, wall, wall), (split, 0.97 * front, h - wall))
    return Form(parts=parts, surfaces=(space,), joints=(hinge(size, "door", 0.0, d, left=True),))


def washer(size: Vec3, *, body: Rgba, glass: Rgba) -> Form:
    """A front loader: a drum behind a door hinged at the left, a panel of keys above it."""
    w, d, h = size
    wall, leaf = min(0.05, 0.1 * w, 0.1 * d), min(0.02, 0.05 * d)
    front, low, high = d - leaf, 0.15 * h, 0.75 * h
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, front, low), body),
        *shell(size, (0.0, 0.0, low), (w, front, high), wall, body, STEEL),
        box(size, (0.0, 0.0, high), (w, front, h), body),
        box(size, (0.1 * w, front, low), (0.9 * w, d, high), glass, moves="door"),
        box(size, (0.05 * w, front, 0.85 * h), (0.95 * w, front + 0.5 * leaf, 0.95 * h), IRON),
    )
    drum = inside(size, "drum", (wall, wall, low + wall), (w - wall, 0.97 * front, high - wall))
    door = hinge(size, "door", 0.1 * w, d, left=True)
    # Next to the door the shell is open in front; a frame there would not be visible in addition to the door's look.
    sides = (
        box(size, (0.0, front, low), (0.1 * w, front + 0.5 * leaf, high), body),
        box(size, (0.9 * w, front, low), (w, front + 0.5 * leaf, high), body),
    )
    return Form(parts=(*parts, *sides), surfaces=(drum, rest_on_top(size)), joints=(door,))


def stove(size: Vec3, *, body: Rgba, glass: Rgba) -> Form:
    """An oven under a glass hob: its door is a flap that opens downwards, its knobs are above the door."""
    w, d, h = size
    wall, leaf, grip = min(0.04, 0.08 * w, 0.08 * d), min(0.03, 0.06 * d), min(0.03, 0.05 * d)
    front, low, high, hob = d - leaf - grip, 0.12 * h, 0.82 * h, min(0.02, 0.05 * h)
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, 0.92 * d, low), IRON),
        *shell(size, (0.0, 0.0, low), (w, front, high), wall, body, BLACK),
        box(size, (0.0, 0.0, high), (w, front + leaf, h - hob), body),
        box(size, (0.0, 0.0, h - hob), (w, d, h), BLACK),
        box(size, (0.0, front, low), (w, front + leaf, high), glass, moves="door"),
        box(size, (0.1 * w, front + leaf, 0.9 * high), (0.9 * w, d, 0.94 * high), STEEL, moves="door"),
    )
    oven = inside(size, "oven", (wall, wall, low + wall), (w - wall, 0.97 * front, high - wall))
    return Form(parts=parts, surfaces=(oven, rest_on_top(size)), joints=(flap(size, "door", front + leaf, low),))


def range_hood(size: Vec3, *, body: Rgba) -> Form:
    """A flat hood with a chimney above it."""
    w, d, h = size
    parts = (
        box(size, (0.0, 0.0, 0.0), (w, d, 0.25 * h), body),
        box(size, (0.3 * w, 0.0, 0.25 * h), (0.7 * w, 0.6 * d, h), body),
    )
    return Form(parts=parts)
