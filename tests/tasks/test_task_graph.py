"""Scene graphs and arrangements: what there is by counting, how often it is drawn, and that poses say the same."""

from __future__ import annotations

import math
from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from hthor import catalog, houses, seeds
from hthor.catalog import priors
from hthor.errors import HthorError, UnknownName
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.arrangement.target_arrangement import BROUGHT, arrange
from hthor.tasks.generation import suite_specs
from hthor.tasks.kinds.mobile_manipulation import TEMPLATES
from hthor.types import Placement

ROOT = 11
SAMPLES = 10_000
EVERYTHING = frozenset(row.reference for row in priors.triplets()) | frozenset(catalog.TARGETS)


# ------------------------------------------------------------------------------------------------------------- counting


def test_the_benchmark_has_its_parts():
    assert len(priors.triplets()) == 65
    assert sum(len(places) for places in TEMPLATES.values()) == 19
    assert len(suite_specs.SCENES) == len(set(suite_specs.SCENES)) == 10
    assert len(catalog.TARGETS) == 6
    assert len(set(catalog.TARGETS) | set(catalog.RECEPTACLES)) == 14


def test_orders_count_565_and_1583():
    found = {}
    for name in ("navigation", "manipulation"):
        plan = suite_specs.SUITE_SPECS[name]
        orders = [order for house in plan.houses for order in plan.orders(plan, houses.load(house))]
        assert len({order.name for order in orders}) == len(orders)
        found[name] = len(orders)
    assert found == {"navigation": 565, "manipulation": 1583}


def test_the_counts_follow_from_the_tables_alone():
    """Counted again from priors, templates and house files, without the code that makes orders."""
    searches = deliveries = 0
    for name in suite_specs.SCENES:
        kinds = {thing.kind for thing in houses.load(name).things} | set(TEMPLATES)
        there = [row for row in priors.triplets() if row.reference in kinds]
        searches += len(there)
        for target, places in TEMPLATES.items():
            for place in places:
                rows = [row for row in there if row.target == target]
                deliveries += (place in kinds) * sum(row.reference != place or row.relation == "near" for row in rows)
    assert (searches, deliveries) == (565, 1583)


# ------------------------------------------------------------------------------------------------------------- chance


@pytest.mark.parametrize("target", catalog.TARGETS)
@pytest.mark.parametrize("where", ["everything", "juniper"])
def test_relations_are_drawn_as_often_as_they_weigh(target, where):
    kinds = EVERYTHING if where == "everything" else scene_graph.kinds_present(houses.load(where))
    counts = Counter(scene_graph.draw_triplet(target, kinds, seeds.derive(ROOT, number)) for number in range(SAMPLES))
    weights = {
        row: priors.weights(target)[row.relation, row.reference]
        for row in scene_graph.applicable_triplets(target, kinds)
    }
    total = sum(weights.values())
    assert set(counts) <= set(weights)
    statistic = sum((counts[row] - SAMPLES * w / total) ** 2 / (SAMPLES * w / total) for row, w in weights.items())
    assert chi2.sf(statistic, len(weights) - 1) > 0.01


def test_a_whole_graph_is_drawn_target_by_target():
    kinds = scene_graph.kinds_present(houses.load("alder"))
    one = scene_graph.sample_graph(kinds, ROOT)
    assert set(one) == set(catalog.TARGETS)
    assert one == scene_graph.sample_graph(kinds, ROOT) != scene_graph.sample_graph(kinds, ROOT + 1)
    fixed = scene_graph.find_triplet("mug", "in", "sink")
    assert scene_graph.sample_graph(kinds, ROOT, fixed) == {**one, "mug": fixed}


def test_poses_realise_the_graph_that_was_drawn():
    """A relation gives way to another only where its pose is not to be had."""
    house, kept, drawn = houses.load("hazel"), 0, 0
    things = {thing.id: thing.kind for thing in house.things}
    for root in range(8):
        wanted = scene_graph.sample_graph(
            scene_graph.kinds_present(house), seeds.derive(seeds.derive(root), "graph", 0)
        )
        for placed in arrange(house, seeds.derive(root)):
            row = wanted[placed.id]
            kinds = things.get(placed.near, placed.near), things.get(placed.support)
            kept += row.reference in kinds and (row.relation == "near") == bool(placed.near)
            drawn += 1
    assert kept >= 0.85 * drawn


rows = st.tuples(*(st.sampled_from(scene_graph.applicable_triplets(target, EVERYTHING)) for target in catalog.TARGETS))


@given(chosen=rows, root=st.integers(0, 1 << 40))
def test_targets_come_after_what_they_are_near_to_but_one_of_a_ring(chosen, root):
    wanted = {row.target: row for row in chosen}
    order = scene_graph.placement_order(wanted, root)
    assert sorted(order) == sorted(catalog.TARGETS)
    for place, target in enumerate(order):
        row = wanted[target]
        if row.relation == "near" and row.reference in order[place + 1 :]:
            ring = [target]
            while wanted[ring[-1]].relation == "near" and wanted[ring[-1]].reference in wanted and len(ring) < 8:
                ring.append(wanted[ring[-1]].reference)
            assert target in ring[1:], "only who waits in a ring may come before what it waits for"


def test_wrong_names_are_told():
    with pytest.raises(UnknownName, match="Did you mean 'apple'"):
        scene_graph.draw_triplet("appel", EVERYTHING, 1)
    with pytest.raises(ValueError, match="no reference"):
        scene_graph.draw_triplet("apple", frozenset(), 1)
    with pytest.raises(KeyError):
        scene_graph.find_triplet("apple", "on", "fridge")


# --------------------------------------------------------------------------------------------------------- arrangements


def plan_gap(placed: Placement, name: str, house, objects) -> float:
    """Distance on the plan to a thing's edge or an object's middle, by corners: not as the maker measures it."""
    x, y, _ = placed.position
    for other in objects:
        if other.id == name:
            return math.hypot(x - other.position[0], y - other.position[1])
    thing = next(thing for thing in house.things if thing.id == name)
    cos, sin = math.cos(-thing.yaw), math.sin(-thing.yaw)
    dx, dy = x - thing.centre[0], y - thing.centre[1]
    u, v = cos * dx - sin * dy, sin * dx + cos * dy
    nearest = (max(-thing.size[0] / 2, min(u, thing.size[0] / 2)), max(-thing.size[1] / 2, min(v, thing.size[1] / 2)))
    return math.dist((u, v), nearest)


@pytest.mark.parametrize("name", ["cedar", "willow"])
def test_a_given_triplet_holds_and_so_does_all_that_is_near(name):
    house = houses.load(name)
    things = {thing.id: thing.kind for thing in house.things}
    for number, row in enumerate(priors.triplets()[::6]):
        if row.reference not in scene_graph.kinds_present(house):
            continue
        objects = arrange(house, seeds.derive(ROOT, number), fixed=row)
        mine = next(placed for placed in objects if placed.id == row.target)
        if row.relation == "near":
            assert things.get(mine.near, mine.near) == row.reference
        else:
            assert (mine.relation, things[mine.support], mine.near) == (row.relation, row.reference, "")
        assert all(plan_gap(placed, placed.near, house, objects) <= 1.0 for placed in objects if placed.near)


def test_a_target_of_a_ring_is_near_the_one_that_came_later():
    house = houses.load("alder")
    fixed = scene_graph.find_triplet("tomato", "near", "lettuce")
    rings = 0
    for root in range(12):
        placed = {one.id: one for one in arrange(house, root, fixed=fixed)}
        assert placed["tomato"].near == "lettuce"
        rings += placed["lettuce"].near == "tomato"
    assert rings > 0


def test_where_only_the_destination_is_near_it_lies_on_the_floor():
    house, row = houses.load("willow"), scene_graph.find_triplet("remote_control", "near", "television")
    objects = arrange(house, ROOT, {"remote_control": "tv_stand"}, fixed=row)
    mine = next(placed for placed in objects if placed.id == "remote_control")
    assert mine.support == ""
    assert mine.position[2] == pytest.approx(catalog.kind("remote_control").size[2] / 2)
    assert plan_gap(mine, "television", house, objects) <= 1.0
    free = arrange(house, ROOT, fixed=row)
    assert next(placed for placed in free if placed.id == "remote_control").support == "tv_stand"


def test_where_the_only_plate_is_at_the_destination_another_is_brought():
    house, row = houses.load("rowan"), scene_graph.find_triplet("tomato", "on", "plate")
    objects = {placed.id: placed for placed in arrange(house, ROOT, {"tomato": "dining_table"}, fixed=row)}
    things = {thing.id: thing.kind for thing in house.things}
    plate = objects[f"{BROUGHT}_plate"]
    assert objects["tomato"].support == plate.id
    assert things[plate.support] != "dining_table"
    assert math.dist(objects["tomato"].position[:2], plate.position[:2]) < 0.1


def test_what_cannot_be_is_said():
    house = houses.load("alder")
    with pytest.raises(HthorError, match="tomato-on-plate"):
        arrange(
            house, ROOT, fixed=scene_graph.find_triplet("tomato", "on", "plate")
        )  # no plate in this house, nothing banned
