"""Directions: what is written is read back, and every side is the side that it names."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog
from hthor.errors import HthorError
from hthor.navigation import directions
from hthor.navigation.directions import BEARINGS, Direction

THINGS = st.sampled_from(catalog.names())
ROOMS = st.sampled_from(directions.ROOMS)
SIDES = st.sampled_from(sorted(BEARINGS))
HANDS = st.sampled_from(["left", "right"])
STEPS = st.one_of(
    st.builds(
        Direction,
        act=st.sampled_from(["door", "opening"]),
        side=SIDES,
        landmark=st.one_of(st.just(""), THINGS),
        room=ROOMS,
    ),
    st.builds(Direction, act=st.sampled_from(["past", "turn"]), side=HANDS, landmark=THINGS),
    st.builds(Direction, act=st.just("stop"), landmark=THINGS),
)


@given(st.lists(STEPS, min_size=1, max_size=8))
def test_what_is_written_is_read_back(steps):
    text = directions.write(steps)
    assert directions.read(text) == tuple(steps)
    assert text[0].isupper()
    assert text.endswith(".")


@given(st.floats(-10.0, 10.0))
def test_a_side_is_within_an_eighth_of_a_turn_of_its_middle(bearing):
    side = directions.nearest_side(bearing)
    assert directions.off_side(side, bearing) <= math.pi / 4 + 1e-9


def test_left_is_counterclockwise():
    assert directions.nearest_side(math.radians(80)) == "left"
    assert directions.nearest_side(math.radians(-100)) == "right"


@pytest.mark.parametrize("text", ["Find an apple.", "Go through the door up into the kitchen.", "Stop at the moon."])
def test_other_words_are_refused(text):
    with pytest.raises(HthorError):
        directions.read(text)


def test_plain_english():
    steps = [
        Direction(act="door", side="left", room="living_room"),
        Direction(act="past", side="right", landmark="sofa"),
        Direction(act="turn", side="right", landmark="shelf"),
        Direction(act="stop", landmark="tv_stand"),
    ]
    assert directions.write(steps) == (
        "Go through the door on your left into the living room. Walk past the sofa on your right. "
        "Turn right at the shelf and stop at the TV stand."
    )
