"""The small things that people leave on each kind of furniture, and how often."""

from typing import Any, Literal, get_args

from msgspec import Struct

Spot = Literal["any", "back", "front", "middle", "head"]
Size = tuple[int, int, int]


class ClutterRule(Struct, frozen=True):
    """A small thing: ``kind``, ``share`` of furniture with it, ``most`` per piece, ``spot`` on it, ``size`` [cm]."""

    kind: str
    share: float
    most: int = 1
    spot: Spot = "any"
    size: Size | None = None


SCREENS: tuple[Size, ...] = ((76, 20, 50), (96, 22, 60), (110, 24, 68), (122, 24, 75))
"""Sizes [cm] of televisions, the smallest first."""


def _rules(text: str) -> tuple[ClutterRule, ...]:
    """Rules from their notation, such as ``bowl 0.3 x2, lamp 0.7 back 18x18x36``.

    After the kind and the share come, if they differ from the defaults of `ClutterRule`, the greatest number, the spot
    and the size [cm].
    """
    rules = []
    for kind, share, *more in (row.split() for row in text.split(", ")):
        facts: dict[str, Any] = {}
        for word in more:
            if word.startswith("x"):
                facts["most"] = int(word[1:])
            elif word in get_args(Spot):
                facts["spot"] = word
            else:
                facts["size"] = tuple(map(int, word.split("x")))
        rules.append(ClutterRule(kind, float(share), **facts))
    return tuple(rules)


CLUTTER_RULES: dict[str, tuple[ClutterRule, ...]] = {
    "counter_top": _rules(
        "coffee_machine 0.4 back, microwave 0.5 back, toaster 0.5 back, kettle 0.45 back, pot 0.4 back, "
        "paper_roll 0.35 back, pan 0.3, bread 0.35, bowl 0.3 x2, plate 0.35 x2, bottle 0.4 x2 back, "
        "soap_bottle 0.4 back, cup 0.45 x2, shaker 0.5 x2 back, cooking_spoon 0.35, cutlery 0.45 x3, potato 0.3 x3, "
        "egg 0.12 x2, cloth 0.25 front"
    ),
    "dining_table": _rules(
        "vase 0.4 middle, house_plant 0.2 middle 20x20x34, laptop 0.15, plate 0.5 x3, bowl 0.45 x2, bread 0.15, "
        "newspaper 0.25, bottle 0.35 x2 middle, cup 0.45 x3, candle 0.35 x2 middle, shaker 0.4 x2 middle, "
        "cutlery 0.4 x3, keys 0.15, tissue_box 0.15"
    ),
    "coffee_table": _rules(
        "newspaper 0.45, bowl 0.3, house_plant 0.2 20x20x34, vase 0.25, candle 0.4 x2, cup 0.3, phone 0.25, "
        "tissue_box 0.2, disc 0.15, keys 0.2"
    ),
    "sofa": _rules("pillow 0.85 x3 head, newspaper 0.15, phone 0.12, teddy_bear 0.06"),
    "armchair": _rules("pillow 0.4 back, newspaper 0.12"),
    "bed": _rules("pillow 1.0 x2 head, laptop 0.12, teddy_bear 0.2, newspaper 0.1, phone 0.15, cloth 0.15 front"),
    "desk": _rules(
        "laptop 0.75 front, lamp 0.7 back 18x18x36, house_plant 0.2 back 20x20x34, pen 0.75 x3, newspaper 0.2, "
        "phone 0.3, cup 0.3, bottle 0.15 back, tissue_box 0.2 back, disc 0.3 x2, card 0.25, keys 0.2, "
        "statue 0.15 back"
    ),
    "tv_stand": _rules(
        "television 1.0 middle, house_plant 0.2 20x20x34, vase 0.25, candle 0.3 x2, statue 0.25, disc 0.25 x2, "
        "alarm_clock 0.1"
    ),
    "dresser": _rules(
        "lamp 0.4 back 18x18x36, house_plant 0.25 back 20x20x34, vase 0.3 back, statue 0.25 back, alarm_clock 0.25, "
        "tissue_box 0.2, candle 0.35 x2, phone 0.2, watch 0.25, keys 0.2, disc 0.15"
    ),
    "side_table": _rules("lamp 0.75 back 18x18x36, alarm_clock 0.4, phone 0.25, watch 0.15, candle 0.2, pen 0.15"),
    "shelf": _rules(
        "box 0.6 x2 28x24x18, house_plant 0.35 18x18x28, vase 0.5 x2, statue 0.5 x2, teddy_bear 0.15, "
        "basketball 0.12, bowl 0.15, alarm_clock 0.2, candle 0.3 x2, disc 0.25 x2, newspaper 0.2"
    ),
    "fridge": _rules("pot 0.2, bowl 0.2, bottle 0.6 x3, egg 0.6 x3, potato 0.3 x2"),
    "washing_machine": _rules("soap_bottle 0.6 x2 back, cloth 0.5, toilet_paper 0.6 x2 back"),
    "cart": _rules("bottle 0.5 x2, cup 0.4 x2, bowl 0.3, paper_roll 0.3"),
    "sink": _rules("sponge 0.4 back, cup 0.12 back"),
    "bathtub": _rules("soap 0.3 middle"),
    "ottoman": _rules("newspaper 0.25"),
    "stool": (),
    "chair": (),
}
BATHROOM: dict[str, tuple[ClutterRule, ...]] = {
    "sink": _rules("soap 0.25 back"),
    "side_table": _rules("candle 0.5 x2, soap_bottle 0.6, toilet_paper 0.7, cloth 0.2"),
}
"""Rules for bathrooms, which replace the rules above."""
MAX_COUNT = {"coffee_machine": 1, "microwave": 1, "toaster": 1, "kettle": 1, "paper_roll": 1, "laptop": 3, "pan": 1}
"""The greatest number of things of a kind in a house."""
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
"""The furniture on which a small thing is put that the house must have."""
