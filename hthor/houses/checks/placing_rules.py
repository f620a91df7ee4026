"""The rules about the poses that a house's file gives to things: upright, and on something that carries them."""

import math
from collections.abc import Iterator

from hthor import catalog
from hthor.houses import laying
from hthor.houses.checks.house_rules import Finding, readable_kind, warning
from hthor.houses.checks.structure import UPRIGHT_DEG
from hthor.types import HouseSpec

CODE_PART = "tools"

HIGH_M = 0.30
"""How far above or below the floor, or above what carries it, furniture of a foreign house may be without a finding."""


def check_upright(house: HouseSpec) -> Iterator[Finding]:
    """``thing-tilted``: a thing that the file turns about its x or z axis, which hthor puts upright."""
    seen = set()
    for thing in house.things:
        turns = {axis: math.degrees(turn) for axis, turn in zip("xz", thing.tilt, strict=True)}
        axis = max(turns, key=lambda name: abs(turns[name]))
        if abs(turns[axis]) <= UPRIGHT_DEG or (thing.source and thing.source in seen):
            continue
        seen.add(thing.source)  # a worktop's units are one thing of the file
        problem = f"the {readable_kind(thing.kind)} is turned by {turns[axis]:.0f} degrees about {axis} in the file"
        field = f"{thing.source}.rotation.{axis}" if thing.source else ""
        yield warning("thing-tilted", thing.id, f"{problem}; hthor puts it upright", field)


def check_carried(house: HouseSpec) -> Iterator[Finding]:
    """``thing-floats``: furniture high above the floor or above what carries it, or deep below the floor.

    What hangs on a wall is left out.
    """
    things = {thing.id: thing for thing in house.things}
    for thing in house.things:
        kind, support = catalog.kind(thing.kind), things.get(thing.parent)
        if kind.wall_mounted or (kind.pickable and support is not None):
            continue
        top = 0.0 if support is None else support.centre[2] + support.size[2] / 2
        gap = thing.centre[2] - thing.size[2] / 2 - top
        if gap > HIGH_M or (support is None and gap < -HIGH_M):
            where = f"{'above' if gap > 0.0 else 'below'} {'the floor' if support is None else repr(support.id)}"
            problem = f"the {readable_kind(thing.kind)} stands {abs(gap):.2f} m {where}"
            yield warning("thing-floats", thing.id, problem, _height_of(thing.source))


def check_movable(house: HouseSpec) -> Iterator[Finding]:
    """``thing-fixed``: a small thing on or in furniture that nobody can pick up, because it does not lie free there."""
    for thing, problem in laying.fixed_objects(house):
        what = f"the {readable_kind(thing.kind)} cannot be picked up and stays where the file has it"
        yield warning("thing-fixed", thing.id, f"{what}: {problem}", _height_of(thing.source))


def _height_of(source: str) -> str:
    return f"{source}.position.y" if source else ""
