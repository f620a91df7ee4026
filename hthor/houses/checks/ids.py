"""The ids of a house file: every id names one thing, and none is a name that hthor gives to something else.

Rooms, walls, doors, windows and objects share one space of names, because the world, tasks and messages find all of
them, and the bodies, by name alone.
"""

import re
from collections.abc import Iterable, Iterator

from hthor import catalog
from hthor.houses.schema import HouseFile, ObjectRow

LONGEST = 200
"""Most characters of an id; ProcTHOR's have about 30."""
EXTERIOR = "exterior"
"""Used in place of a room's id for the outside."""

_PLACES = ("floor", "ceiling", "wall", "ground", "outdoors", "roof", EXTERIOR)
"""What hthor calls the parts of a house that have no id of their own."""
_TAKEN = (
    (rf"(?:{'|'.join(_PLACES)})\Z", "it is hthor's name for a part of every house"),
    (r"(?:floor|ceiling) of ", "floors and ceilings of rooms have such names"),
    (r"human|robot", "names that begin so are those of people and robots"),
)
"""Patterns of names that are never free, and why."""
_BROUGHT = (
    rf"(?:{'|'.join(catalog.TARGETS)})(?:_\d+)?\Z|trunk\Z|brought_",
    "tasks bring an object of that name into the house",
)
"""The pattern of names that only objects have which a task brings, and why."""


def iter_objects(house: HouseFile) -> Iterator[tuple[str, ObjectRow, str]]:
    """Every object of the tree with its field path and its parent's id, parents first."""

    def walk(rows: list[ObjectRow], where: str, parent: str) -> Iterator[tuple[str, ObjectRow, str]]:
        for index, row in enumerate(rows):
            path = f"{where}[{index}]"
            yield path, row, parent
            yield from walk(row.children or [], f"{path}.children", row.id)

    return walk(house.objects, "objects", "")


def iter_ids(house: HouseFile) -> Iterator[tuple[str, str]]:
    """Every id of the file with the field path of what it names."""
    groups = {
        "rooms": [row.id for row in house.rooms],
        "walls": [row.id for row in house.walls],
        "doors": [row.id for row in house.doors],
        "windows": [row.id for row in house.windows or ()],
    }
    for name, ids in groups.items():
        yield from ((f"{name}[{index}]", id) for index, id in enumerate(ids))
    yield from ((where, row.id) for where, row, _ in iter_objects(house))


def id_faults(ids: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """(field, problem) of every id that cannot be used, from `iter_ids`."""
    seen: dict[str, tuple[str, str]] = {}
    for where, name in ids:
        problem = why_unusable(name)
        key = engine_name(name)
        if not problem and key in seen:
            first, other = seen[key]
            alike = "" if name == other else f" as '{other}', and '/' is the same as '|'"
            problem = f"the id '{name}' already belongs to {first}{alike}; ids must be unique in the whole file"
        if problem:
            yield f"{where}.id", problem
        seen.setdefault(key, (where, name))


def engine_name(id: str) -> str:
    """The engine's name for an id; it has no slash."""
    return id.replace("/", "|")


def why_unusable(name: str, brought: bool = False) -> str:
    """Why nothing can have this id, and what to do; empty for an id that can be used.

    Args:
        brought: whether it is the id of an object that a task brings into the house.
    """
    if not name.strip():
        return f"the id {name!r} is empty; give it a name that nothing else in the file has"
    if len(name) > LONGEST:
        return f"the id '{name[:40]}...' has {len(name)} characters; use at most {LONGEST}"
    if not name.isprintable():
        return f"the id {name!a:.80} has characters that cannot be shown; use letters, digits, '|' and '_'"
    for pattern, reason in _TAKEN if brought else (*_TAKEN, _BROUGHT):
        if re.match(pattern, name):
            return f"the id '{name}' cannot be used, because {reason}; choose another id"
    return ""
