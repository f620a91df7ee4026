"""Which models of the library are used for which kinds.

Kinds that open are not here (no model can open), nor kinds with several shelves (objects on them would float).
"""

from typing import NamedTuple


class Pick(NamedTuple):
    """A model for a kind: its library, its folder's name, and by how many quarter turns it must be turned."""

    kind: str
    library: str
    model: str
    turns: int = 0


CC0 = "BlendSwap-CC-0"
CC_BY = "BlendSwap-CC-BY"
KATOR = "KatorLegaz"
SCOPIA = "Scopia"

LICENCES = {
    CC0: ("CC0-1.0", "https://creativecommons.org/publicdomain/zero/1.0/"),
    CC_BY: ("CC-BY-3.0", "https://creativecommons.org/licenses/by/3.0/"),
    KATOR: ("CC-BY-3.0-US", "https://creativecommons.org/licenses/by/3.0/us/"),
    SCOPIA: ("CC-BY-3.0", "https://creativecommons.org/licenses/by/3.0/"),
}
"""Licence and its web address, by library."""
FREE = "CC0-1.0"
"""The licence that requires nothing."""

_MODELS: tuple[tuple[str, str, str], ...] = (
    ("bed", CC0, "bed1 bed2 bedWithTexture"),
    ("bed", CC_BY, "lettoCloud"),
    ("sofa", CC0, "couch winchesterSofa"),
    ("sofa", CC_BY, "sofa3 couch3"),
    ("armchair", CC0, "armchair2 modernArmchair"),
    ("armchair", CC_BY, "armchair1 fotel"),
    ("chair", CC0, "chair thonet sillaBlanca osakaChair chairWithCushion"),
    ("chair", CC_BY, "kitchenChair plaidChair chair3 chair4"),
    ("dining_table", CC0, "oakTable table"),
    ("dining_table", CC_BY, "table"),
    ("coffee_table", CC0, "table"),
    ("coffee_table", SCOPIA, "saloon_table"),
    ("tv_stand", CC_BY, "tvStand"),
    ("television", CC0, "led_tv"),
    ("toilet", CC0, "toiletsUnit"),
    ("toilet", CC_BY, "modernToilet"),
    ("toaster", SCOPIA, "toaster"),
    ("lamp", CC0, "desklamp"),
    ("lamp", CC_BY, "lamp"),
    ("house_plant", CC0, "plant"),
    ("house_plant", CC_BY, "decorativePlant"),
    ("shower", CC0, "showerStall"),
    ("basketball", CC0, "basketball"),
    ("teddy_bear", CC0, "teddyBear"),
    ("cup", CC0, "plasticCup"),
    ("bottle", SCOPIA, "wine_bottle"),
    ("bottle", CC0, "yogurtBottle"),
    ("laptop", CC_BY, "laptop"),
    ("remote_control", SCOPIA, "tv-remote-control"),
)
_TURNED: tuple[Pick, ...] = (Pick("bread", CC0, "bread", 1), Pick("mug", KATOR, "coffee-mug", 1))

PICKS = (*(Pick(kind, library, name) for kind, library, names in _MODELS for name in names.split()), *_TURNED)
