"""What people leave where: for each kind of furniture the small things on it and how often."""

from typing import Literal

from msgspec import Struct

Spot = Literal["any", "back", "front", "middle", "head"]
Size = tuple[int, int, int]


class ClutterRule(Struct, frozen=True):
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

CLUTTER_RULES: dict[str, tuple[ClutterRule, ...]] = {
    "counter_top": (
        ClutterRule("coffee_machine", 0.4, 1, "back"),
        ClutterRule("microwave", 0.5, 1, "back"),
        ClutterRule("toaster", 0.5, 1, "back"),
        ClutterRule("kettle", 0.45, 1, "back"),
        ClutterRule("pot", 0.4, 1, "back"),
        ClutterRule("paper_roll", 0.35, 1, "back"),
        ClutterRule("pan", 0.3),
        ClutterRule("bread", 0.35),
        ClutterRule("bowl", 0.3, 2),
        ClutterRule("plate", 0.35, 2),
        ClutterRule("bottle", 0.4, 2, "back"),
        ClutterRule("soap_bottle", 0.4, 1, "back"),
        ClutterRule("cup", 0.45, 2),
        ClutterRule("shaker", 0.5, 2, "back"),
        ClutterRule("cooking_spoon", 0.35),
        ClutterRule("cutlery", 0.45, 3),
        ClutterRule("potato", 0.3, 3),
        ClutterRule("egg", 0.12, 2),
        ClutterRule("cloth", 0.25, 1, "front"),
    ),
    "dining_table": (
        ClutterRule("vase", 0.4, 1, "middle"),
        ClutterRule("house_plant", 0.2, 1, "middle", _PLANT),
        ClutterRule("laptop", 0.15),
        ClutterRule("plate", 0.5, 3),
        ClutterRule("bowl", 0.45, 2),
        ClutterRule("bread", 0.15),
        ClutterRule("newspaper", 0.25),
        ClutterRule("bottle", 0.35, 2, "middle"),
        ClutterRule("cup", 0.45, 3),
        ClutterRule("candle", 0.35, 2, "middle"),
        ClutterRule("shaker", 0.4, 2, "middle"),
        ClutterRule("cutlery", 0.4, 3),
        ClutterRule("keys", 0.15),
        ClutterRule("tissue_box", 0.15),
    ),
    "coffee_table": (
        ClutterRule("newspaper", 0.45),
        ClutterRule("bowl", 0.3),
        ClutterRule("house_plant", 0.2, 1, "any", _PLANT),
        ClutterRule("vase", 0.25),
        ClutterRule("candle", 0.4, 2),
        ClutterRule("cup", 0.3),
        ClutterRule("phone", 0.25),
        ClutterRule("tissue_box", 0.2),
        ClutterRule("disc", 0.15),
        ClutterRule("keys", 0.2),
    ),
    "sofa": (
        ClutterRule("pillow", 0.85, 3, "head"),
        ClutterRule("newspaper", 0.15),
        ClutterRule("phone", 0.12),
        ClutterRule("teddy_bear", 0.06),
    ),
    "armchair": (ClutterRule("pillow", 0.4, 1, "back"), ClutterRule("newspaper", 0.12)),
    "bed": (
        ClutterRule("pillow", 1.0, 2, "head"),
        ClutterRule("laptop", 0.12),
        ClutterRule("teddy_bear", 0.2),
        ClutterRule("newspaper", 0.1),
        ClutterRule("phone", 0.15),
        ClutterRule("cloth", 0.15, 1, "front"),
    ),
    "desk": (
        ClutterRule("laptop", 0.75, 1, "front"),
        ClutterRule("lamp", 0.7, 1, "back", _LAMP),
        ClutterRule("house_plant", 0.2, 1, "back", _PLANT),
        ClutterRule("pen", 0.75, 3),
        ClutterRule("newspaper", 0.2),
        ClutterRule("phone", 0.3),
        ClutterRule("cup", 0.3),
        ClutterRule("bottle", 0.15, 1, "back"),
        ClutterRule("tissue_box", 0.2, 1, "back"),
        ClutterRule("disc", 0.3, 2),
        ClutterRule("card", 0.25),
        ClutterRule("keys", 0.2),
        ClutterRule("statue", 0.15, 1, "back"),
    ),
    "tv_stand": (
        ClutterRule("television", 1.0, 1, "middle"),
        ClutterRule("house_plant", 0.2, 1, "any", _PLANT),
        ClutterRule("vase", 0.25),
        ClutterRule("candle", 0.3, 2),
        ClutterRule("statue", 0.25),
        ClutterRule("disc", 0.25, 2),
        ClutterRule("alarm_clock", 0.1),
    ),
    "dresser": (
        ClutterRule("lamp", 0.4, 1, "back", _LAMP),
        ClutterRule("house_plant", 0.25, 1, "back", _PLANT),
        ClutterRule("vase", 0.3, 1, "back"),
        ClutterRule("statue", 0.25, 1, "back"),
        ClutterRule("alarm_clock", 0.25),
        ClutterRule("tissue_box", 0.2),
        ClutterRule("candle", 0.35, 2),
        ClutterRule("phone", 0.2),
        ClutterRule("watch", 0.25),
        ClutterRule("keys", 0.2),
        ClutterRule("disc", 0.15),
    ),
    "side_table": (
        ClutterRule("lamp", 0.75, 1, "back", _LAMP),
        ClutterRule("alarm_clock", 0.4),
        ClutterRule("phone", 0.25),
        ClutterRule("watch", 0.15),
        ClutterRule("candle", 0.2),
        ClutterRule("pen", 0.15),
    ),
    "shelf": (
        ClutterRule("box", 0.6, 2, "any", _BOX),
        ClutterRule("house_plant", 0.35, 1, "any", (18, 18, 28)),
        ClutterRule("vase", 0.5, 2),
        ClutterRule("statue", 0.5, 2),
        ClutterRule("teddy_bear", 0.15),
        ClutterRule("basketball", 0.12),
        ClutterRule("bowl", 0.15),
        ClutterRule("alarm_clock", 0.2),
        ClutterRule("candle", 0.3, 2),
        ClutterRule("disc", 0.25, 2),
        ClutterRule("newspaper", 0.2),
    ),
    "fridge": (
        ClutterRule("pot", 0.2),
        ClutterRule("bowl", 0.2),
        ClutterRule("bottle", 0.6, 3),
        ClutterRule("egg", 0.6, 3),
        ClutterRule("potato", 0.3, 2),
    ),
    "washing_machine": (
        ClutterRule("soap_bottle", 0.6, 2, "back"),
        ClutterRule("cloth", 0.5),
        ClutterRule("toilet_paper", 0.6, 2, "back"),
    ),
    "cart": (
        ClutterRule("bottle", 0.5, 2),
        ClutterRule("cup", 0.4, 2),
        ClutterRule("bowl", 0.3),
        ClutterRule("paper_roll", 0.3),
    ),
    "sink": (ClutterRule("sponge", 0.4, 1, "back"), ClutterRule("cup", 0.12, 1, "back")),
    "bathtub": (ClutterRule("soap", 0.3, 1, "middle"),),
    "ottoman": (ClutterRule("newspaper", 0.25),),
    "stool": (),
    "chair": (),
}
BATHROOM: dict[str, tuple[ClutterRule, ...]] = {
    "sink": (ClutterRule("soap", 0.25, 1, "back"),),
    "side_table": (
        ClutterRule("candle", 0.5, 2),
        ClutterRule("soap_bottle", 0.6),
        ClutterRule("toilet_paper", 0.7),
        ClutterRule("cloth", 0.2),
    ),
}
"""What differs in bathrooms."""
MAX_COUNT = {"coffee_machine": 1, "microwave": 1, "toaster": 1, "kettle": 1, "paper_roll": 1, "laptop": 3, "pan": 1}
"""How many of a kind a house has at most."""
USUAL_PLACES: dict[str, tuple[str, ...]] = {
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
