"""The benchmark's six target objects."""

from functools import partial

from hthor.catalog import colors as c
from hthor.catalog import props
from hthor.catalog.kind import Kind

KINDS = (
    Kind(
        name="apple",
        title="apple",
        family="target",
        size=(0.08, 0.08, 0.08),
        mass=0.2,
        shape=partial(props.ball, rgba=c.APPLE),
        pickable=True,
    ),
    Kind(
        name="tomato",
        title="tomato",
        family="target",
        size=(0.07, 0.07, 0.07),
        mass=0.12,
        shape=partial(props.ball, rgba=c.TOMATO),
        pickable=True,
    ),
    Kind(
        name="lettuce",
        title="lettuce",
        family="target",
        size=(0.17, 0.17, 0.17),
        mass=0.47,
        shape=partial(props.ball, rgba=c.LETTUCE),
        pickable=True,
    ),
    Kind(
        name="book",
        title="book",
        family="target",
        size=(0.15, 0.21, 0.03),
        mass=0.5,
        shape=partial(props.book, cover=c.RUST, pages=c.PAPER),
        pickable=True,
    ),
    Kind(
        name="remote_control",
        title="remote control",
        family="target",
        size=(0.05, 0.18, 0.022),
        mass=0.15,
        shape=partial(props.remote_control, body=c.BLACK, key=c.RED),
        pickable=True,
    ),
    Kind(
        name="mug",
        title="mug",
        family="target",
        size=(0.115, 0.085, 0.1),
        mass=0.35,
        shape=partial(props.mug, glaze=c.MUSTARD),
        pickable=True,
    ),
)
