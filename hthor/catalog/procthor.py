"""Foreign assets: which of our kinds stands in for each ProcTHOR object type; ships no asset and knows no house."""

import re
from collections.abc import Container
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import HouseError
from hthor.types import Vec3

KIND_OF = {
    "AlarmClock": "alarm_clock",
    "Apple": "apple",
    "ArmChair": "armchair",
    "BaseballBat": "bat",
    "BasketBall": "basketball",
    "Bathtub": "bathtub",
    "BathtubBasin": "bathtub",
    "Bed": "bed",
    "Blinds": "curtain",
    "Book": "book",
    "Boots": "boots",
    "Bottle": "bottle",
    "Bowl": "bowl",
    "Box": "box",
    "Bread": "bread",
    "ButterKnife": "cutlery",
    "CD": "disc",
    "Candle": "candle",
    "Cart": "cart",
    "CellPhone": "phone",
    "Chair": "chair",
    "Cloth": "cloth",
    "ClothesDryer": "washing_machine",
    "CoffeeMachine": "coffee_machine",
    "CoffeeTable": "coffee_table",
    "CounterTop": "counter_top",
    "CreditCard": "card",
    "Cup": "cup",
    "Desk": "desk",
    "DeskLamp": "lamp",
    "Desktop": "computer",
    "DiningTable": "dining_table",
    "DishSponge": "sponge",
    "DogBed": "dog_bed",
    "Dresser": "dresser",
    "Dumbbell": "dumbbell",
    "Egg": "egg",
    "Faucet": "faucet",
    "FloorLamp": "floor_lamp",
    "Footstool": "stool",
    "Fork": "cutlery",
    "Fridge": "fridge",
    "GarbageBag": "bin",
    "GarbageCan": "bin",
    "HandTowel": "towel",
    "HandTowelHolder": "towel_holder",
    "HousePlant": "house_plant",
    "Kettle": "kettle",
    "KeyChain": "keys",
    "Knife": "cutlery",
    "Ladle": "cooking_spoon",
    "Laptop": "laptop",
    "LaundryHamper": "laundry_hamper",
    "Lettuce": "lettuce",
    "LightSwitch": "light_switch",
    "Microwave": "microwave",
    "Mug": "mug",
    "Newspaper": "newspaper",
    "Ottoman": "ottoman",
    "Painting": "painting",
    "Pan": "pan",
    "PaperTowelRoll": "paper_roll",
    "Pen": "pen",
    "Pencil": "pen",
    "PepperShaker": "shaker",
    "Pillow": "pillow",
    "Plate": "plate",
    "Plunger": "brush",
    "Pot": "pot",
    "Potato": "potato",
    "RemoteControl": "remote_control",
    "RoomDecor": "furniture",
    "Safe": "safe",
    "SaltShaker": "shaker",
    "ScrubBrush": "brush",
    "ShelvingUnit": "shelf",
    "Shelf": "shelf",
    "ShowerCurtain": "curtain",
    "ShowerHead": "shower_head",
    "SideTable": "side_table",
    "Sink": "sink",
    "SoapBar": "soap",
    "SoapBottle": "soap_bottle",
    "Sofa": "sofa",
    "Spatula": "cooking_spoon",
    "Spoon": "cutlery",
    "SprayBottle": "soap_bottle",
    "Statue": "statue",
    "Stool": "stool",
    "TVStand": "tv_stand",
    "TableTopDecor": "statue",
    "TeddyBear": "teddy_bear",
    "Television": "television",
    "TennisRacket": "racket",
    "TissueBox": "tissue_box",
    "Toaster": "toaster",
    "Toilet": "toilet",
    "ToiletPaper": "toilet_paper",
    "ToiletPaperHanger": "towel_holder",
    "Tomato": "tomato",
    "Towel": "towel",
    "TowelHolder": "towel_holder",
    "VacuumCleaner": "vacuum_cleaner",
    "Vase": "vase",
    "WashingMachine": "washing_machine",
    "Watch": "watch",
    "WateringCan": "watering_can",
    "WineBottle": "bottle",
}
"""Object types without a row become "object" when they can be picked up, else "furniture"."""

_ROUND_CORNERS = re.compile(r"Countertop_([LC])_")
"""ProcTHOR names its worktops by their outline: I and Island are straight, L and C go round corners."""


class Asset(Struct, frozen=True, kw_only=True):
    """A foreign asset: the kind that stands in for it, and its size (width, depth, height) [m], and variant.

    ``plan`` is its outline seen from above where that is no rectangle: "L" or "C", see `hthor.houses.worktops`.
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
    """The name of the kind that stands in for a ProcTHOR object type."""
    return KIND_OF.get(object_type, "object" if pickable else "furniture")


def read(path: Path) -> dict[str, Asset]:
    """Every asset of a ProcTHOR asset database (a JSON object: type to list of assets), by asset id.

    Assets without a bounding box are left out.

    Raises:
        HouseError: when the file is absent or is no such database.
    """
    types = _types(path)
    rows = (row for group in types.values() for row in group)
    return {row.asset_id: _asset(path, row, row.bounding_box) for row in rows if row.bounding_box is not None}


def excerpt(path: Path, ids: Container[str]) -> bytes:
    """The rows of an asset database about these assets, as a small database; raises as `read`."""
    kept = {name: [row for row in rows if row.asset_id in ids] for name, rows in _types(path).items()}
    return jsonio.pretty({name: rows for name, rows in kept.items() if rows})


def _types(path: Path) -> dict[str, list[_Row]]:
    return documents.read(path, dict[str, list[_Row]], HouseError, hint="expected a ProcTHOR asset database")


def _asset(path: Path, row: _Row, box: Any) -> Asset:
    size = (box.x, box.z, box.y)  # y is up there
    if not all(0.0 < extent < 100.0 for extent in size):
        problem = f"a size must be positive and below 100 m, got {size}"
        raise HouseError(str(path), f"{row.object_type}: {row.asset_id}.boundingBox", problem)
    kind = kind_of(row.object_type, pickable=row.primary_property == "CanPickup")
    plan = _ROUND_CORNERS.match(row.asset_id) if kind == "counter_top" else None
    return Asset(kind=kind, size=size, plan=plan[1] if plan else "")
