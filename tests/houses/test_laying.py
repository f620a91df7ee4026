"""One arrangement of a house for tasks, checks and worlds: what a house file has at other heights is laid down once."""

from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import catalog, houses, plugins
from hthor.eval.task_check import solvability
from hthor.houses import laying, loader
from hthor.houses.checks import house_rules
from hthor.tasks.arrangement.placement import SupportSurfaces
from hthor.tasks.generation import custom_suite, generate
from hthor.tasks.generation.custom_suite import Recipe
from hthor.tasks.validate import task_faults
from hthor.types import Goal, HouseSpec, Placement, TaskSpec, Thing
from hthor.world import World
from hthor.world.model import inventory

DATA = Path(houses.__file__).parent / "data"
OWN = json.loads((DATA / "alder.json").read_bytes())
SMALL = sum(len(row.get("children") or ()) for row in OWN["objects"])


def lifted(by: float | list[float], document: Any = None) -> HouseSpec:
    """A scene whose file has the small things higher than they lie, as files of other furniture do."""
    changed = copy.deepcopy(OWN if document is None else document)
    small = [child for row in changed["objects"] for child in row.get("children") or ()]
    for number, child in enumerate(small):
        child["position"]["y"] += by if isinstance(by, float) else by[number % len(by)]
    return loader.house_from_document(changed, "lifted")


def stacked() -> HouseSpec:
    """A scene with a pile: a plate on the dining table, 12 cm too high, and a book on the plate, as high above it."""
    changed = copy.deepcopy(OWN)
    table = next(row for row in changed["objects"] if row["assetId"].startswith("hthor_dining_table"))
    place, (plate, book) = table["position"], (catalog.kind("plate"), catalog.kind("book"))
    top = place["y"] + float(table["assetId"].split("x")[-1].split("_")[0]) / 200
    low = top + 0.12
    child = _row("a book", "hthor_book_7x10x3", place, low + plate.size[2] + 0.12 + 0.015)
    table["children"] = [{**_row("a plate", "hthor_plate", place, low + plate.size[2] / 2), "children": [child]}]
    assert book.size
    return loader.house_from_document(changed, "stacked")


def _row(id: str, asset: str, place: Any, height: float) -> dict[str, Any]:
    zero = {"x": 0, "y": 0, "z": 0}
    return {"id": id, "assetId": asset, "position": {**place, "y": height}, "rotation": zero, "kinematic": False}


def bottom(thing: Thing) -> float:
    return thing.centre[2] - thing.size[2] / 2


@settings(max_examples=cases(15))
@given(st.lists(st.floats(-0.12, 0.12), min_size=1, max_size=SMALL))
def test_a_house_is_laid_down_once_and_stays_as_it_is(lifts: list[float]):
    house = lifted(lifts)
    assert laying.snap_objects(house) == house
    here = {thing.id: thing for thing in house.things}
    for free in laying.movable_objects(house):
        thing = here[free.id]
        assert thing.centre[:2] == free.centre[:2]
        assert thing.centre[2] == pytest.approx(free.centre[2], abs=laying.ROUNDING_M)
        support = here[thing.parent]
        heights = [support.centre[2] + one.centre[2] for one in catalog.kind(support.kind).surfaces(support.size)]
        assert min(abs(height - bottom(thing)) for height in heights) <= laying.ROUNDING_M


@pytest.mark.parametrize("name", [*houses.names(), *houses.names("unseen")])
def test_the_houses_that_come_with_hthor_lie_as_their_files_say(name: str):
    assert not any(thing.lift for thing in houses.load(name).things)


def test_the_world_has_everything_where_the_house_says():
    house = lifted(0.06)
    moved = [thing for thing in house.things if thing.lift]
    assert len(moved) > 20
    world = World(house)
    world.reset()
    for thing in house.things:
        assert world.position(thing.id) == pytest.approx(thing.centre, abs=laying.ROUNDING_M)


def test_what_lies_on_a_small_thing_lies_on_it_where_that_is_laid():
    house = {thing.id: thing for thing in stacked().things}
    plate, book = house["a plate"], house["a book"]
    (top,) = catalog.kind("plate").surfaces(plate.size)
    assert bottom(plate) == pytest.approx(house[plate.parent].centre[2] + house[plate.parent].size[2] / 2)
    assert bottom(book) == pytest.approx(plate.centre[2] + top.centre[2])
    assert {"a plate", "a book"} <= {one.id for one in inventory.split_things(stacked(), ()).movables}


def test_what_cannot_lie_there_stays_where_the_file_has_it():
    house = lifted(1.0)
    kept = {thing.id for thing in house.things if thing.parent} - {one.id for one in laying.movable_objects(house)}
    assert len(kept) > 10, "a metre over a table there is nothing to lie on"
    assert not any(thing.lift for thing in house.things if thing.id in kept)
    assert all(abs(thing.lift) <= 0.3 for thing in house.things)
    assert kept <= {thing.id for thing in inventory.split_things(house, ()).statics}


def test_the_height_of_the_file_is_still_judged():
    found = {finding.where for finding in house_rules.check_supported(lifted(0.06))}
    assert found >= {thing.id for thing in lifted(0.06).things if thing.lift}
    assert not list(house_rules.check_supported(lifted(0.0)))


# ------------------------------------------------------------------------------------------------------------- tasks


def task(house: HouseSpec, seed: int) -> TaskSpec:
    kind = plugins.load("task kind", "mobile_manipulation")
    goal = Goal(target="mug", relation="on", destination="desk")
    return generate.make_task(house, kind, goal, seed, name=f"test/{seed}")


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (1, 2))])
def test_no_object_of_a_task_starts_in_another(seed: int):
    """Things on crowded surfaces, all 11 cm higher in the file than they lie: low objects would fit below them."""
    house = crowded()
    world, made = World(house), task(house, seed)
    assert not list(task_faults(made, house))
    world.reset(made)
    for placed in made.objects:
        x, y, z = placed.position
        world.put_object(placed.id, (x, y, z + 0.002), yaw=placed.yaw)  # refused where something is there


def crowded() -> HouseSpec:
    """A scene whose tables and desks are full of bowls, which its file has 11 cm above them."""
    changed = copy.deepcopy(OWN)
    for row in changed["objects"]:
        kind, size, _ = catalog.own_asset(row["assetId"]) or (None, (0.0, 0.0, 0.0), 0)
        if kind is None or kind.name not in ("dining_table", "desk", "coffee_table", "counter_top", "tv_stand"):
            continue
        row["children"], place = [], row["position"]
        across, along = (size[0], size[1]) if round(row["rotation"]["y"]) % 180 == 0 else (size[1], size[0])
        for i in range(math.floor(across / 0.3)):
            for j in range(math.floor(along / 0.3)):
                x = place["x"] - across / 2 + 0.15 + 0.3 * i
                z = place["z"] - along / 2 + 0.15 + 0.3 * j
                height = place["y"] + size[2] / 2 + 0.11 + catalog.kind("bowl").size[2] / 2
                row["children"].append(_row(f"{row['id']} {i} {j}", "hthor_bowl", {"x": x, "z": z}, height))
    return loader.house_from_document(changed, "crowded")


@pytest.mark.parametrize("number", [4, pytest.param(5, marks=pytest.mark.nightly)])
def test_tasks_in_houses_of_others_start_with_everything_apart(samples: list[Path], number: int):
    house = houses.load(samples[number])
    world = World(house)
    for made in custom_suite.make_tasks(Recipe(name="samples", tasks=3), house):
        assert not list(task_faults(made, house))
        world.reset(made)
        for placed in made.objects:
            x, y, z = placed.position
            world.put_object(placed.id, (x, y, z + 0.002), yaw=placed.yaw)


def test_an_object_in_a_thing_of_the_house_is_named_without_an_engine():
    house = houses.load("alder")
    made = task(house, 1)
    bowl = next(thing for thing in house.things if thing.kind == "potato")
    inside = Placement(
        id="apple",
        kind="apple",
        position=(*bowl.centre[:2], bottom(bowl) + 0.04),
        yaw=0.0,
        support=bowl.parent,
        relation="on",
    )
    others = tuple(one for one in made.objects if one.id != "apple")
    broken = msgspec.structs.replace(made, objects=(inside, *others))
    assert SupportSurfaces.of(house).within(inside, 0.01) == bowl.id
    assert ("objects[0].position", f"'apple' and '{bowl.id}' of the house are in one another") in task_faults(
        broken, house
    )
    verdict = solvability.check_task(broken)
    assert verdict.faults[0].field == "objects[0].position"
