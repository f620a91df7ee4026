"""The census counts what is there: checked on a house small enough to count by hand, and on the samples."""

from __future__ import annotations

import math
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st
from two_rooms import SIDE, TABLE, house, on, thing

from hthor import houses
from hthor.houses import house_statistics
from hthor.houses.house_statistics import measure_house, quantiles_of

FAR = thing("sofa", "sofa", SIDE + 4.4, 2.5, math.pi / 2)


def test_a_house_counted_by_hand():
    figures = measure_house(house(TABLE, on("bowl", "bowl", TABLE), on("cup", "cup", TABLE, 0.5), FAR))
    assert figures.area == pytest.approx(2 * SIDE * SIDE)
    assert figures.doors == 1
    assert [(room.kind, room.area, room.doors, room.things, room.top) for room in figures.rooms] == [
        ("bedroom", pytest.approx(25.0), 1, 3, 1),
        ("bedroom", pytest.approx(25.0), 1, 1, 1),
    ]


def test_ways_lead_to_where_one_can_stand():
    """From (2.5, 0.7) straight on to the table's edge at y 2.05, less the body's radius and the grid's rounding."""
    to_table, to_sofa = measure_house(house(TABLE, FAR)).ways
    assert to_table == pytest.approx(2.05 - 0.2 - 0.7, abs=0.06)
    straight = math.dist((2.5, 0.7), (SIDE + 4.4 - 0.45 - 0.2, 2.5))
    assert straight < to_sofa < straight + 1.0


def test_free_floor_shrinks_with_what_stands_on_it():
    bare, full = measure_house(house()).free, measure_house(house(TABLE, FAR)).free
    swept = (1.5 + 0.4) * (0.9 + 0.4) + (0.9 + 0.4) * (1.95 + 0.4)
    assert bare == pytest.approx(((SIDE - 0.5) * (SIDE - 0.5) * 2 + 0.5 * 0.5) / 50.0, abs=0.02)
    assert bare - full == pytest.approx(swept / 50.0, abs=0.02)


def test_a_closed_off_receptacle_has_no_way():
    blocked = house(TABLE, FAR, thing("block", "bed", SIDE, SIDE / 2, room="a"))
    assert [thing.kind for thing in blocked.things] == ["dining_table", "sofa", "bed"]
    assert len(measure_house(blocked).ways) == 2


@given(st.lists(st.floats(0, 100), min_size=1, max_size=30))
def test_spreads_are_ordered_and_hold_the_middle(values):
    found = quantiles_of(values)
    assert found.low <= found.median <= found.high
    assert found.median == statistics.median(values)
    assert found.count == len(values)


def test_populations_pool_their_rooms():
    one, two = measure_house(house(TABLE)), measure_house(house(FAR, width=2.0))
    pooled = house_statistics.summarize_houses("both", [one, two])
    assert pooled.houses == 2
    assert pooled.figures["room, m2"].count == 4
    assert pooled.figures["rooms a house"].median == 2
    assert "kitchen, m2" not in pooled.figures
    with pytest.raises(ValueError, match="at least one"):
        house_statistics.summarize_houses("none", [])


def test_the_samples_look_as_the_published_figures_say(samples):
    """Means over 210 real houses: 3.6 doors at 4 rooms and 6.5 at 7, the one outside among them; 73 to 100 things."""
    figures = [measure_house(houses.load(path)) for path in samples]
    few = [one for one in figures if 4 <= len(one.rooms) <= 6]
    assert all(2 <= one.doors <= 7 for one in few)
    assert 60 <= statistics.median(sum(room.things for room in one.rooms) for one in few) <= 110
    assert all(0.3 < one.free < 0.8 for one in figures)
    assert all(len(one.ways) >= 4 for one in few)
