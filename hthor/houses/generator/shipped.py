"""The recipes of the houses that come with hthor, so that anybody can make them again.

``python -m hthor.houses.generator.shipped`` writes the ten scenes and the ten unseen houses to the folders that they
ship in, or all of them to one given folder. The unseen houses come from ten successive seeds, none left out; there are
as many of 4, 5, 6 and 7 rooms as among the scenes, so that they differ from the scenes only in being new.
"""

import sys
from importlib import resources
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor.houses import generator


class Recipe(Struct, frozen=True):
    """One house. ``needs`` are the only optional kinds that it has. If ``needs`` or ``spec`` is None, the generator
    draws it.
    """

    name: str
    seed: int
    rooms: int
    spec: str | None = None
    needs: tuple[str, ...] | None = None


def _row(name: str, seed: int, rooms: int, spec: str, needs: str) -> Recipe:
    return Recipe(name, seed, rooms, spec, tuple(needs.split()))


SCENES = (
    _row("alder", 2, 4, "4-room", "armchair bowl laptop pillow shelf television"),
    _row("birch", 68, 5, "5-room", "armchair bowl bread coffee_machine egg shelf television"),
    _row("cedar", 64, 5, "2-bed-1-bath", "bread coffee_machine dresser egg laptop pillow plate television"),
    _row("elder", 61, 4, "4-room-parlour", "armchair dresser egg pillow plate television"),
    _row("hazel", 67, 6, "2-bed-2-bath", "bowl coffee_machine dresser egg laptop pillow shelf television"),
    _row("juniper", 28, 4, "4-room", "bowl bread dresser laptop pillow television"),
    _row("linden", 12, 5, "5-room-parlour", "armchair bowl coffee_machine laptop pillow plate shelf"),
    _row("maple", 10, 7, "7-room-3-bed", "armchair bread coffee_machine dresser laptop pillow plate shelf television"),
    _row("rowan", 10, 6, "2-bed-2-bath", "armchair bowl coffee_machine dresser pillow plate shelf television"),
    _row("willow", 57, 5, "2-bed-1-bath", "bread laptop pillow plate television"),
)
"""The benchmark's scenes, in the order of the scene priors' table of the optional references of each scene."""
UNSEEN = (
    Recipe("aspen", 1001, 4),
    Recipe("beech", 1002, 5),
    Recipe("cherry", 1003, 5),
    Recipe("fir", 1004, 4),
    Recipe("holly", 1005, 6),
    Recipe("larch", 1006, 4),
    Recipe("oak", 1007, 5),
    Recipe("pine", 1008, 7),
    Recipe("spruce", 1009, 6),
    Recipe("yew", 1010, 5),
)
"""Houses for tasks in homes that are new to an agent."""


def make_house(recipe: Recipe) -> dict[str, Any]:
    """The document of one house."""
    return generator.generate(recipe.seed, recipe.rooms, recipe.spec, needs=recipe.needs)


def main(arguments: list[str]) -> None:
    """Write all houses."""
    for folder, recipes in (("data", SCENES), ("unseen", UNSEEN)):
        place = Path(arguments[0]) if arguments else Path(str(resources.files("hthor.houses").joinpath(folder)))
        for recipe in recipes:
            generator.write(make_house(recipe), place / f"{recipe.name}.json")
            sys.stdout.write(f"{place / recipe.name}.json\n")


if __name__ == "__main__":
    main(sys.argv[1:])
