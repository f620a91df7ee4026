"""Every kind of thing, one row per kind: the benchmark's receptacles and targets, and all other household things.

To add a kind, add a row. A look of its own (`hthor.looks.build`) is optional; without it, the kind's solids are drawn.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from hthor.catalog import appliances, cabinets, fixtures, props, shapes
from hthor.catalog import colors as c
from hthor.catalog.kind import Kind, Shape
from hthor.types import Rgba, Vec3

Finishes = tuple[dict[str, Rgba], ...]


def _maker(**traits: Any) -> Callable[..., Kind]:
    """Returns a function that makes kinds with these traits; other keywords of a row are passed to the kind's shape."""

    def make(
        name: str, size: Vec3, mass: float, shape: Shape, finishes: Finishes = (), *, title: str = "", **look: Any
    ) -> Kind:
        words, form = title or name.replace("_", " "), partial(shape, **look)
        return Kind(name=name, title=words, size=size, mass=mass, shape=form, finishes=finishes, **traits)

    return make


_receptacle, _container = _maker(family="receptacle"), _maker(family="receptacle", relation="in")
_target = _maker(family="target", pickable=True)
_stands, _holds = _maker(family="household"), _maker(family="household", relation="in")
_hangs = _maker(family="household", wall_mounted=True)
_cupboard = _maker(family="household", wall_mounted=True, relation="in")
_small = _maker(family="household", pickable=True)
_heavy = _maker(family="household", pickable=True, handles=True)


def _paints(keyword: str, *colors: Rgba) -> Finishes:
    """Finishes that each change one color."""
    return tuple({keyword: rgba} for rgba in colors)


def _pairs(one: str, other: str, *colors: tuple[Rgba, Rgba]) -> Finishes:
    """Finishes that each change two colors."""
    return tuple({one: first, other: second} for first, second in colors)


_SEATS = _pairs("fabric", "cushion", (c.GREY, c.LINEN), (c.TEAL, c.SAGE), (c.MUSTARD, c.CREAM), (c.BLUE, c.SKY))
_CHAIRS = _pairs("wood", "seat", (c.WALNUT, c.CREAM), (c.WHITE, c.OAK), (c.IRON, c.GREY))
_CHESTS = _pairs("body", "fronts", (c.OAK, c.BIRCH), (c.WALNUT, c.WALNUT), (c.IRON, c.GREY))
_STANDS = _pairs("wood", "front", (c.WALNUT, c.WALNUT), (c.WHITE, c.CREAM), (c.BIRCH, c.WHITE))
_CUPBOARDS = _pairs("body", "inner", (c.OAK, c.BIRCH), (c.WALNUT, c.OAK), (c.SAGE, c.WHITE))
_KITCHENS = _pairs("body", "inner", (c.WHITE, c.WHITE), (c.BLUE, c.WHITE), (c.OAK, c.BIRCH))
"""Finishes of wall cabinets: variant n matches variant n of the counter tops."""
_COUNTERS = _pairs("body", "top", (c.WHITE, c.IRON), (c.BLUE, c.CREAM), (c.OAK, c.WHITE))
_DINING_TABLES = _pairs("wood", "legs", (c.WALNUT, c.WALNUT), (c.WHITE, c.BIRCH), (c.BIRCH, c.IRON))
_COFFEE_TABLES = _pairs("wood", "legs", (c.OAK, c.OAK), (c.WHITE, c.BIRCH), (c.BIRCH, c.IRON))
_SOFAS = _pairs("fabric", "cushion", (c.GREY, c.LINEN), (c.SAGE, c.CREAM), (c.RUST, c.TERRACOTTA), (c.LINEN, c.CREAM))
_BEDS = _pairs("frame", "blanket", (c.OAK, c.SKY), (c.WHITE, c.SAGE), (c.IRON, c.LINEN), (c.BIRCH, c.TERRACOTTA))
_DESKS = _pairs("wood", "body", (c.OAK, c.OAK), (c.WALNUT, c.IRON), (c.WHITE, c.WHITE))
_TV_STANDS = _paints("wood", c.OAK, c.WHITE, c.IRON)
_OTTOMANS = _paints("fabric", c.TEAL, c.GREY, c.RUST)
_SHELVES = _paints("wood", c.WALNUT, c.WHITE, c.BIRCH)
_RUGS = _paints("rgba", c.RUST, c.BLUE, c.SAGE, c.GREY, c.TERRACOTTA)
_CURTAINS = _paints("rgba", c.SAGE, c.SKY, c.TERRACOTTA, c.GREY)
_MIRRORS = _paints("frame", c.IRON, c.WHITE, c.WALNUT)
_TOWELS = _paints("rgba", c.WHITE, c.SAGE, c.TERRACOTTA)
_PILLOWS = _paints("fabric", c.TEAL, c.MUSTARD, c.RUST, c.SKY)
_TRUNKS = _paints("body", c.RUST, c.BLUE, c.GREY)

RECEPTACLES = (
    _container("fridge", (0.75, 0.72, 1.78), 75.0, fixtures.fridge, body=c.STEEL, inner=c.WHITE),
    _receptacle("counter_top", (1.8, 0.62, 0.9), 80.0, cabinets.counter, _COUNTERS, body=c.SAGE, top=c.STONE),
    _receptacle("dining_table", (1.5, 0.9, 0.74), 35.0, shapes.table, _DINING_TABLES, wood=c.OAK, legs=c.OAK),
    _receptacle("coffee_table", (1.05, 0.6, 0.42), 15.0, shapes.low_table, _COFFEE_TABLES, wood=c.WALNUT, legs=c.IRON),
    _receptacle("sofa", (1.95, 0.9, 0.82), 50.0, shapes.sofa, _SOFAS, fabric=c.BLUE, cushion=c.SKY, seats=2),
    _receptacle("bed", (1.6, 2.1, 0.95), 70.0, shapes.bed, _BEDS, frame=c.WALNUT, blanket=c.TEAL),
    _receptacle("desk", (1.35, 0.65, 0.74), 30.0, cabinets.desk, _DESKS, wood=c.BIRCH, body=c.WHITE),
    _receptacle("tv_stand", (1.5, 0.42, 0.5), 28.0, shapes.tv_stand, _TV_STANDS, title="TV stand", wood=c.WALNUT),
)
"""The benchmark's eight receptacles."""

TARGETS = (
    _target("apple", (0.08, 0.08, 0.08), 0.2, props.ball, rgba=c.APPLE),
    _target("tomato", (0.07, 0.07, 0.07), 0.12, props.ball, rgba=c.TOMATO),
    _target("lettuce", (0.17, 0.17, 0.17), 0.47, props.ball, rgba=c.LETTUCE),
    _target("book", (0.15, 0.21, 0.03), 0.5, props.book, cover=c.RUST, pages=c.PAPER),
    _target("remote_control", (0.05, 0.18, 0.022), 0.15, props.remote_control, body=c.BLACK, key=c.RED),
    _target("mug", (0.115, 0.085, 0.1), 0.35, props.mug, glaze=c.MUSTARD),
)
"""The benchmark's six target objects."""

_FURNITURE = (
    _stands("chair", (0.45, 0.5, 0.9), 5.0, shapes.chair, _CHAIRS, wood=c.OAK, seat=c.BIRCH),
    _stands("armchair", (0.85, 0.85, 0.85), 22.0, shapes.sofa, _SEATS, fabric=c.RUST, cushion=c.TERRACOTTA, seats=1),
    _stands("stool", (0.36, 0.36, 0.48), 3.5, shapes.stool, seat=c.OAK, legs=c.IRON),
    _stands("ottoman", (0.7, 0.5, 0.42), 8.0, shapes.ottoman, _OTTOMANS, fabric=c.LINEN),
    _stands("shelf", (0.85, 0.32, 1.9), 30.0, shapes.shelf, _SHELVES, wood=c.OAK),
    _stands("dresser", (1.1, 0.48, 0.82), 40.0, cabinets.dresser, _CHESTS, body=c.WHITE, fronts=c.CREAM),
    _stands("side_table", (0.45, 0.42, 0.52), 9.0, cabinets.nightstand, _STANDS, wood=c.OAK, front=c.OAK),
    _holds("wardrobe", (1.2, 0.6, 2.0), 75.0, cabinets.wardrobe, _CUPBOARDS, body=c.WHITE, inner=c.BIRCH),
    _stands("rug", (2.0, 1.4, 0.01), 6.0, props.block, _RUGS, rgba=c.LINEN),
    _stands("cart", (0.7, 0.45, 0.9), 12.0, shapes.low_table, wood=c.STEEL, legs=c.IRON),
    _stands("furniture", (0.6, 0.5, 0.8), 20.0, props.block, title="piece of furniture", rgba=c.LINEN),
)

_FIXTURES = (
    _holds("sink", (0.8, 0.6, 1.08), 35.0, fixtures.sink, body=c.WHITE, basin=c.STEEL),
    _stands("toilet", (0.42, 0.68, 0.8), 30.0, fixtures.toilet, body=c.WHITE),
    _holds("bathtub", (0.75, 1.65, 0.56), 60.0, fixtures.bathtub, body=c.WHITE),
    _stands("shower", (0.9, 0.9, 2.05), 50.0, fixtures.shower, tray=c.WHITE),
    _stands("washing_machine", (0.6, 0.6, 0.85), 65.0, appliances.washer, body=c.WHITE, glass=c.GREY),
    _stands("coffee_machine", (0.24, 0.34, 0.36), 4.0, fixtures.coffee_machine, body=c.IRON),
    _stands("stove", (0.6, 0.62, 0.9), 50.0, appliances.stove, body=c.STEEL, glass=c.BLACK),
    _holds("microwave", (0.48, 0.36, 0.28), 12.0, appliances.oven_front, body=c.STEEL, glass=c.BLACK),
    _stands("toaster", (0.28, 0.18, 0.19), 1.5, props.block, rgba=c.STEEL),
    _holds("safe", (0.4, 0.4, 0.4), 30.0, appliances.oven_front, body=c.IRON, glass=c.GREY),
    _stands("television", (1.1, 0.24, 0.68), 14.0, props.television, body=c.BLACK, screen=c.IRON),
    _stands("computer", (0.6, 0.22, 0.46), 6.0, props.television, body=c.IRON, screen=c.BLUE),
    _stands("lamp", (0.26, 0.26, 0.42), 1.5, props.lamp, metal=c.IRON, shade=c.SHADE, hood=0.45),
    _stands("floor_lamp", (0.42, 0.42, 1.62), 6.0, props.lamp, metal=c.IRON, shade=c.SHADE, hood=0.2),
    _stands("house_plant", (0.5, 0.5, 0.95), 7.0, props.plant, pot=c.TERRACOTTA, leaf=c.LEAF),
    _stands("bin", (0.3, 0.3, 0.42), 1.5, props.bin_, body=c.GREY, rim=c.IRON),
    _stands("laundry_hamper", (0.42, 0.36, 0.6), 2.0, props.bin_, body=c.LINEN, rim=c.OAK),
    _stands("dog_bed", (0.75, 0.6, 0.14), 2.0, props.cushion, fabric=c.RUST),
    _stands("vacuum_cleaner", (0.32, 0.32, 1.05), 5.0, props.lamp, metal=c.IRON, shade=c.RED, hood=0.3),
    _hangs("painting", (0.8, 0.04, 0.6), 3.0, props.painting, frame=c.WALNUT, sky=c.SKY, land=c.SAGE),
    _hangs("curtain", (1.4, 0.08, 1.6), 2.0, props.block, _CURTAINS, rgba=c.LINEN),
    _cupboard("kitchen_cabinet", (0.8, 0.35, 0.7), 18.0, cabinets.wall_cabinet, _KITCHENS, body=c.SAGE, inner=c.WHITE),
    _hangs("range_hood", (0.6, 0.48, 0.6), 12.0, appliances.range_hood, body=c.STEEL),
    _hangs("mirror", (0.6, 0.04, 0.9), 6.0, props.mirror, _MIRRORS, frame=c.OAK, glass=c.MIRROR),
    _hangs("clock", (0.3, 0.05, 0.3), 0.8, props.clock, rim=c.IRON, face=c.WHITE),
    _hangs("light_switch", (0.08, 0.02, 0.12), 0.1, props.block, rgba=c.WHITE),
    _hangs("shower_head", (0.2, 0.25, 0.3), 0.6, props.block, rgba=c.STEEL),
    _hangs("faucet", (0.06, 0.2, 0.2), 1.0, props.block, rgba=c.STEEL),
    _hangs("towel_holder", (0.55, 0.08, 0.05), 0.6, props.block, rgba=c.STEEL),
    _hangs("towel", (0.5, 0.04, 0.6), 0.4, props.block, _TOWELS, rgba=c.SKY),
)

_SMALL = (
    _small("bowl", (0.2, 0.2, 0.08), 0.4, props.stack, low=c.TEAL, high=c.TEAL, split=0.35, narrow=0.6),
    _small("plate", (0.24, 0.24, 0.022), 0.4, props.plate, glaze=c.WHITE),
    _small("cup", (0.08, 0.08, 0.1), 0.2, props.ball, rgba=c.WHITE),
    _small("pot", (0.24, 0.24, 0.16), 1.2, props.stack, low=c.STEEL, high=c.IRON, split=0.9, narrow=0.96),
    _small("pan", (0.26, 0.44, 0.06), 1.0, props.pan, metal=c.IRON, handle=c.BLACK),
    _small("kettle", (0.18, 0.18, 0.22), 0.9, props.stack, low=c.STEEL, high=c.STEEL, split=0.5, narrow=0.8),
    _small("bread", (0.13, 0.26, 0.11), 0.6, props.loaf, crust=c.CRUST),
    _small("egg", (0.05, 0.05, 0.05), 0.06, props.ball, rgba=c.SHELL),
    _small("potato", (0.07, 0.07, 0.07), 0.2, props.ball, rgba=c.CRUST),
    _small("bottle", (0.08, 0.08, 0.28), 0.8, props.bottle, glass=c.BOTTLE, cap=c.WHITE),
    _small("soap_bottle", (0.07, 0.07, 0.19), 0.3, props.bottle, glass=c.SKY, cap=c.WHITE),
    _small("shaker", (0.045, 0.045, 0.1), 0.1, props.bottle, glass=c.WHITE, cap=c.STEEL),
    _small("cutlery", (0.025, 0.2, 0.012), 0.05, props.block, rgba=c.STEEL),
    _small("cooking_spoon", (0.06, 0.3, 0.03), 0.1, props.block, rgba=c.WALNUT),
    _small("laptop", (0.34, 0.25, 0.22), 1.6, props.laptop, body=c.GREY, screen=c.BLUE),
    _small("phone", (0.075, 0.15, 0.01), 0.18, props.block, rgba=c.BLACK),
    _small("pen", (0.01, 0.15, 0.01), 0.01, props.block, rgba=c.BLUE),
    _small("card", (0.09, 0.055, 0.002), 0.01, props.block, rgba=c.MUSTARD),
    _small("disc", (0.12, 0.12, 0.003), 0.02, props.ball, rgba=c.STEEL),
    _small("keys", (0.1, 0.06, 0.012), 0.08, props.block, rgba=c.STEEL),
    _small("watch", (0.08, 0.05, 0.04), 0.1, props.block, rgba=c.IRON),
    _small("newspaper", (0.3, 0.22, 0.015), 0.2, props.block, rgba=c.PAPER),
    _small("alarm_clock", (0.14, 0.08, 0.16), 0.3, props.block, rgba=c.RED),
    _small("pillow", (0.55, 0.38, 0.13), 0.6, props.cushion, _PILLOWS, fabric=c.CREAM),
    _small("teddy_bear", (0.3, 0.25, 0.35), 0.4, props.figure, rgba=c.CRUST),
    _small("statue", (0.16, 0.14, 0.24), 1.0, props.figure, rgba=c.STONE),
    _small("vase", (0.12, 0.12, 0.24), 0.7, props.bottle, glass=c.TERRACOTTA, cap=c.TERRACOTTA),
    _small("candle", (0.06, 0.06, 0.09), 0.15, props.ball, rgba=c.SHADE),
    _small("box", (0.4, 0.32, 0.28), 1.0, props.block, rgba=c.CARDBOARD),
    _small("tissue_box", (0.22, 0.12, 0.1), 0.2, props.block, rgba=c.SKY),
    _small("soap", (0.09, 0.06, 0.03), 0.1, props.block, rgba=c.SHELL),
    _small("toilet_paper", (0.11, 0.11, 0.1), 0.15, props.ball, rgba=c.WHITE),
    _small("paper_roll", (0.1, 0.1, 0.24), 0.25, props.ball, rgba=c.PAPER),
    _small("cloth", (0.24, 0.18, 0.03), 0.1, props.block, rgba=c.SAGE),
    _small("sponge", (0.07, 0.12, 0.03), 0.03, props.block, rgba=c.MUSTARD),
    _small("brush", (0.12, 0.12, 0.45), 0.4, props.lamp, metal=c.WHITE, shade=c.WHITE, hood=0.2),
    _small("watering_can", (0.18, 0.3, 0.22), 0.5, props.block, rgba=c.LEAF),
    _small("basketball", (0.24, 0.24, 0.24), 0.6, props.ball, rgba=c.RUST),
    _small("bat", (0.07, 0.85, 0.07), 0.9, props.block, rgba=c.OAK),
    _small("racket", (0.26, 0.68, 0.03), 0.3, props.pan, metal=c.LINEN, handle=c.IRON),
    _small("dumbbell", (0.14, 0.3, 0.14), 4.0, props.block, rgba=c.IRON),
    _small("boots", (0.28, 0.3, 0.35), 1.2, props.block, rgba=c.WALNUT),
    _small("object", (0.12, 0.12, 0.12), 0.3, props.block, rgba=c.GREY),
)

_TRUNK = _heavy("trunk", (0.8, 0.4, 0.4), 26.0, props.trunk, _TRUNKS, body=c.TEAL, lid=c.OAK, handle=c.WALNUT)
"""A thing that is too heavy for one body and has handles for two."""

HOUSEHOLD = (*_FURNITURE, *_FIXTURES, *_SMALL, _TRUNK)
