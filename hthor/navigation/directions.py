"""Directions through a house in plain English: written from steps, and read back into steps.

    "Go through the door on your left into the kitchen. Walk past the stove on your right. Stop at the fridge."

Task generation writes such instructions; robots and human models read them. A side is relative to how one enters the
room (in the first room, to how one stands at the start); behind a turn, "ahead" is relative to that turn.
"""

import functools
import math
import re
from collections.abc import Sequence
from typing import Literal

from msgspec import Struct

from hthor import catalog
from hthor.errors import HthorError
from hthor.geometry.plane import wrap

Side = Literal["ahead", "left", "right", "behind"]
Act = Literal["door", "opening", "past", "turn", "stop"]

BEARINGS: dict[Side, float] = {"ahead": 0.0, "left": math.pi / 2, "right": -math.pi / 2, "behind": math.pi}
"""The direction of each side [rad], relative to the heading, left positive."""
ROOMS = ("kitchen", "living_room", "bedroom", "bathroom")
"""Kinds of rooms that instructions name."""
_WHERE: dict[Side, str] = {"ahead": "ahead", "left": "on your left", "right": "on your right", "behind": "behind you"}
_SIDES = {words: side for side, words in _WHERE.items()}
_PASSAGE = rf"({'|'.join(_SIDES)})(?: by the ([a-z ]+?))? into the ([a-z ]+)"
_CLAUSES: dict[Act, re.Pattern[str]] = {
    "door": re.compile(f"go through the door {_PASSAGE}"),
    "opening": re.compile(f"go through the opening {_PASSAGE}"),
    "past": re.compile(r"walk past the ([a-z ]+) (on your (?:left|right))"),
    "turn": re.compile(r"turn (left|right) at the ([a-z ]+)"),
    "stop": re.compile(r"stop at the ([a-z ]+)"),
}


class Direction(Struct, frozen=True, kw_only=True):
    """One step: to go through a door, or an opening without one, to walk past a landmark, to turn at it, or to stop.

    ``side`` is that of the door or landmark, or the direction of a turn; None for a stop. ``landmark`` and ``room`` are
    kinds of things and of rooms; a door has a landmark only where its side alone would be ambiguous.
    """

    act: Act
    side: Side | None = None
    landmark: str = ""
    room: str = ""


def write(directions: Sequence[Direction]) -> str:
    """The instruction, one sentence a step; a turn shares its sentence with the step after it."""
    sentences: list[str] = []
    joined = False
    for step in directions:
        clause = _clause(step)
        if joined:
            sentences[-1] += f" and {clause}"
        else:
            sentences.append(clause[0].upper() + clause[1:])
        joined = step.act == "turn"
    return " ".join(f"{sentence}." for sentence in sentences)


def read(instruction: str) -> tuple[Direction, ...]:
    """The steps of an instruction that `write` wrote.

    Raises:
        HthorError: when a clause has none of the forms that `write` uses, or names an unknown thing.
    """
    clauses = [clause.strip().lower() for clause in re.split(r"\.| and ", instruction)]
    return tuple(_step(clause) for clause in clauses if clause)


def nearest_side(bearing: float) -> Side:
    """The side that names a direction [rad], relative to the heading, best."""
    return min(BEARINGS, key=lambda side: off_side(side, bearing))


def off_side(side: Side, bearing: float) -> float:
    """By how much [rad] a direction, relative to the heading, differs from the middle of a side."""
    return abs(wrap(bearing - BEARINGS[side]))


def _clause(step: Direction) -> str:
    thing = catalog.kind(step.landmark).title if step.landmark else ""
    if step.act == "stop" or step.side is None:
        return f"stop at the {thing}"
    if step.act == "turn":
        return f"turn {step.side} at the {thing}"
    if step.act == "past":
        return f"walk past the {thing} {_WHERE[step.side]}"
    by = f" by the {thing}" if thing else ""
    return f"go through the {step.act} {_WHERE[step.side]}{by} into the {step.room.replace('_', ' ')}"


def _step(clause: str) -> Direction:
    for act, pattern in _CLAUSES.items():
        found = pattern.fullmatch(clause)
        if found is None:
            continue
        if act in ("door", "opening"):
            where, thing, room = found.groups()
            landmark = _kind(thing) if thing else ""
            return Direction(act=act, side=_SIDES[where], landmark=landmark, room=room.replace(" ", "_"))
        if act == "past":
            return Direction(act=act, side=_SIDES[found[2]], landmark=_kind(found[1]))
        if act == "turn":
            return Direction(act=act, side="left" if found[1] == "left" else "right", landmark=_kind(found[2]))
        return Direction(act=act, landmark=_kind(found[1]))
    raise HthorError(f"no direction reads '{clause}'; it has to be like '{_EXAMPLE}'")


_EXAMPLE = "go through the door on your left into the kitchen"


def _kind(title: str) -> str:
    kinds = _kinds()
    if title not in kinds:
        raise HthorError(f"an instruction names a '{title}', which the catalogue does not contain")
    return kinds[title]


@functools.cache
def _kinds() -> dict[str, str]:
    return {catalog.kind(name).title.lower(): name for name in catalog.names()}
