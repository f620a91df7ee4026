"""The houses that robots are trained, tuned and tested in: made from seeds, in three splits that share no house."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Literal

from hthor import jsonio, seeds
from hthor.errors import HthorError, UnknownName
from hthor.houses import generator, loader, schema
from hthor.houses.assets import Assets
from hthor.tasks.arrangement.target_arrangement import arrange
from hthor.types import HouseSpec, Placement

Split = Literal["train", "validation", "test"]
SPLITS: tuple[Split, ...] = ("train", "validation", "test")
_FIRST_SEED: dict[str, int] = {"train": 1_000_000, "validation": 2_000_000, "test": 3_000_000}
MOST = 100_000
"""The most houses in a split."""
ROOMS = (4, 5, 6, 7)
"""Numbers of rooms, in turn."""


@functools.lru_cache(maxsize=8)
def make_house(split: str, number: int) -> HouseSpec:
    """House ``number`` of a split, from 0. The same number always gives the same house.

    Raises:
        UnknownName: when there is no such split. HthorError: when the number is out of range, or gives no house.
    """
    if split not in SPLITS:
        raise UnknownName("split", split, SPLITS)
    if not 0 <= number < MOST:
        raise HthorError(f"a split has the houses 0 to {MOST - 1}, got {number}")
    seed, name = _FIRST_SEED[split] + number, f"{split}-{number:05d}"
    document = generator.generate(seed, ROOMS[number % len(ROOMS)])
    house = schema.convert_document(document, name)
    return loader.convert_house(house, name, jsonio.sha256(document), name, Assets(Path(name)))


def make_arrangement(house: HouseSpec, number: int) -> tuple[Placement, ...]:
    """Arrangement ``number`` of the things to bring, by the scene priors.

    Raises:
        HthorError: when one of them has no place in the house.
    """
    return arrange(house, seeds.derive(0, "train", house.id, number))
