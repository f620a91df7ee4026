"""Every id of a house file names one thing, and none is a name of hthor's own; what can be used loads and is found."""

from __future__ import annotations

import copy
import functools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import catalog, houses
from hthor.errors import HouseError
from hthor.houses import loader
from hthor.houses.checks import ids
from hthor.tasks.suites import library
from hthor.types import HouseSpec
from hthor.world import World

FOLDER = Path(houses.__file__).parent
OWN = json.loads((FOLDER / "data" / "alder.json").read_bytes())
SEATS = [f"{name}{number}" for name in ("human", "robot") for number in ("", 2, 3, 20)]
PARTS = ["floor", "ceiling", "wall", "ground", "outdoors", "roof", "exterior", "floor of room|2", "ceiling of x"]
LISTS = ("rooms", "walls", "doors", "windows")


def rows_of(document: Any) -> Iterator[tuple[str, Any]]:
    """Everything in the document that has an id, with its field."""

    def walk(rows: list[Any], where: str) -> Iterator[tuple[str, Any]]:
        for index, row in enumerate(rows):
            yield f"{where}[{index}]", row
            yield from walk(row.get("children") or [], f"{where}[{index}].children")

    for name in (*LISTS, "objects"):
        yield from walk(document[name], name)


def renamed(where: str, name: str, document: Any = OWN) -> Any:
    changed = copy.deepcopy(document)
    dict(rows_of(changed))[where]["id"] = name
    return changed


FIELDS = {where: row["id"] for where, row in rows_of(OWN)}
THINGS = [where for where in FIELDS if where.startswith("objects")]


def refusal(document: Any) -> HouseError:
    with pytest.raises(HouseError) as caught:
        loader.house_from_document(document, "mine.json")
    assert len(str(caught.value).splitlines()) == 1
    return caught.value


@settings(max_examples=cases(60))
@given(st.data())
def test_no_two_things_of_any_sort_have_one_id(data: st.DataObject) -> None:
    first, second = data.draw(st.lists(st.sampled_from(sorted(FIELDS)), min_size=2, max_size=2, unique=True))
    name = FIELDS[second]
    if data.draw(st.booleans()):
        name = name.replace("|", "/")  # the same in the engine
    error = refusal(renamed(first, name))
    order = list(FIELDS)
    later, earlier = max(first, second, key=order.index), min(first, second, key=order.index)
    assert error.field == f"{later}.id"
    assert f"already belongs to {earlier}" in error.problem


@settings(max_examples=cases(60))
@given(st.sampled_from(sorted(FIELDS)), st.sampled_from([*SEATS, *PARTS, *catalog.TARGETS]))
def test_nothing_has_a_name_of_hthors_own(where: str, name: str) -> None:
    error = refusal(renamed(where, name))
    assert error.field == f"{where}.id"
    assert name in error.problem
    assert "choose another id" in error.problem


@settings(max_examples=cases(60))
@given(
    st.sampled_from(sorted(FIELDS)),
    st.one_of(
        st.text(st.characters(categories=["Cc", "Cf", "Zl", "Zp", "Co", "Cn"]), min_size=1, max_size=5),
        st.text(" ", max_size=3),
        st.integers(ids.LONGEST + 1, 20_000).map(lambda length: "x" * length),
    ),
)
def test_no_id_is_empty_or_cannot_be_shown(where: str, name: str) -> None:
    error = refusal(renamed(where, name))
    assert error.field == f"{where}.id"
    assert len(str(error)) < 300
    assert str(error).isprintable()


@settings(max_examples=cases(15))
@given(st.sampled_from(sorted(FIELDS)), st.sampled_from([3, None, ["a"], {"a": 1}, 1.5, True]))
def test_an_id_is_a_text(where: str, value: object) -> None:
    changed = copy.deepcopy(OWN)
    dict(rows_of(changed))[where]["id"] = value
    error = refusal(changed)
    assert error.field == f"{where}.id"
    assert "expected a text" in error.problem


@settings(max_examples=cases(40))
@given(
    st.sampled_from(THINGS),
    st.text(st.characters(categories=["L", "N", "P", "S"]), min_size=1, max_size=ids.LONGEST).filter(
        lambda name: not any(ids.id_faults([("here", name)]))
    ),
)
def test_every_other_text_is_an_id(where: str, name: str) -> None:
    if name in FIELDS.values():
        return
    house = loader.house_from_document(renamed(where, name), "mine.json")
    assert [thing.source for thing in house.things if thing.id == name] == [where]


def test_a_part_of_a_worktop_is_named_by_nothing_else() -> None:
    rows = copy.deepcopy(OWN)
    at = {"x": 2.0, "y": 0.5, "z": 2.0}
    zero = {"x": 0, "y": 0, "z": 0}
    rows["objects"][0] |= {"id": "top", "assetId": "Countertop_L_8x8", "position": at, "rotation": zero}
    box = {"x": 2.0, "y": 0.95, "z": 2.0}
    row = {"assetId": "Countertop_L_8x8", "objectType": "CounterTop", "boundingBox": box, "primaryProperty": "Static"}
    for where in ("objects[1]", "doors[0]", "objects[0].children[0]"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(loader.Assets, "find", _finding(row))
            error = refusal(renamed(where, "top|right", rows))
        assert error.field == f"{where}.id"
        assert "a part of the worktop 'top' (objects[0])" in error.problem


def _finding(row: Any) -> Any:
    from hthor.catalog.procthor import Asset

    own = loader.Assets.find
    box = row["boundingBox"]
    worktop = Asset(kind="counter_top", size=(box["x"], box["z"], box["y"]), plan="L")
    return lambda self, asset, *more: worktop if asset == row["assetId"] else own(self, asset, *more)


@functools.cache
def scene(name: str) -> HouseSpec:
    return houses.load(name)


@pytest.mark.parametrize("name", [*houses.names(), *houses.names("unseen")])
def test_the_houses_that_come_with_hthor_keep_the_rule(name: str) -> None:
    house = scene(name)
    names = [one.id for group in (house.rooms, house.walls, house.openings, house.things) for one in group]
    assert not list(ids.id_faults((one, one) for one in names))


@pytest.mark.parametrize("name", ["smoke", "paper", "collect", "carry", "navigation"])
def test_what_tasks_bring_has_a_name_that_no_house_can_have(name: str) -> None:
    """So no sound house can have a thing of the same id, which a world with the task's objects would refuse."""
    for task in library.load_suite(name).tasks:
        own = {thing.id for thing in scene(task.house).things}
        for placement in task.objects:
            assert placement.id in own or list(ids.id_faults([("", placement.id)])), placement.id


def test_every_name_in_a_world_is_that_of_one_thing() -> None:
    """Bodies, parts of the house and things: what a world calls anything is what nothing else is called."""
    world = World("alder", robots=["tender", "puck"], people=2)
    own = [*FIELDS.values()]
    assert not {*world.seats} & {*own}
    assert {name for name in world.names if name not in own} <= {
        *world.seats, *catalog.TARGETS, "ground", "outdoors", "roof",
        *(f"{part} of {room.id}" for part in ("floor", "ceiling") for room in world.house.rooms),
    }  # fmt: skip
