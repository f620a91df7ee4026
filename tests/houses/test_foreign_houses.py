"""What other people's house files may hold and still load: the forms that the ProcTHOR family has taken."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from hthor import houses
from hthor.errors import HouseError
from hthor.houses import loader
from hthor.houses.checks.house_checks import check
from hthor.houses.generator import generate
from hthor.types import HouseSpec

DATA = Path(houses.__file__).parent / "data"


def own() -> Any:
    return json.loads((DATA / f"{houses.names()[0]}.json").read_bytes())


def built(change: Callable[[Any], None], document: Any = None) -> HouseSpec:
    changed = copy.deepcopy(own() if document is None else document)
    change(changed)
    return loader.house_from_document(changed, "mine")


def without_hash(house: HouseSpec) -> HouseSpec:
    return msgspec.structs.replace(house, sha256="", id="", start_source="")


def newer(document: Any) -> None:
    """The form of later files: a pose for each robot, nulls, and keys that nobody here reads."""
    agent = document["metadata"].pop("agent")
    document["metadata"]["agentPoses"] = {"arm": None, "default": agent, "locobot": {**agent, "standing": None}}
    for row in document["objects"]:
        row |= {"objectType": "Thing", "material": None, "color": {"r": 1, "g": 0, "b": 0}, "layer": "Procedural1"}
        row.setdefault("children", None)
        row["openness"] = None
    for wall in document["walls"]:
        wall.setdefault("empty", None)
    del document["metadata"]["schema"]


def test_a_document_and_its_file_are_one_house(tmp_path: Path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(own()))
    assert loader.house_from_document(own(), "mine") == houses.load(path)


def test_the_newer_form_is_the_same_house():
    assert without_hash(built(newer)) == without_hash(built(lambda document: None))


def test_the_newer_form_of_the_samples_is_the_same_house(samples: list[Path], tmp_path: Path):
    for path in samples[:3]:
        document = json.loads(path.read_bytes())
        newer(document)
        copied = path.parent / path.name
        other = tmp_path / path.name
        other.write_text(json.dumps(document))
        database = path.parent / "databases"
        assert without_hash(houses.load(other, assets=database)) == without_hash(houses.load(copied))


def test_looks_may_be_missing():
    def drop(document: Any) -> None:
        document["windows"] = None
        for room in document["rooms"]:
            room["floorMaterial"] = None
        for wall in document["walls"]:
            wall["material"] = None

    house = built(drop)
    assert {room.floor for room in house.rooms} == {""}
    assert not [opening for opening in house.openings if opening.kind == "window"]
    assert len(house.walls) == len(built(lambda document: None).walls)


@pytest.mark.parametrize(
    ("openable", "openness", "passable"),
    [(True, 0, True), (True, 1, True), (False, 0, False), (None, None, True), (None, 0, False)],
)
def test_a_door_that_can_be_opened_is_no_wall(openable: bool | None, openness: float | None, passable: bool):
    def shut(document: Any) -> None:
        document["doors"][0] |= {"openable": openable, "openness": openness}

    door = built(shut).openings[0]
    assert door.passable == passable
    assert door.openable == (passable and bool(openable))


def test_the_outside_door_stays_shut_whatever_it_says():
    def open_all(document: Any) -> None:
        for door in document["doors"]:
            door |= {"openable": True, "openness": 1}

    outside = [door for door in built(open_all).openings if door.kind == "door" and "exterior" in door.rooms]
    assert outside
    assert not any(door.passable for door in outside)


def test_a_floor_may_touch_itself_at_a_corner():
    """Rooms that are grown cell by cell can close a ring; what lies in the ring belongs to another room."""
    corners = [(0, 0), (3, 0), (3, 1), (2, 1), (2, 2), (1, 2), (1, 1), (2, 1), (2, 0.5), (0, 0.5)]
    pinched = [(0, 0), (2, 0), (2, 2), (4, 2), (4, 4), (2, 4), (2, 2), (0, 2)]
    for polygon, fine in ((pinched, True), (corners, True), ([(0, 0), (2, 2), (2, 0), (0, 2)], False)):
        rows = [{"x": 50.0 + x, "y": 0, "z": 50.0 + z} for x, z in polygon]

        def add(document: Any, rows: Any = rows) -> None:
            document["rooms"].append({"id": "room|99", "roomType": "Bedroom", "floorPolygon": rows})

        if fine:
            assert built(add).rooms[-1].id == "room|99"
        else:
            with pytest.raises(HouseError, match="crosses itself"):
                built(add)


def test_things_put_down_badly_load_and_are_told_of():
    """Near the outline of the floor, that is: what is far from every room is a mistake of the file."""

    def push(document: Any) -> None:
        corners = [corner for room in document["rooms"] for corner in room["floorPolygon"]]
        west = min(corners, key=lambda corner: (corner["x"], corner["z"]))
        document["objects"][0]["position"] |= {"x": west["x"] - 0.6, "z": west["z"] + 0.5}
        document["objects"][1]["position"]["y"] = -0.3

    house = built(push)
    assert house.things[0].room
    assert [f.where for f in check(house, 0.2) if f.rule == "thing-indoors"] == [house.things[0].id]


def test_a_hole_may_reach_a_little_beyond_its_wall():
    def widen(document: Any) -> None:
        document["windows"][0]["holePolygon"][0]["x"] = -0.05

    assert built(widen).openings[-1].kind == "window"


def test_an_asset_without_a_known_size_is_named_with_its_field():
    def objaverse(document: Any) -> None:
        parent = next(row for row in document["objects"] if row.get("children"))
        parent["children"][0]["assetId"] = "0a1f5b7c9d3e4f60a1b2c3d4e5f60718"

    with pytest.raises(HouseError, match=r"objects\[\d+\]\.children\[0\]\.assetId: unknown asset '0a1f5b7c"):
        built(objaverse)


def test_nearly_every_room_of_the_samples_can_be_reached_by_broader_bodies_too(samples: list[Path]):
    specs = [spec for spec in map(houses.load, samples) if len(spec.rooms) >= 3]
    for radius, share in ((0.20, 1.0), (0.25, 0.97)):
        reached = [not any(f.rule == "room-reachable" for f in check(spec, radius)) for spec in specs]
        assert sum(reached) >= share * len(specs)


def test_what_the_generator_writes_is_read_back():
    document = generate(1, 4)
    house = loader.house_from_document(document, "made")
    assert len(house.rooms) == 4
    assert len({thing.id for thing in house.things}) == len(house.things)
