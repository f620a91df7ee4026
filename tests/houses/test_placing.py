"""How a file puts things, and where bodies start: what hthor does not do as the file says is reported, by field."""

from __future__ import annotations

import copy
import functools
import json
import math
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import catalog, houses
from hthor.errors import HouseError
from hthor.houses import laying, loader
from hthor.houses.checks.house_checks import STRICT, check
from hthor.houses.checks.house_rules import Finding, is_sound
from hthor.houses.checks.structure import HORIZON_DEG, UPRIGHT_DEG
from hthor.houses.space.free_space import FreeSpace
from hthor.types import HouseSpec
from hthor.world import World

FOLDER = Path(houses.__file__).parent / "data"
SCENES = houses.names()


@functools.cache
def document(name: str) -> Any:
    return json.loads((FOLDER / f"{name}.json").read_bytes())


def rows_of(made: Any) -> list[tuple[str, Any]]:
    """Every object with its field."""
    found = []
    for index, row in enumerate(made["objects"]):
        found.append((f"objects[{index}]", row))
        found += [(f"objects[{index}].children[{k}]", child) for k, child in enumerate(row.get("children") or ())]
    return found


def built(made: Any) -> HouseSpec:
    return loader.house_from_document(made, "mine")


def built_or_field(made: Any) -> tuple[str, HouseSpec | None]:
    """The house, or the field for which it is refused."""
    try:
        return "", built(made)
    except HouseError as error:
        return error.field, None


def by_rule(house: HouseSpec, rule: str, **more: bool) -> list[Finding]:
    return [finding for finding in check(house, 0.2, **more) if finding.rule == rule]


@settings(max_examples=cases(30), deadline=None)
@given(
    st.sampled_from(SCENES),
    st.lists(st.tuples(st.integers(0, 10**6), st.sampled_from("xz"), st.floats(-800, 800)), min_size=1, max_size=6),
)
def test_what_is_turned_over_in_the_file_is_reported(name: str, turns: list[tuple[int, str, float]]) -> None:
    made = copy.deepcopy(document(name))
    rows = rows_of(made)
    for number, axis, degrees in turns:
        rows[number % len(rows)][1]["rotation"][axis] = degrees
    wanted = {
        where
        for where, row in rows
        if max(abs(math.remainder(row["rotation"].get(axis, 0), 360)) for axis in "xz") > UPRIGHT_DEG + 1e-9
    }
    house = built(made)
    found = by_rule(house, "thing-tilted")
    assert {finding.field.rsplit(".rotation.", 1)[0] for finding in found} == wanted
    assert {finding.severity for finding in found} <= {"warning"}
    assert {finding.severity for finding in by_rule(house, "thing-tilted", strict=True)} <= {"error"}
    assert len(by_rule(house, "thing-tilted", strict=True)) == len(found) == len(wanted)
    upright = [msgspec.structs.replace(thing, tilt=(0.0, 0.0)) for thing in house.things]
    assert upright == list(houses.load(name).things), "hthor puts everything upright"


@settings(max_examples=cases(30), deadline=None)
@given(st.sampled_from(SCENES), st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=60))
def test_small_things_that_nobody_can_pick_up_are_reported(name: str, lifts: list[float]) -> None:
    made = copy.deepcopy(document(name))
    children = [(where, row) for where, row in rows_of(made) if "children" in where]
    for number, (_, row) in enumerate(children):
        row["position"]["y"] = max(0.0, row["position"]["y"] + lifts[number % len(lifts)])
    house = built(made)
    free = {thing.id for thing in laying.movable_objects(house)}
    fixed = {
        thing.id
        for thing in house.things
        if thing.parent and catalog.kind(thing.kind).pickable and thing.id not in free
    }
    found = by_rule(house, "thing-fixed")
    assert {finding.where for finding in found} == fixed
    fields = {row["id"]: where for where, row in children}
    assert all(finding.field == f"{fields[finding.where]}.position.y" for finding in found)
    assert len(found) == len(fixed)


def test_small_things_far_above_their_furniture_are_reported_and_cannot_be_picked_up() -> None:
    made = copy.deepcopy(document("alder"))
    row = next(row for row in made["objects"] if len(row.get("children") or ()) >= 3)
    for child in row["children"]:
        child["position"]["y"] += 0.6
    house = built(made)
    world = World(house)
    world.reset()
    movable = {state.id for state in world.objects()}
    small = {child["id"] for child in row["children"] if catalog.kind(_kind(house, child["id"])).pickable}
    assert {finding.where for finding in by_rule(house, "thing-fixed")} == small - movable
    assert all("0.60 m above" in finding.problem for finding in by_rule(house, "thing-fixed"))
    assert is_sound(check(house, 0.2))


def test_furniture_below_the_floor_is_reported() -> None:
    made = copy.deepcopy(document("alder"))
    where, row = next((where, row) for where, row in rows_of(made) if row["id"].startswith("bed"))
    row["position"]["y"] -= 1.0
    (found,) = [one for one in by_rule(built(made), "thing-floats") if one.where == row["id"]]
    assert "m below the floor" in found.problem
    assert found.field == f"{where}.position.y"


def _kind(house: HouseSpec, id: str) -> str:
    return next(thing.kind for thing in house.things if thing.id == id)


@settings(max_examples=cases(20), deadline=None)
@given(st.sampled_from(SCENES), st.integers(0, 10**6), st.floats(0.0, 1.2))
def test_furniture_in_the_air_is_reported(name: str, number: int, lift: float) -> None:
    made = copy.deepcopy(document(name))
    rows = [row for row in made["objects"] if row["position"]["y"] + lift < 2.0]
    row = rows[number % len(rows)]
    row["position"]["y"] += lift
    house = built(made)
    thing = next(one for one in house.things if one.id == row["id"])
    high = lift > 0.31 and not catalog.kind(thing.kind).wall_mounted
    found = [finding.where for finding in by_rule(house, "thing-floats")]
    if high:
        assert thing.id in found
    elif lift < 0.29:
        assert found == []


@settings(max_examples=cases(30), deadline=None)
@given(st.sampled_from(SCENES), st.floats(0, 1), st.floats(0, 1), st.integers(0, 3))
def test_people_begin_where_the_file_says_or_it_is_an_error(name: str, u: float, v: float, turns: int) -> None:
    made = copy.deepcopy(document(name))
    corners = [corner for room in made["rooms"] for corner in room["floorPolygon"]]
    agent = made["metadata"]["agent"]
    for axis, share in (("x", u), ("z", v)):
        low, high = (pick(corner[axis] for corner in corners) for pick in (min, max))
        agent["position"][axis] = low + share * (high - low)
    agent["rotation"]["y"] = 90 * turns
    outside, house = built_or_field(made)
    if house is None:
        assert outside == "metadata.agent.position"
        return
    space = FreeSpace.of(house, 0.2)
    found = by_rule(house, "start-free")
    assert bool(found) != space.is_free(house.start.x, house.start.y)
    for finding in found:
        assert finding.severity == "error"
        assert finding.field == "metadata.agent.position"
        x, y = space.nearest_free(house.start.x, house.start.y)
        assert f"nearest free floor is at x {x:.3f}, z {y:.3f}" in finding.problem


@pytest.mark.parametrize("name", ["alder", "maple"])
def test_a_start_that_is_no_error_is_where_the_person_stands(name: str) -> None:
    house = houses.load(name)
    world = World(house)
    world.reset()
    assert (world.pose("human").x, world.pose("human").y) == (house.start.x, house.start.y)
    made = copy.deepcopy(document(name))
    at = made["objects"][0]["position"]
    agent = made["metadata"].pop("agent")
    made["metadata"]["agentPoses"] = {"default": {**agent, "position": {**at, "y": 0.95}}}
    (finding,) = by_rule(built(made), "start-free")
    assert finding.field == "metadata.agentPoses.default.position"


@given(st.floats(-400, 400), st.sampled_from("xz"))
def test_bodies_start_upright(degrees: float, axis: str) -> None:
    made = copy.deepcopy(document("elder"))
    made["metadata"]["agent"]["rotation"][axis] = degrees
    if abs(math.remainder(degrees, 360)) <= UPRIGHT_DEG:
        assert built(made).start == houses.load("elder").start
    else:
        with pytest.raises(HouseError, match=rf"metadata\.agent\.rotation\.{axis}: bodies start upright"):
            built(made)


@given(st.floats(-200, 200))
def test_bodies_look_no_farther_up_or_down_than_people_do(degrees: float) -> None:
    made = copy.deepcopy(document("elder"))
    made["metadata"]["agent"]["horizon"] = degrees
    if abs(degrees) <= HORIZON_DEG:
        assert built(made).start.pitch == pytest.approx(-math.radians(degrees))
    else:
        with pytest.raises(HouseError, match=r"metadata\.agent\.horizon: bodies look at most 60 degrees"):
            built(made)


@pytest.mark.parametrize("name", [*SCENES, *houses.names("unseen")])
def test_the_houses_that_come_with_hthor_are_as_their_files_say(name: str) -> None:
    house = houses.load(name)
    rules = {finding.rule for finding in check(house, 0.2)}
    assert not rules & {"thing-tilted", "thing-fixed", "thing-floats", "start-free"}
    assert "thing-tilted" in STRICT


def test_the_samples_are_not_refused_and_nothing_in_them_counts_as_tilted(samples: list[Path]) -> None:
    """What ProcTHOR's physics left behind is at most 0.04 degrees."""
    for path in samples:
        house = houses.load(path)
        found = check(house, 0.2)
        assert is_sound(found)
        assert "thing-tilted" not in {finding.rule for finding in found}
        reported = {finding.field for finding in found if finding.rule == "thing-fixed"}
        assert all(field.startswith("objects[") for field in reported)
