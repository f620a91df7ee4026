"""Kinds that represent the object types of ProcTHOR; contains no assets and does not read houses."""

import re
from collections.abc import Container
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import HouseError
from hthor.types import Vec3

_NAMED_ALIKE = """
    AlarmClock Apple Bathtub Bed Book Boots Bottle Bowl Box Bread Candle Cart Chair Cloth CoffeeMachine CoffeeTable
    CounterTop Cup Desk DiningTable DogBed Dresser Dumbbell Egg Faucet FloorLamp Fridge HousePlant Kettle Laptop
    LaundryHamper Lettuce LightSwitch Microwave Mug Newspaper Ottoman Painting Pan Pen Pillow Plate Pot Potato
    RemoteControl Safe ShowerHead SideTable Sink SoapBottle Sofa Statue TeddyBear Television TissueBox Toaster
    Toilet ToiletPaper Tomato VacuumCleaner Vase Watch WateringCan
"""
"""Object types that have the same names as our kinds, in another spelling."""
KIND_OF = {
    **{name: re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower() for name in _NAMED_ALIKE.split()},
    "ArmChair": "armchair",
    "BaseballBat": "bat",
    "BasketBall": "basketball",
    "BathtubBasin": "bathtub",
    "Blinds": "curtain",
    "ButterKnife": "cutlery",
    "CD": "disc",
    "CellPhone": "phone",
    "ClothesDryer": "washing_machine",
    "CreditCard": "card",
    "DeskLamp": "lamp",
    "Desktop": "computer",
    "DishSponge": "sponge",
    "Footstool": "stool",
    "Fork": "cutlery",
    "GarbageBag": "bin",
    "GarbageCan": "bin",
    "HandTowel": "towel",
    "HandTowelHolder": "towel_holder",
    "KeyChain": "keys",
    "Knife": "cutlery",
    "Ladle": "cooking_spoon",
    "PaperTowelRoll": "paper_roll",
    "Pencil": "pen",
    "PepperShaker": "shaker",
    "Plunger": "brush",
    "RoomDecor": "furniture",
    "SaltShaker": "shaker",
    "ScrubBrush": "brush",
    "ShelvingUnit": "shelf",
    "Shelf": "shelf",
    "ShowerCurtain": "curtain",
    "SoapBar": "soap",
    "Spatula": "cooking_spoon",
    "Spoon": "cutlery",
    "SprayBottle": "soap_bottle",
    "Stool": "stool",
    "TVStand": "tv_stand",
    "TableTopDecor": "statue",
    "TennisRacket": "racket",
    "ToiletPaperHanger": "towel_holder",
    "Towel": "towel",
    "TowelHolder": "towel_holder",
    "WashingMachine": "washing_machine",
    "WineBottle": "bottle",
}
"""The kind for each object type; other types become "object" if they can be picked up, else "furniture"."""

_ROUND_CORNERS = re.compile(r"Countertop_([LC])_")
"""ProcTHOR names its worktops by their outline: I and Island are straight; L and C go round corners."""


class Asset(Struct, frozen=True, kw_only=True):
    """An asset of ProcTHOR: the kind that represents it, its size (width, depth, height) [m], and its variant.

    ``plan`` is its outline from above if that is not a rectangle: "L" or "C", see `hthor.houses.loader`.
    """

    kind: str
    size: Vec3
    variant: int = 0
    plan: str = ""


class _Box(Struct):
    x: float
    y: float
    z: float


class _Row(Struct, rename="camel"):
    asset_id: str
    object_type: str
    bounding_box: _Box | None = None
    primary_property: str | None = None


def kind_of(object_type: str, *, pickable: bool) -> str:
    """The name of the kind that represents a ProcTHOR object type."""
    return KIND_OF.get(object_type, "object" if pickable else "furniture")


def read(path: Path) -> dict[str, Asset]:
    """Every asset of a ProcTHOR asset database (a JSON object: type to list of assets), by asset id.

    Assets without a bounding box are left out.

    Raises:
        HouseError: when the file does not exist or is not such a database.
    """
    types = _types(path)
    rows = (row for group in types.values() for row in group)
    return {row.asset_id: _asset(path, row, row.bounding_box) for row in rows if row.bounding_box is not None}


def excerpt(path: Path, ids: Container[str]) -> bytes:
    """The rows of these assets from an asset database, as a smaller database; raises as `read` does."""
    kept = {name: [row for row in rows if row.asset_id in ids] for name, rows in _types(path).items()}
    return jsonio.pretty({name: rows for name, rows in kept.items() if rows})


def _types(path: Path) -> dict[str, list[_Row]]:
    return documents.read(path, dict[str, list[_Row]], HouseError, hint="expected a ProcTHOR asset database")


def _asset(path: Path, row: _Row, box: Any) -> Asset:
    size = (box.x, box.z, box.y)  # in ProcTHOR y is up
    if not all(0.0 < extent < 100.0 for extent in size):
        problem = f"a size must be positive and below 100 m, got {size}"
        raise HouseError(str(path), f"{row.object_type}: {row.asset_id}.boundingBox", problem)
    kind = kind_of(row.object_type, pickable=row.primary_property == "CanPickup")
    plan = _ROUND_CORNERS.match(row.asset_id) if kind == "counter_top" else None
    return Asset(kind=kind, size=size, plan=plan[1] if plan else "")
