"""The benchmark's eight receptacles."""

from functools import partial

from hthor.catalog import cabinets, fixtures, shapes
from hthor.catalog import colors as c
from hthor.catalog.kind import Kind

KINDS = (
    Kind(
        name="fridge",
        title="fridge",
        family="receptacle",
        size=(0.75, 0.72, 1.78),
        mass=75.0,
        shape=partial(fixtures.fridge, body=c.STEEL, inner=c.WHITE),
        relation="in",
    ),
    Kind(
        name="counter_top",
        title="counter top",
        family="receptacle",
        size=(1.8, 0.62, 0.9),
        mass=80.0,
        shape=partial(cabinets.counter, body=c.SAGE, top=c.STONE),
        finishes=({"body": c.WHITE, "top": c.IRON}, {"body": c.BLUE, "top": c.CREAM}, {"body": c.OAK, "top": c.WHITE}),
    ),
    Kind(
        name="dining_table",
        title="dining table",
        family="receptacle",
        size=(1.5, 0.9, 0.74),
        mass=35.0,
        shape=partial(shapes.table, wood=c.OAK, legs=c.OAK),
        finishes=(
            {"wood": c.WALNUT, "legs": c.WALNUT},
            {"wood": c.WHITE, "legs": c.BIRCH},
            {"wood": c.BIRCH, "legs": c.IRON},
        ),
    ),
    Kind(
        name="coffee_table",
        title="coffee table",
        family="receptacle",
        size=(1.05, 0.6, 0.42),
        mass=15.0,
        shape=partial(shapes.low_table, wood=c.WALNUT, legs=c.IRON),
        finishes=(
            {"wood": c.OAK, "legs": c.OAK},
            {"wood": c.WHITE, "legs": c.BIRCH},
            {"wood": c.BIRCH, "legs": c.IRON},
        ),
    ),
    Kind(
        name="sofa",
        title="sofa",
        family="receptacle",
        size=(1.95, 0.9, 0.82),
        mass=50.0,
        shape=partial(shapes.sofa, fabric=c.BLUE, cushion=c.SKY, seats=2),
        finishes=(
            {"fabric": c.GREY, "cushion": c.LINEN},
            {"fabric": c.SAGE, "cushion": c.CREAM},
            {"fabric": c.RUST, "cushion": c.TERRACOTTA},
            {"fabric": c.LINEN, "cushion": c.CREAM},
        ),
    ),
    Kind(
        name="bed",
        title="bed",
        family="receptacle",
        size=(1.6, 2.1, 0.95),
        mass=70.0,
        shape=partial(shapes.bed, frame=c.WALNUT, blanket=c.TEAL),
        finishes=(
            {"frame": c.OAK, "blanket": c.SKY},
            {"frame": c.WHITE, "blanket": c.SAGE},
            {"frame": c.IRON, "blanket": c.LINEN},
            {"frame": c.BIRCH, "blanket": c.TERRACOTTA},
        ),
    ),
    Kind(
        name="desk",
        title="desk",
        family="receptacle",
        size=(1.35, 0.65, 0.74),
        mass=30.0,
        shape=partial(cabinets.desk, wood=c.BIRCH, body=c.WHITE),
        finishes=(
            {"wood": c.OAK, "body": c.OAK},
            {"wood": c.WALNUT, "body": c.IRON},
            {"wood": c.WHITE, "body": c.WHITE},
        ),
    ),
    Kind(
        name="tv_stand",
        title="TV stand",
        family="receptacle",
        size=(1.5, 0.42, 0.5),
        mass=28.0,
        shape=partial(shapes.tv_stand, wood=c.WALNUT),
        finishes=({"wood": c.OAK}, {"wood": c.WHITE}, {"wood": c.IRON}),
    ),
)
