"""What people leave where: for each kind of furniture the small things on it and how often."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

Spot = Literal["any", "back", "front", "middle", "head"]
Size = tuple[int, int, int]


class Habit(Struct, frozen=True):
    """A small thing: its ``kind``, the ``share`` of places that have one, ``most`` of them, where, its size [cm]."""

    kind: str
    share: float
    most: int = 1
    spot: Spot = "any"
    size: Size | None = None


SCREENS: tuple[Size, ...] = ((76, 20, 50), (96, 22, 60), (110, 24, 68), (122, 24, 75))
"""Sizes [cm] of televisions, the smallest first."""
_PLANT: Size = (20, 20, 34)
_LAMP: Size = (18, 18, 36)
_BOX: Size = (28, 24, 18)

HABITS: dict[str, tuple[Habit, ...]] = {
    "counter_top": (
        Habit("coffee_machine", 0.4, 1, "back"),
        Habit("microwave", 0.5, 1, "back"),
        Habit("toaster", 0.5, 1, "back"),
        Habit("kettle", 0.45, 1, "back"),
        Habit("pot", 0.4, 1, "back"),
        Habit("paper_roll", 0.35, 1, "back"),
        Habit("pan", 0.3),
        Habit("bread", 0.35),
        Habit("bowl", 0.3, 2),
        Habit("plate", 0.35, 2),
        Habit("bottle", 0.4, 2, "back"),
        Habit("soap_bottle", 0.4, 1, "back"),
        Habit("cup", 0.45, 2),
        Habit("shaker", 0.5, 2, "back"),
        Habit("cooking_spoon", 0.35),
        Habit("cutlery", 0.45, 3),
        Habit("potato", 0.3, 3),
        Habit("egg", 0.12, 2),
        Habit("cloth", 0.25, 1, "front"),
    ),
    "dining_table": (
        Habit("vase", 0.4, 1, "middle"),
        Habit("house_plant", 0.2, 1, "middle", _PLANT),
        Habit("laptop", 0.15),
        Habit("plate", 0.5, 3),
        Habit("bowl", 0.45, 2),
        Habit("bread", 0.15),
        Habit("newspaper", 0.25),
        Habit("bottle", 0.35, 2, "middle"),
        Habit("cup", 0.45, 3),
        Habit("candle", 0.35, 2, "middle"),
        Habit("shaker", 0.4, 2, "middle"),
        Habit("cutlery", 0.4, 3),
        Habit("keys", 0.15),
        Habit("tissue_box", 0.15),
    ),
    "coffee_table": (
        Habit("newspaper", 0.45),
        Habit("bowl", 0.3),
        Habit("house_plant", 0.2, 1, "any", _PLANT),
        Habit("vase", 0.25),
        Habit("candle", 0.4, 2),
        Habit("cup", 0.3),
        Habit("phone", 0.25),
        Habit("tissue_box", 0.2),
        Habit("disc", 0.15),
        Habit("keys", 0.2),
    ),
    "sofa": (
        Habit("pillow", 0.85, 3, "head"),
        Habit("newspaper", 0.15),
        Habit("phone", 0.12),
        Habit("teddy_bear", 0.06),
    ),
    "armchair": (Habit("pillow", 0.4, 1, "back"), Habit("newspaper", 0.12)),
    "bed": (
        Habit("pillow", 1.0, 2, "head"),
        Habit("laptop", 0.12),
        Habit("teddy_bear", 0.2),
        Habit("newspaper", 0.1),
        Habit("phone", 0.15),
        Habit("cloth", 0.15, 1, "front"),
    ),
    "desk": (
        Habit("laptop", 0.75, 1, "front"),
        Habit("lamp", 0.7, 1, "back", _LAMP),
        Habit("house_plant", 0.2, 1, "back", _PLANT),
        Habit("pen", 0.75, 3),
        Habit("newspaper", 0.2),
        Habit("phone", 0.3),
        Habit("cup", 0.3),
        Habit("bottle", 0.15, 1, "back"),
        Habit("tissue_box", 0.2, 1, "back"),
        Habit("disc", 0.3, 2),
        Habit("card", 0.25),
        Habit("keys", 0.2),
        Habit("statue", 0.15, 1, "back"),
    ),
    "tv_stand": (
        Habit("television", 1.0, 1, "middle"),
        Habit("house_plant", 0.2, 1, "any", _PLANT),
        Habit("vase", 0.25),
        Habit("candle", 0.3, 2),
        Habit("statue", 0.25),
        Habit("disc", 0.25, 2),
        Habit("alarm_clock", 0.1),
    ),
    "dresser": (
        Habit("lamp", 0.4, 1, "back", _LAMP),
        Habit("house_plant", 0.25, 1, "back", _PLANT),
        Habit("vase", 0.3, 1, "back"),
        Habit("statue", 0.25, 1, "back"),
        Habit("alarm_clock", 0.25),
        Habit("tissue_box", 0.2),
        Habit("candle", 0.35, 2),
        Habit("phone", 0.2),
        Habit("watch", 0.25),
        Habit("keys", 0.2),
        Habit("disc", 0.15),
    ),
    "side_table": (
        Habit("lamp", 0.75, 1, "back", _LAMP),
        Habit("alarm_clock", 0.4),
        Habit("phone", 0.25),
        Habit("watch", 0.15),
        Habit("candle", 0.2),
        Habit("pen", 0.15),
    ),
    "shelf": (
        Habit("box", 0.6, 2, "any", _BOX),
        Habit("house_plant", 0.35, 1, "any", (18, 18, 28)),
        Habit("vase", 0.5, 2),
        Habit("statue", 0.5, 2),
        Habit("teddy_bear", 0.15),
        Habit("basketball", 0.12),
        Habit("bowl", 0.15),
        Habit("alarm_clock", 0.2),
        Habit("candle", 0.3, 2),
        Habit("disc", 0.25, 2),
        Habit("newspaper", 0.2),
    ),
    "fridge": (
        Habit("pot", 0.2),
        Habit("bowl", 0.2),
        Habit("bottle", 0.6, 3),
        Habit("egg", 0.6, 3),
        Habit("potato", 0.3, 2),
    ),
    "washing_machine": (
        Habit("soap_bottle", 0.6, 2, "back"),
        Habit("cloth", 0.5),
        Habit("toilet_paper", 0.6, 2, "back"),
    ),
    "cart": (Habit("bottle", 0.5, 2), Habit("cup", 0.4, 2), Habit("bowl", 0.3), Habit("paper_roll", 0.3)),
    "sink": (Habit("sponge", 0.4, 1, "back"), Habit("cup", 0.12, 1, "back")),
    "bathtub": (Habit("soap", 0.3, 1, "middle"),),
    "ottoman": (Habit("newspaper", 0.25),),
    "stool": (),
    "chair": (),
}
BATHROOM: dict[str, tuple[Habit, ...]] = {
    "sink": (Habit("soap", 0.25, 1, "back"),),
    "side_table": (Habit("candle", 0.5, 2), Habit("soap_bottle", 0.6), Habit("toilet_paper", 0.7), Habit("cloth", 0.2)),
}
"""What differs in bathrooms."""
MOST = {"coffee_machine": 1, "microwave": 1, "toaster": 1, "kettle": 1, "paper_roll": 1, "laptop": 3, "pan": 1}
"""How many of a kind a house has at most."""
HOMES: dict[str, tuple[str, ...]] = {
    "television": ("tv_stand",),
    "pillow": ("bed", "sofa"),
    "laptop": ("desk", "dining_table", "coffee_table", "bed"),
    "bowl": ("dining_table", "counter_top", "coffee_table"),
    "plate": ("dining_table", "counter_top"),
    "bread": ("counter_top", "dining_table"),
    "egg": ("fridge", "counter_top"),
    "coffee_machine": ("counter_top",),
}
"""Where a small thing that the house must have goes."""
