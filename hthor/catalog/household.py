"""Household things that are neither benchmark receptacles nor targets, one row a kind.

To add a kind, add a row: a look of its own (`hthor.looks.build`) is optional, and without one its solids are drawn.
"""

from functools import partial
from typing import Any

from hthor.catalog import appliances, cabinets, fixtures, props, shapes
from hthor.catalog import colors as c
from hthor.catalog.kind import Kind, Shape
from hthor.types import Rgba, Vec3

Finishes = tuple[dict[str, Rgba], ...]


def _kind(name: str, size: Vec3, mass: float, shape: Shape, title: str, **more: Any) -> Kind:
    words = title or name.replace("_", " ")
    return Kind(name=name, title=words, family="household", size=size, mass=mass, shape=shape, **more)


def _stands(name: str, size: Vec3, mass: float, shape: Shape, title: str = "", finishes: Finishes = ()) -> Kind:
    return _kind(name, size, mass, shape, title, finishes=finishes)


def _holds(name: str, size: Vec3, mass: float, shape: Shape, title: str = "", finishes: Finishes = ()) -> Kind:
    return _kind(name, size, mass, shape, title, finishes=finishes, relation="in")


def _hangs(name: str, size: Vec3, mass: float, shape: Shape, title: str = "", finishes: Finishes = ()) -> Kind:
    return _kind(name, size, mass, shape, title, finishes=finishes, wall_mounted=True)


def _small(name: str, size: Vec3, mass: float, shape: Shape, title: str = "", finishes: Finishes = ()) -> Kind:
    return _kind(name, size, mass, shape, title, finishes=finishes, pickable=True)


def _paints(keyword: str, *colors: Rgba) -> Finishes:
    """Finishes that change one color."""
    return tuple({keyword: rgba} for rgba in colors)


_SEATS: Finishes = (
    {"fabric": c.GREY, "cushion": c.LINEN},
    {"fabric": c.TEAL, "cushion": c.SAGE},
    {"fabric": c.MUSTARD, "cushion": c.CREAM},
    {"fabric": c.BLUE, "cushion": c.SKY},
)
_CHAIRS: Finishes = (
    {"wood": c.WALNUT, "seat": c.CREAM},
    {"wood": c.WHITE, "seat": c.OAK},
    {"wood": c.IRON, "seat": c.GREY},
)
_CHESTS: Finishes = (
    {"body": c.OAK, "fronts": c.BIRCH},
    {"body": c.WALNUT, "fronts": c.WALNUT},
    {"body": c.IRON, "fronts": c.GREY},
)
_STANDS: Finishes = (
    {"wood": c.WALNUT, "front": c.WALNUT},
    {"wood": c.WHITE, "front": c.CREAM},
    {"wood": c.BIRCH, "front": c.WHITE},
)
_CUPBOARDS: Finishes = (
    {"body": c.OAK, "inner": c.BIRCH},
    {"body": c.WALNUT, "inner": c.OAK},
    {"body": c.SAGE, "inner": c.WHITE},
)
_KITCHENS: Finishes = (
    {"body": c.WHITE, "inner": c.WHITE},
    {"body": c.BLUE, "inner": c.WHITE},
    {"body": c.OAK, "inner": c.BIRCH},
)
"""The last is for wall cabinets: variant n goes with variant n of the counter tops."""

_FURNITURE = (
    _stands("chair", (0.45, 0.5, 0.9), 5.0, partial(shapes.chair, wood=c.OAK, seat=c.BIRCH), "", _CHAIRS),
    _stands(
        "armchair",
        (0.85, 0.85, 0.85),
        22.0,
        partial(shapes.sofa, fabric=c.RUST, cushion=c.TERRACOTTA, seats=1),
        finishes=_SEATS,
    ),
    _stands("stool", (0.36, 0.36, 0.48), 3.5, partial(shapes.stool, seat=c.OAK, legs=c.IRON)),
    _stands(
        "ottoman",
        (0.7, 0.5, 0.42),
        8.0,
        partial(shapes.ottoman, fabric=c.LINEN),
        finishes=_paints("fabric", c.TEAL, c.GREY, c.RUST),
    ),
    _stands(
        "shelf",
        (0.85, 0.32, 1.9),
        30.0,
        partial(shapes.shelf, wood=c.OAK),
        finishes=_paints("wood", c.WALNUT, c.WHITE, c.BIRCH),
    ),
    _stands("dresser", (1.1, 0.48, 0.82), 40.0, partial(cabinets.dresser, body=c.WHITE, fronts=c.CREAM), "", _CHESTS),
    _stands("side_table", (0.45, 0.42, 0.52), 9.0, partial(cabinets.nightstand, wood=c.OAK, front=c.OAK), "", _STANDS),
    _holds("wardrobe", (1.2, 0.6, 2.0), 75.0, partial(cabinets.wardrobe, body=c.WHITE, inner=c.BIRCH), "", _CUPBOARDS),
    _stands(
        "rug",
        (2.0, 1.4, 0.01),
        6.0,
        partial(props.block, rgba=c.LINEN),
        finishes=_paints("rgba", c.RUST, c.BLUE, c.SAGE, c.GREY, c.TERRACOTTA),
    ),
    _stands("cart", (0.7, 0.45, 0.9), 12.0, partial(shapes.low_table, wood=c.STEEL, legs=c.IRON)),
    _stands("furniture", (0.6, 0.5, 0.8), 20.0, partial(props.block, rgba=c.LINEN), "piece of furniture"),
)

_FIXTURES = (
    _holds("sink", (0.8, 0.6, 1.08), 35.0, partial(fixtures.sink, body=c.WHITE, basin=c.STEEL)),
    _stands("toilet", (0.42, 0.68, 0.8), 30.0, partial(fixtures.toilet, body=c.WHITE)),
    _holds("bathtub", (0.75, 1.65, 0.56), 60.0, partial(fixtures.bathtub, body=c.WHITE)),
    _stands("shower", (0.9, 0.9, 2.05), 50.0, partial(fixtures.shower, tray=c.WHITE)),
    _stands("washing_machine", (0.6, 0.6, 0.85), 65.0, partial(appliances.washer, body=c.WHITE, glass=c.GREY)),
    _stands("coffee_machine", (0.24, 0.34, 0.36), 4.0, partial(fixtures.coffee_machine, body=c.IRON)),
    _stands("stove", (0.6, 0.62, 0.9), 50.0, partial(appliances.stove, body=c.STEEL, glass=c.BLACK)),
    _holds("microwave", (0.48, 0.36, 0.28), 12.0, partial(appliances.oven_front, body=c.STEEL, glass=c.BLACK)),
    _stands("toaster", (0.28, 0.18, 0.19), 1.5, partial(props.block, rgba=c.STEEL)),
    _holds("safe", (0.4, 0.4, 0.4), 30.0, partial(appliances.oven_front, body=c.IRON, glass=c.GREY)),
    _stands("television", (1.1, 0.24, 0.68), 14.0, partial(props.television, body=c.BLACK, screen=c.IRON)),
    _stands("computer", (0.6, 0.22, 0.46), 6.0, partial(props.television, body=c.IRON, screen=c.BLUE)),
    _stands("lamp", (0.26, 0.26, 0.42), 1.5, partial(props.lamp, metal=c.IRON, shade=c.SHADE, hood=0.45)),
    _stands("floor_lamp", (0.42, 0.42, 1.62), 6.0, partial(props.lamp, metal=c.IRON, shade=c.SHADE, hood=0.2)),
    _stands("house_plant", (0.5, 0.5, 0.95), 7.0, partial(props.plant, pot=c.TERRACOTTA, leaf=c.LEAF), "house plant"),
    _stands("bin", (0.3, 0.3, 0.42), 1.5, partial(props.bin_, body=c.GREY, rim=c.IRON)),
    _stands("laundry_hamper", (0.42, 0.36, 0.6), 2.0, partial(props.bin_, body=c.LINEN, rim=c.OAK)),
    _stands("dog_bed", (0.75, 0.6, 0.14), 2.0, partial(props.cushion, fabric=c.RUST)),
    _stands("vacuum_cleaner", (0.32, 0.32, 1.05), 5.0, partial(props.lamp, metal=c.IRON, shade=c.RED, hood=0.3)),
    _hangs("painting", (0.8, 0.04, 0.6), 3.0, partial(props.painting, frame=c.WALNUT, sky=c.SKY, land=c.SAGE)),
    _hangs(
        "curtain",
        (1.4, 0.08, 1.6),
        2.0,
        partial(props.block, rgba=c.LINEN),
        finishes=_paints("rgba", c.SAGE, c.SKY, c.TERRACOTTA, c.GREY),
    ),
    Kind(
        name="kitchen_cabinet",
        title="kitchen cabinet",
        family="household",
        size=(0.8, 0.35, 0.7),
        mass=18.0,
        shape=partial(cabinets.wall_cabinet, body=c.SAGE, inner=c.WHITE),
        wall_mounted=True,
        relation="in",
        finishes=_KITCHENS,
    ),
    _hangs("range_hood", (0.6, 0.48, 0.6), 12.0, partial(appliances.range_hood, body=c.STEEL)),
    _hangs(
        "mirror",
        (0.6, 0.04, 0.9),
        6.0,
        partial(props.mirror, frame=c.OAK, glass=c.MIRROR),
        finishes=_paints("frame", c.IRON, c.WHITE, c.WALNUT),
    ),
    _hangs("clock", (0.3, 0.05, 0.3), 0.8, partial(props.clock, rim=c.IRON, face=c.WHITE)),
    _hangs("light_switch", (0.08, 0.02, 0.12), 0.1, partial(props.block, rgba=c.WHITE)),
    _hangs("shower_head", (0.2, 0.25, 0.3), 0.6, partial(props.block, rgba=c.STEEL)),
    _hangs("faucet", (0.06, 0.2, 0.2), 1.0, partial(props.block, rgba=c.STEEL)),
    _hangs("towel_holder", (0.55, 0.08, 0.05), 0.6, partial(props.block, rgba=c.STEEL)),
    _hangs(
        "towel",
        (0.5, 0.04, 0.6),
        0.4,
        partial(props.block, rgba=c.SKY),
        finishes=_paints("rgba", c.WHITE, c.SAGE, c.TERRACOTTA),
    ),
)

_SMALL = (
    _small("bowl", (0.2, 0.2, 0.08), 0.4, partial(props.stack, low=c.TEAL, high=c.TEAL, split=0.35, narrow=0.6)),
    _small("plate", (0.24, 0.24, 0.022), 0.4, partial(props.plate, glaze=c.WHITE)),
    _small("cup", (0.08, 0.08, 0.1), 0.2, partial(props.ball, rgba=c.WHITE)),
    _small("pot", (0.24, 0.24, 0.16), 1.2, partial(props.stack, low=c.STEEL, high=c.IRON, split=0.9, narrow=0.96)),
    _small("pan", (0.26, 0.44, 0.06), 1.0, partial(props.pan, metal=c.IRON, handle=c.BLACK)),
    _small("kettle", (0.18, 0.18, 0.22), 0.9, partial(props.stack, low=c.STEEL, high=c.STEEL, split=0.5, narrow=0.8)),
    _small("bread", (0.13, 0.26, 0.11), 0.6, partial(props.loaf, crust=c.CRUST)),
    _small("egg", (0.05, 0.05, 0.05), 0.06, partial(props.ball, rgba=c.SHELL)),
    _small("potato", (0.07, 0.07, 0.07), 0.2, partial(props.ball, rgba=c.CRUST)),
    _small("bottle", (0.08, 0.08, 0.28), 0.8, partial(props.bottle, glass=c.BOTTLE, cap=c.WHITE)),
    _small("soap_bottle", (0.07, 0.07, 0.19), 0.3, partial(props.bottle, glass=c.SKY, cap=c.WHITE)),
    _small("shaker", (0.045, 0.045, 0.1), 0.1, partial(props.bottle, glass=c.WHITE, cap=c.STEEL)),
    _small("cutlery", (0.025, 0.2, 0.012), 0.05, partial(props.block, rgba=c.STEEL)),
    _small("cooking_spoon", (0.06, 0.3, 0.03), 0.1, partial(props.block, rgba=c.WALNUT)),
    _small("laptop", (0.34, 0.25, 0.22), 1.6, partial(props.laptop, body=c.GREY, screen=c.BLUE)),
    _small("phone", (0.075, 0.15, 0.01), 0.18, partial(props.block, rgba=c.BLACK)),
    _small("pen", (0.01, 0.15, 0.01), 0.01, partial(props.block, rgba=c.BLUE)),
    _small("card", (0.09, 0.055, 0.002), 0.01, partial(props.block, rgba=c.MUSTARD)),
    _small("disc", (0.12, 0.12, 0.003), 0.02, partial(props.ball, rgba=c.STEEL)),
    _small("keys", (0.1, 0.06, 0.012), 0.08, partial(props.block, rgba=c.STEEL)),
    _small("watch", (0.08, 0.05, 0.04), 0.1, partial(props.block, rgba=c.IRON)),
    _small("newspaper", (0.3, 0.22, 0.015), 0.2, partial(props.block, rgba=c.PAPER)),
    _small("alarm_clock", (0.14, 0.08, 0.16), 0.3, partial(props.block, rgba=c.RED)),
    _small(
        "pillow",
        (0.55, 0.38, 0.13),
        0.6,
        partial(props.cushion, fabric=c.CREAM),
        finishes=_paints("fabric", c.TEAL, c.MUSTARD, c.RUST, c.SKY),
    ),
    _small("teddy_bear", (0.3, 0.25, 0.35), 0.4, partial(props.figure, rgba=c.CRUST)),
    _small("statue", (0.16, 0.14, 0.24), 1.0, partial(props.figure, rgba=c.STONE)),
    _small("vase", (0.12, 0.12, 0.24), 0.7, partial(props.bottle, glass=c.TERRACOTTA, cap=c.TERRACOTTA)),
    _small("candle", (0.06, 0.06, 0.09), 0.15, partial(props.ball, rgba=c.SHADE)),
    _small("box", (0.4, 0.32, 0.28), 1.0, partial(props.block, rgba=c.CARDBOARD)),
    _small("tissue_box", (0.22, 0.12, 0.1), 0.2, partial(props.block, rgba=c.SKY)),
    _small("soap", (0.09, 0.06, 0.03), 0.1, partial(props.block, rgba=c.SHELL)),
    _small("toilet_paper", (0.11, 0.11, 0.1), 0.15, partial(props.ball, rgba=c.WHITE)),
    _small("paper_roll", (0.1, 0.1, 0.24), 0.25, partial(props.ball, rgba=c.PAPER)),
    _small("cloth", (0.24, 0.18, 0.03), 0.1, partial(props.block, rgba=c.SAGE)),
    _small("sponge", (0.07, 0.12, 0.03), 0.03, partial(props.block, rgba=c.MUSTARD)),
    _small("brush", (0.12, 0.12, 0.45), 0.4, partial(props.lamp, metal=c.WHITE, shade=c.WHITE, hood=0.2)),
    _small("watering_can", (0.18, 0.3, 0.22), 0.5, partial(props.block, rgba=c.LEAF)),
    _small("basketball", (0.24, 0.24, 0.24), 0.6, partial(props.ball, rgba=c.RUST)),
    _small("bat", (0.07, 0.85, 0.07), 0.9, partial(props.block, rgba=c.OAK)),
    _small("racket", (0.26, 0.68, 0.03), 0.3, partial(props.pan, metal=c.LINEN, handle=c.IRON)),
    _small("dumbbell", (0.14, 0.3, 0.14), 4.0, partial(props.block, rgba=c.IRON)),
    _small("boots", (0.28, 0.3, 0.35), 1.2, partial(props.block, rgba=c.WALNUT)),
    _small("object", (0.12, 0.12, 0.12), 0.3, partial(props.block, rgba=c.GREY)),
)

_HEAVY = (
    Kind(
        name="trunk",
        title="trunk",
        family="household",
        size=(0.8, 0.4, 0.4),
        mass=26.0,
        shape=partial(props.trunk, body=c.TEAL, lid=c.OAK, handle=c.WALNUT),
        pickable=True,
        finishes=_paints("body", c.RUST, c.BLUE, c.GREY),
        handles=True,
    ),
)
"""Too heavy for one, and has handles for two."""

KINDS = (*_FURNITURE, *_FIXTURES, *_SMALL, *_HEAVY)
