"""The benchmark's ten scenes: what each is made from, so that anybody can make them again.

``python -m hthor.houses.generator.scenes`` writes them to the folder that they ship in, or to one given.
"""

from __future__ import annotations

import sys
from importlib import resources
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor.houses import generator


class Scene(Struct, frozen=True):
    """One scene: ``needs`` are the optional references that it has; it has none of the others."""

    name: str
    seed: int
    rooms: int
    spec: str
    needs: tuple[str, ...]


SCENES = (
    Scene("alder", 2, 4, "4-room", ("armchair", "bowl", "laptop", "pillow", "shelf", "television")),
    Scene("birch", 68, 5, "5-room", ("armchair", "bowl", "bread", "coffee_machine", "egg", "shelf", "television")),
    Scene(
        "cedar",
        64,
        5,
        "2-bed-1-bath",
        ("bread", "coffee_machine", "dresser", "egg", "laptop", "pillow", "plate", "television"),
    ),
    Scene("elder", 61, 4, "4-room-parlour", ("armchair", "dresser", "egg", "pillow", "plate", "television")),
    Scene(
        "hazel",
        67,
        6,
        "2-bed-2-bath",
        ("bowl", "coffee_machine", "dresser", "egg", "laptop", "pillow", "shelf", "television"),
    ),
    Scene("juniper", 28, 4, "4-room", ("bowl", "bread", "dresser", "laptop", "pillow", "television")),
    Scene(
        "linden", 12, 5, "5-room-parlour", ("armchair", "bowl", "coffee_machine", "laptop", "pillow", "plate", "shelf")
    ),
    Scene(
        "maple",
        10,
        7,
        "7-room-3-bed",
        ("armchair", "bread", "coffee_machine", "dresser", "laptop", "pillow", "plate", "shelf", "television"),
    ),
    Scene(
        "rowan",
        10,
        6,
        "2-bed-2-bath",
        ("armchair", "bowl", "coffee_machine", "dresser", "pillow", "plate", "shelf", "television"),
    ),
    Scene("willow", 57, 5, "2-bed-1-bath", ("bread", "laptop", "pillow", "plate", "television")),
)
"""In the order of the scene priors' table of which scene has which optional reference."""


def make_scene(scene: Scene) -> dict[str, Any]:
    """The document of one scene."""
    return generator.generate(scene.seed, scene.rooms, scene.spec, needs=scene.needs)


def main(arguments: list[str]) -> None:
    """Write all scenes."""
    folder = Path(arguments[0]) if arguments else Path(str(resources.files("hthor.houses").joinpath("data")))
    for scene in SCENES:
        generator.write(make_scene(scene), folder / f"{scene.name}.json")
        sys.stdout.write(f"{folder / scene.name}.json\n")


if __name__ == "__main__":
    main(sys.argv[1:])
