"""Which rooms a house has and how they belong together."""

from __future__ import annotations

from collections.abc import Iterator

from msgspec import Struct

from hthor.errors import HthorError, UnknownName
from hthor.houses.generator.draws import Dice

KITCHEN, LIVING, BEDROOM, BATHROOM = "Kitchen", "LivingRoom", "Bedroom", "Bathroom"


class Leaf(Struct, frozen=True):
    """A room: its type and the share of its group's floor that it asks for. A bathroom within a group is private."""

    room: str
    ratio: float


class Group(Struct, frozen=True):
    """Rooms, or groups of rooms, that belong together."""

    ratio: float
    parts: tuple[Leaf | Group, ...]


class Spec(Struct, frozen=True):
    """A programme of rooms by ``name``; ``weight`` is how often it is drawn among those of as many rooms."""

    name: str
    weight: float
    tree: Group


def leaves(part: Leaf | Group) -> Iterator[Leaf]:
    """The rooms of a tree, in order."""
    if isinstance(part, Leaf):
        yield part
    else:
        for child in part.parts:
            yield from leaves(child)


_DAY = Group(2.0, (Leaf(KITCHEN, 1.0), Leaf(LIVING, 1.1)))
_EN_SUITE = Group(1.6, (Leaf(BEDROOM, 2.0), Leaf(BATHROOM, 1.0)))

SPECS = (
    Spec("4-room", 5.0, Group(1.0, (Group(2.0, (Leaf(BEDROOM, 2.0), Leaf(BATHROOM, 1.1))), _DAY))),
    Spec("4-room-hall", 2.0, Group(1.0, (_DAY, Leaf(BEDROOM, 1.2), Leaf(BATHROOM, 0.6)))),
    Spec("4-room-parlour", 2.0, Group(1.0, (Leaf(LIVING, 1.5), Leaf(KITCHEN, 1.1), _EN_SUITE))),
    Spec("5-room", 2.0, Group(1.0, (_EN_SUITE, Leaf(BEDROOM, 1.0), _DAY))),
    Spec("2-bed-1-bath", 3.0, Group(1.0, (_DAY, Leaf(BATHROOM, 0.5), Leaf(BEDROOM, 1.0), Leaf(BEDROOM, 1.0)))),
    Spec("5-room-parlour", 1.0, Group(1.0, (_DAY, Leaf(LIVING, 1.0), _EN_SUITE))),
    Spec("2-bed-2-bath", 3.0, Group(1.0, (_EN_SUITE, _EN_SUITE, Group(2.2, _DAY.parts)))),
    Spec("3-bed-1-bath", 2.0, Group(1.0, (_DAY, Leaf(BATHROOM, 0.5), *(Leaf(BEDROOM, 0.9),) * 3))),
    Spec("6-room", 1.0, Group(1.0, (_DAY, Leaf(BATHROOM, 0.45), Leaf(BEDROOM, 0.9), _EN_SUITE))),
    Spec("7-room-3-bed", 2.0, Group(1.0, (_DAY, Leaf(LIVING, 0.8), Leaf(BATHROOM, 0.5), *(Leaf(BEDROOM, 0.85),) * 3))),
    Spec("3-bed-2-bath", 2.0, Group(1.0, (_DAY, Leaf(BATHROOM, 0.45), _EN_SUITE, *(Leaf(BEDROOM, 0.85),) * 2))),
)


def choose(rooms: int, dice: Dice, name: str | None) -> Spec:
    """The spec of that name, or one drawn among those with so many rooms.

    Raises:
        UnknownName: when there is no spec of that name.
        HthorError: when none has so many rooms, or the one named has another number.
    """
    counts = sorted({sum(1 for _ in leaves(spec.tree)) for spec in SPECS})
    if rooms not in counts:
        raise HthorError(f"a house has {counts[0]} to {counts[-1]} rooms, got {rooms}; choose a number between them")
    fitting = [spec for spec in SPECS if sum(1 for _ in leaves(spec.tree)) == rooms]
    if name is None:
        return dice.weighted(fitting, [spec.weight for spec in fitting], "spec")
    if name not in [spec.name for spec in SPECS]:
        raise UnknownName("room spec", name, [spec.name for spec in SPECS])
    named = [spec for spec in fitting if spec.name == name]
    if not named:
        valid = ", ".join(spec.name for spec in fitting)
        raise HthorError(f"the room spec '{name}' does not have {rooms} rooms; specs that have: {valid}")
    return named[0]
