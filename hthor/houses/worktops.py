"""Worktops round a corner: an L- or C-shaped one as the straight units that it is made of.

ProcTHOR's database gives such a worktop one bounding box, up to 3 m square. Made of straight units, each a thing of its
own with its front to the inside, it is as deep as a worktop everywhere: for who walks, reaches, looks and searches.
"""

import math
from collections.abc import Iterator, Sequence

import msgspec

from hthor.geometry.plane import distance_to_rectangle, to_house, wrap
from hthor.types import Thing, Vec2

DEPTH_M = 0.61
"""How deep a worktop is: as ProcTHOR's straight ones are."""
_LEAST_M = 0.1


def split_worktop(thing: Thing, plan: str) -> tuple[Thing, ...]:
    """The units of a worktop whose bounding box is ``thing``, the one along the back first, under the worktop's own id.

    Args:
        plan: "L", along the back and forward on the right, as seen from behind; "C", along the back and forward on
            both sides; anything else, or a box too small for these, gives the thing itself.
    """
    w, d, _ = thing.size
    wide = DEPTH_M * {"L": 1, "C": 2}.get(plan, 0)
    if not wide or w < wide + _LEAST_M or d < DEPTH_M + _LEAST_M:
        return (thing,)
    return tuple(_units(thing, plan))


def unit_below(place: Vec2, parts: Sequence[Thing]) -> Thing:
    """The unit under a place [m] on the plan, or the nearest one."""
    return min(parts, key=lambda one: distance_to_rectangle(place, one.centre[:2], one.size[:2], one.yaw))


def _units(thing: Thing, plan: str) -> Iterator[Thing]:
    w, d, _ = thing.size
    left = -w / 2 + (DEPTH_M if plan == "C" else 0.0)
    right, front = w / 2 - DEPTH_M, DEPTH_M - d / 2
    yield _unit(thing, "", (left, -d / 2), (right, front), 0)
    yield _unit(thing, "right_corner", (right, -d / 2), (w / 2, front), 0)
    yield _unit(thing, "right", (right, front), (w / 2, d / 2), 1)
    if plan == "C":
        yield _unit(thing, "left_corner", (-w / 2, -d / 2), (left, front), 0)
        yield _unit(thing, "left", (-w / 2, front), (left, d / 2), -1)


def _unit(thing: Thing, name: str, low: Vec2, high: Vec2, turns: int) -> Thing:
    """The unit between two corners [m] of the worktop's frame, turned by so many quarters."""
    (x0, y0), (x1, y1) = low, high
    across, along = (x1 - x0, y1 - y0) if not turns else (y1 - y0, x1 - x0)
    return msgspec.structs.replace(
        thing,
        id=f"{thing.id}|{name}" if name else thing.id,
        centre=to_house(((x0 + x1) / 2, (y0 + y1) / 2, 0.0), thing.centre, thing.yaw),
        size=(across, along, thing.size[2]),
        yaw=wrap(thing.yaw + turns * math.pi / 2),
    )
