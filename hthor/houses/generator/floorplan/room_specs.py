"""The rooms that a house can have, and how they are grouped."""

from __future__ import annotations

from collections.abc import Iterator

from msgspec import Struct

from hthor.errors import HthorError, UnknownName
from hthor.houses.generator.draws import Dice

KITCHEN, LIVING, BEDROOM, BATHROOM = "Kitchen", "LivingRoom", "Bedroom", "Bathroom"


class RoomLeaf(Struct, frozen=True):
    """A room: its type, and its wanted share of its group's floor. A bathroom within a group is private."""

    room: str
    ratio: float


class RoomGroup(Struct, frozen=True):
    """Rooms, or groups of rooms, that belong together."""

    ratio: float
    parts: tuple[RoomLeaf | RoomGroup, ...]


class RoomSpec(Struct, frozen=True):
    """A named set of rooms; ``weight`` is its weight in the draw among the specs with as many rooms."""

    name: str
    weight: float
    tree: RoomGroup


def iter_leaves(part: RoomLeaf | RoomGroup) -> Iterator[RoomLeaf]:
    """The rooms of a tree, in order."""
    if isinstance(part, RoomLeaf):
        yield part
    else:
        for child in part.parts:
            yield from iter_leaves(child)


_DAY = RoomGroup(2.0, (RoomLeaf(KITCHEN, 1.0), RoomLeaf(LIVING, 1.1)))
_EN_SUITE = RoomGroup(1.6, (RoomLeaf(BEDROOM, 2.0), RoomLeaf(BATHROOM, 1.0)))

SPECS = (
    RoomSpec("4-room", 5.0, RoomGroup(1.0, (RoomGroup(2.0, (RoomLeaf(BEDROOM, 2.0), RoomLeaf(BATHROOM, 1.1))), _DAY))),
    RoomSpec("4-room-hall", 2.0, RoomGroup(1.0, (_DAY, RoomLeaf(BEDROOM, 1.2), RoomLeaf(BATHROOM, 0.6)))),
    RoomSpec("4-room-parlour", 2.0, RoomGroup(1.0, (RoomLeaf(LIVING, 1.5), RoomLeaf(KITCHEN, 1.1), _EN_SUITE))),
    RoomSpec("5-room", 2.0, RoomGroup(1.0, (_EN_SUITE, RoomLeaf(BEDROOM, 1.0), _DAY))),
    RoomSpec(
        "2-bed-1-bath",
        3.0,
        RoomGroup(1.0, (_DAY, RoomLeaf(BATHROOM, 0.5), RoomLeaf(BEDROOM, 1.0), RoomLeaf(BEDROOM, 1.0))),
    ),
    RoomSpec("5-room-parlour", 1.0, RoomGroup(1.0, (_DAY, RoomLeaf(LIVING, 1.0), _EN_SUITE))),
    RoomSpec("2-bed-2-bath", 3.0, RoomGroup(1.0, (_EN_SUITE, _EN_SUITE, RoomGroup(2.2, _DAY.parts)))),
    RoomSpec("3-bed-1-bath", 2.0, RoomGroup(1.0, (_DAY, RoomLeaf(BATHROOM, 0.5), *(RoomLeaf(BEDROOM, 0.9),) * 3))),
    RoomSpec("6-room", 1.0, RoomGroup(1.0, (_DAY, RoomLeaf(BATHROOM, 0.45), RoomLeaf(BEDROOM, 0.9), _EN_SUITE))),
    RoomSpec(
        "7-room-3-bed",
        2.0,
        RoomGroup(1.0, (_DAY, RoomLeaf(LIVING, 0.8), RoomLeaf(BATHROOM, 0.5), *(RoomLeaf(BEDROOM, 0.85),) * 3)),
    ),
    RoomSpec(
        "3-bed-2-bath",
        2.0,
        RoomGroup(1.0, (_DAY, RoomLeaf(BATHROOM, 0.45), _EN_SUITE, *(RoomLeaf(BEDROOM, 0.85),) * 2)),
    ),
)


def choose_spec(rooms: int, dice: Dice, name: str | None) -> RoomSpec:
    """The spec of that name, or a spec drawn among those with this number of rooms.

    Raises:
        UnknownName: when there is no spec of that name.
        HthorError: when no spec has this number of rooms, or the named spec has another number.
    """
    counts = sorted({sum(1 for _ in iter_leaves(spec.tree)) for spec in SPECS})
    if rooms not in counts:
        raise HthorError(f"a house has {counts[0]} to {counts[-1]} rooms, got {rooms}; choose a number between them")
    fitting = [spec for spec in SPECS if sum(1 for _ in iter_leaves(spec.tree)) == rooms]
    if name is None:
        return dice.weighted(fitting, [spec.weight for spec in fitting], "spec")
    if name not in [spec.name for spec in SPECS]:
        raise UnknownName("room spec", name, [spec.name for spec in SPECS])
    named = [spec for spec in fitting if spec.name == name]
    if not named:
        valid = ", ".join(spec.name for spec in fitting)
        raise HthorError(f"the room spec '{name}' does not have {rooms} rooms; specs that do: {valid}")
    return named[0]
