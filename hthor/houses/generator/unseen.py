"""The ten unseen houses, for tasks in homes that are new to an agent.

Each is what its seed gives, as it comes: `RECIPES` holds ten seeds in a row, none left out. There are as many houses
of 4, 5, 6 and 7 rooms as among the scenes, so that new houses differ from seen ones in nothing but in being new.

``python -m hthor.houses.generator.unseen`` writes them to the folder that they ship in, or to one given.
"""

from __future__ import annotations

import sys
from importlib import resources
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor.houses import generator


class Recipe(Struct, frozen=True):
    """What one house is made from."""

    name: str
    seed: int
    rooms: int


RECIPES = (
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


def make_unseen(recipe: Recipe) -> dict[str, Any]:
    """The document of one house."""
    return generator.generate(recipe.seed, recipe.rooms)


def main(arguments: list[str]) -> None:
    """Write all houses."""
    folder = Path(arguments[0]) if arguments else Path(str(resources.files("hthor.houses").joinpath("unseen")))
    for recipe in RECIPES:
        generator.write(make_unseen(recipe), folder / f"{recipe.name}.json")
        sys.stdout.write(f"{folder / recipe.name}.json\n")


if __name__ == "__main__":
    main(sys.argv[1:])
