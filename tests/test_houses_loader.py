from __future__ import annotations

import copy
import json
import math
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog, houses, jsonio
from hthor.errors import HouseError, UnknownName
from hthor.geometry import distance_to_rectangle, inside, rectangle, signed_area, to_local, turn
from hthor.houses.polygons import crossing, distance_to_segment, overlap_area, simplified
from hthor.types import HouseSpec, Thing, Vec2

OWN = houses.names()
DATA = Path(houses.__file__).parent / "data"
PRESENT = ("sink", "chair", "armchair", "television", "laptop", "shelf", "dresser", "pillow", "bowl", "plate")
LIVED_IN = (*PRESENT, "lamp", "house_plant", "painting", "bread", "coffee_machine")


@pytest.fixture(params=OWN)
def house(request: pytest.FixtureRequest) -> HouseSpec:
    return houses.load(request.param)


def own_document() -> Any:
    return json.loads((DATA / f"{OWN[0]}.json").read_bytes())


# ------------------------------------------------------------------------------------------------------- our own houses


def on_floor(house: HouseSpec) -> Iterator[Thing]:
    return (thing for thing in house.things if not thing.parent and not catalog.kind(thing.kind).wall_mounted)


def overlap(a: Thing, b: Thing) -> bool:
    """Whether two upright boxes share space, by the separating axis theorem."""
    if abs(a.centre[2] - b.centre[2]) >= (a.size[2] + b.size[2]) / 2 - 1e-6:
        return False
    corners = [rectangle((t.centre[0], t.centre[1]), (t.size[0], t.size[1]), t.yaw) for t in (a, b)]
    for yaw in (a.yaw, b.yaw):
        for ux, uy in (turn((1.0, 0.0), yaw), turn((0.0, 1.0), yaw)):
            first, second = ([x * ux + y * uy for x, y in polygon] for polygon in corners)
            if min(max(first), max(second)) - max(min(first), min(second)) <= 1e-6:
                return False
    return True


def test_there_are_three_houses_of_different_size() -> None:
    specs = [houses.load(name) for name in OWN]
    assert sorted(len(spec.rooms) for spec in specs) == [4, 5, 6]
    assert all(75 <= sum(signed_area(room.polygon) for room in spec.rooms) <= 120 for spec in specs)


def test_rooms_tile_the_floor_and_have_names_of_their_own(house: HouseSpec) -> None:
    assert len({room.name for room in house.rooms}) == len(house.rooms)
    assert {room.kind for room in house.rooms} == {"kitchen", "living_room", "bedroom", "bathroom"}
    for room in house.rooms:
        assert signed_area(room.polygon) >= 4
    for index, room in enumerate(house.rooms):
        assert all(overlap_area(room.polygon, other.polygon) < 1e-9 for other in house.rooms[:index])
    xs, ys = zip(*(corner for room in house.rooms for corner in room.polygon), strict=True)
    hull = (max(xs) - min(xs)) * (max(ys) - min(ys))
    assert sum(signed_area(room.polygon) for room in house.rooms) == pytest.approx(hull)


def test_every_receptacle_and_a_lived_in_home(house: HouseSpec) -> None:
    kinds = {thing.kind for thing in house.things}
    assert set(catalog.RECEPTACLES) <= kinds
    assert set(LIVED_IN) <= kinds
    assert not kinds & set(catalog.TARGETS)
    assert len({thing.id for thing in house.things}) == len(house.things)
    assert {room.id for room in house.rooms} == {thing.room for thing in house.things}


def test_no_two_pieces_overlap(house: HouseSpec) -> None:
    things = house.things
    for index, thing in enumerate(things):
        for other in things[:index]:
            if other.id != thing.parent and thing.id != other.parent:
                assert not overlap(thing, other), (thing.id, other.id)


def test_everything_stands_hangs_or_rests(house: HouseSpec) -> None:
    by_id = {thing.id: thing for thing in house.things}
    for thing in house.things:
        bottom = thing.centre[2] - thing.size[2] / 2
        if thing.parent:
            parent = by_id[thing.parent]
            x, y, z = to_local((thing.centre[0], thing.centre[1], bottom), parent.centre, parent.yaw)
            half = max(thing.size[:2]) / 2 if abs(math.sin(2 * (thing.yaw - parent.yaw))) > 1e-6 else None
            assert half is None, "things lie square on their support"
            across = abs(math.sin(thing.yaw - parent.yaw)) > 0.5
            width, depth = (thing.size[1], thing.size[0]) if across else (thing.size[0], thing.size[1])
            assert any(
                abs(z - surface.centre[2]) < 1e-4
                and abs(x - surface.centre[0]) + width / 2 <= surface.half[0] + 1e-3
                and abs(y - surface.centre[1]) + depth / 2 <= surface.half[1] + 1e-3
                and thing.size[2] <= surface.clearance + 1e-9
                for surface in catalog.kind(parent.kind).surfaces(parent.size)
            ), thing.id
        elif catalog.kind(thing.kind).wall_mounted:
            back = turn((0.0, -thing.size[1] / 2), thing.yaw)
            point = (thing.centre[0] + back[0], thing.centre[1] + back[1])
            assert min(distance_to_segment(point, wall.a, wall.b) for wall in house.walls) < 0.06
            assert bottom > 0.5
        else:
            assert abs(bottom) < 1e-4, thing.id


def test_things_stand_within_their_room_clear_of_walls_and_doors(house: HouseSpec) -> None:
    rooms = {room.id: room for room in house.rooms}
    for thing in house.things:
        corners = rectangle((thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw)
        assert all(inside(corner, rooms[thing.room].polygon) for corner in corners), thing.id
    for thing in on_floor(house):
        centre, size = (thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1])
        for corner in rectangle(centre, size, thing.yaw):
            assert min(distance_to_segment(corner, wall.a, wall.b) for wall in house.walls) > 0.06, thing.id
        for opening in house.openings:
            if opening.kind == "door":
                marks = [0.0, 0.5, 1.0]
                line = [tuple(a + m * (b - a) for a, b in zip(opening.a, opening.b, strict=True)) for m in marks]
                assert all(distance_to_rectangle((p[0], p[1]), centre, size, thing.yaw) > 0.35 for p in line), thing.id


def test_doors_and_windows(house: HouseSpec) -> None:
    doors = [opening for opening in house.openings if opening.kind == "door"]
    outside = [door for door in doors if "exterior" in door.rooms]
    assert len(outside) == 1
    assert all(door.passable == (door not in outside) for door in doors)
    assert all(0.9 - 1e-9 <= math.dist(door.a, door.b) <= 1.2 + 1e-9 for door in doors)
    windows = [opening for opening in house.openings if opening.kind == "window"]
    assert len(windows) >= len(house.rooms)
    assert not any(window.passable for window in windows)
    walls = {(wall.room, wall.a, wall.b): wall for wall in house.walls}
    for opening in house.openings:
        for side in opening.rooms:
            assert any(
                room == side and max(distance_to_segment(p, a, b) for p in (opening.a, opening.b)) < 1e-6
                for room, a, b in walls
            ), (opening.id, side)


def test_one_house_has_an_open_plan() -> None:
    empty = {
        name: [wall for wall in json.loads((DATA / f"{name}.json").read_bytes())["walls"] if wall.get("empty")]
        for name in OWN
    }
    assert sum(bool(walls) for walls in empty.values()) == 1
    name, walls = next((name, walls) for name, walls in empty.items() if walls)
    assert not {wall["id"] for wall in walls} & {wall.id for wall in houses.load(name).walls}


def test_a_fridge_s_door_has_room_to_swing(house: HouseSpec) -> None:
    for fridge in (thing for thing in house.things if thing.kind == "fridge"):
        kind = catalog.kind("fridge")
        (hinge,) = kind.joints(fridge.size)
        for step in range(1, 21):
            for reach in (0.25, 0.5, 0.75, 1.0):
                tip = turn((reach * fridge.size[0], 0.0), hinge.travel * step / 20)
                x, y = turn((hinge.anchor[0] + tip[0], hinge.anchor[1] + tip[1]), fridge.yaw)
                point = (fridge.centre[0] + x, fridge.centre[1] + y)
                for thing in on_floor(house):
                    if thing.id != fridge.id:
                        size = (thing.size[0], thing.size[1])
                        assert distance_to_rectangle(point, (thing.centre[0], thing.centre[1]), size, thing.yaw) > 0.03
                assert min(distance_to_segment(point, wall.a, wall.b) for wall in house.walls) > 0.05


def test_the_start_is_free_floor(house: HouseSpec) -> None:
    start = (house.start.x, house.start.y)
    assert any(inside(start, room.polygon) for room in house.rooms)
    for thing in on_floor(house):
        size = (thing.size[0], thing.size[1])
        assert distance_to_rectangle(start, (thing.centre[0], thing.centre[1]), size, thing.yaw) > 0.3


# ------------------------------------------------------------------------------------------------------------- loading


def test_the_hash_is_that_of_the_content(tmp_path: Path) -> None:
    document = own_document()
    path = tmp_path / "copy.json"
    path.write_text(json.dumps(document, indent=7, sort_keys=True))
    copied, original = houses.load(path), houses.load(OWN[0])
    assert copied.sha256 == original.sha256 == jsonio.sha256(document)
    assert copied.id == "copy"
    assert copied.things == original.things


def test_frames() -> None:
    """Unity's (x, y, z) is the house frame's (x, z, y); yaws turn the other way; an agent at 0 degrees faces +y."""
    document = own_document()
    house = houses.load(OWN[0])
    row, thing = document["objects"][0], house.things[0]
    position = row["position"]
    assert thing.centre == (position["x"], position["z"], position["y"])
    assert math.remainder(thing.yaw + math.radians(row["rotation"]["y"]), 2 * math.pi) == pytest.approx(0)
    agent = document["metadata"]["agent"]
    heading = math.pi / 2 - math.radians(agent["rotation"]["y"])
    assert math.remainder(house.start.yaw - heading, 2 * math.pi) == pytest.approx(0)
    assert all(signed_area(room.polygon) > 0 for room in house.rooms)


def test_an_unknown_house() -> None:
    with pytest.raises(UnknownName, match=rf"Did you mean '{OWN[0]}'.*\.json"):
        houses.load(OWN[0][:-1])


def test_a_newer_file_s_poses(tmp_path: Path) -> None:
    document = own_document()
    agent = document["metadata"].pop("agent")
    elsewhere = copy.deepcopy(agent)
    elsewhere["position"]["x"] += 0.25
    document["metadata"]["agentPoses"] = {"arm": elsewhere, "default": agent}
    path = tmp_path / "newer.json"
    path.write_text(json.dumps(document))
    assert houses.load(path).start == houses.load(OWN[0]).start


def test_foreign_assets_need_a_database(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HTHOR_ASSETS", raising=False)
    monkeypatch.chdir(tmp_path)
    document = own_document()
    document["objects"][2]["assetId"] = "Bed_11"
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(document))
    with pytest.raises(HouseError, match=r"mine\.json: objects\[2\]\.assetId: unknown asset 'Bed_11'.*HTHOR_ASSETS"):
        houses.load(path)
    row = {"assetId": "Bed_11", "objectType": "Bed", "boundingBox": {"x": 1.5, "y": 0.9, "z": 2.0}}
    database = tmp_path / "elsewhere" / "asset-database.json"
    jsonio.write(database, json.dumps({"Bed": [row]}).encode())
    for place in (database, database.parent):
        bed = next(thing for thing in houses.load(path, assets=place).things if thing.asset == "Bed_11")
        assert (bed.kind, bed.size) == ("bed", (1.5, 2.0, 0.9))
    monkeypatch.setenv("HTHOR_ASSETS", str(database))
    assert houses.load(path) == houses.load(path, assets=database)
    monkeypatch.setenv("HTHOR_ASSETS", str(tmp_path / "absent"))
    with pytest.raises(HouseError, match=r"absent.*HTHOR_ASSETS names it"):
        houses.load(path)
    monkeypatch.delenv("HTHOR_ASSETS")
    jsonio.write(tmp_path / "databases" / "asset-database.json", json.dumps({"Bed": [row]}).encode())
    assert any(thing.kind == "bed" for thing in houses.load(path).things)
    document["objects"][2]["assetId"] = "Bed_12"
    path.write_text(json.dumps(document))
    with pytest.raises(HouseError, match=r"'Bed_12': neither ours nor in .*asset-database"):
        houses.load(path)


def test_the_samples_load(samples: list[Path]) -> None:
    for path in samples:
        house = houses.load(path)
        document = json.loads(path.read_bytes())
        assert house.sha256 == jsonio.sha256(document)
        assert len(house.rooms) == len(document["rooms"])
        assert len({room.name for room in house.rooms}) == len(house.rooms)
        outside = [opening for opening in house.openings if opening.kind == "door" and "exterior" in opening.rooms]
        assert len(outside) == 1
        assert not outside[0].passable
        assert all(opening.passable for opening in house.openings if opening.kind == "door" and opening not in outside)
        assert all(thing.room for thing in house.things)
        assert all(min(thing.size) > 0 for thing in house.things)
        assert house.height == pytest.approx(max(wall.height for wall in house.walls))


# ------------------------------------------------------------------------------------------------------- damaged copies


def _set(*path: str | int, to: Any) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = to

    return change


def _drop(*path: str | int) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in path[:-1]:
            document = document[key]
        del document[path[-1]]

    return change


def _same_id(key: str) -> Callable[[Any], None]:
    return lambda document: document[key][1].update(id=document[key][0]["id"])


def _shift_room(document: Any) -> None:
    document["rooms"][1]["floorPolygon"] = copy.deepcopy(document["rooms"][0]["floorPolygon"])


def _bow_tie(document: Any) -> None:
    document["rooms"][0]["floorPolygon"] = [{"x": x, "y": 0, "z": z} for x, z in ((0, 0), (2, 2), (2, 0), (0, 2))]


def _flat(document: Any) -> None:
    document["rooms"][0]["floorPolygon"] = [{"x": x, "y": 0, "z": 0} for x in (0, 1, 2)]


DAMAGE: dict[str, tuple[Callable[[Any], None], str, str]] = {
    "a key is missing": (_drop("rooms"), "rooms", "missing"),
    "a deep key is missing": (_drop("walls", 3, "polygon", 0, "x"), "walls[3].polygon[0].x", "missing"),
    "a text for a number": (
        _set("walls", 3, "polygon", 0, "x", to="wide"),
        "walls[3].polygon[0].x",
        "expected a number, got a text",
    ),
    "a number for a list": (_set("doors", to=3), "doors", "expected a list"),
    "not a number": (_set("walls", 3, "polygon", 0, "x", to=math.nan), "walls[3].polygon[0].x", "finite"),
    "infinity": (_set("objects", 1, "position", "y", to=math.inf), "objects[1].position.y", "finite"),
    "a number beyond measure": (_set("objects", 1, "position", "y", to=10**400), "objects[1].position.y", "finite"),
    "another version": (_set("metadata", "schema", to="0.0.1"), "metadata.schema", "1.0.0"),
    "no rooms": (_set("rooms", to=[]), "rooms", "empty"),
    "no walls": (_set("walls", to=[]), "walls", "empty"),
    "an unknown room type": (_set("rooms", 0, "roomType", to="Garage"), "rooms[0].roomType", "Kitchen"),
    "two rooms of one id": (_same_id("rooms"), "rooms[1].id", "rooms[0]"),
    "two walls of one id": (_same_id("walls"), "walls[1].id", "walls[0]"),
    "two objects of one id": (_same_id("objects"), "objects[", "unique"),
    "rooms overlap": (_shift_room, "rooms[1].floorPolygon", "overlaps"),
    "two corners": (
        lambda document: document["rooms"][0].update(floorPolygon=document["rooms"][0]["floorPolygon"][:2]),
        "rooms[0].floorPolygon",
        "3",
    ),
    "a bow tie": (_bow_tie, "rooms[0].floorPolygon", "crosses itself"),
    "a flat room": (_flat, "rooms[0].floorPolygon", ""),
    "a wall of no room": (_set("walls", 0, "roomId", to="room|99"), "walls[0].roomId", "room|99"),
    "a wall of three corners": (
        lambda document: document["walls"][0]["polygon"].pop(),
        "walls[0].polygon",
        "needs 4 corners",
    ),
    "a door of no room": (_set("doors", 0, "room1", to="room|99"), "doors[0].room1", "room|99"),
    "a door in no wall": (_set("doors", 0, "wall0", to="wall|99"), "doors[0].wall0", "wall|99"),
    "a door whose other wall is unknown": (_set("doors", 0, "wall1", to="wall|99"), "doors[0].wall1", "wall|99"),
    "a hole beyond its wall": (
        _set("doors", 0, "holePolygon", 1, "x", to=55),
        "doors[0].holePolygon[1].x",
        "outside of",
    ),
    "a window above its wall": (
        _set("windows", 0, "holePolygon", 1, "y", to=9),
        "windows[0].holePolygon[1].y",
        "outside of",
    ),
    "a hole of one corner": (
        lambda document: document["doors"][0]["holePolygon"].pop(),
        "doors[0].holePolygon",
        "2 opposite corners",
    ),
    "an object in the garden": (_set("objects", 0, "position", "x", to=-30), "objects[0].position", "outside"),
    "an object in the cellar": (_set("objects", 0, "position", "y", to=-3), "objects[0].position.y", "height"),
    "an unknown asset": (_set("objects", 0, "assetId", to="Nothing_1"), "objects[0].assetId", "Nothing_1"),
    "an asset of no size": (
        _set("objects", 0, "assetId", to="hthor_bed_0x200x50"),
        "objects[0].assetId",
        "positive",
    ),
    "no start": (_drop("metadata", "agent"), "metadata.agent", "missing"),
    "a start in the garden": (
        _set("metadata", "agent", "position", "x", to=-30),
        "metadata.agent.position",
        "outside",
    ),
}


def assert_refused(path: Path, field: str, problem: str) -> None:
    with pytest.raises(HouseError) as caught:
        houses.load(path)
    error = caught.value
    assert error.file == str(path)
    assert str(path) in str(error)
    assert error.field.startswith(field)
    assert error.field in str(error)
    assert problem in error.problem


@pytest.mark.parametrize("name", DAMAGE)
def test_a_damaged_copy_of_an_own_house(name: str, tmp_path: Path) -> None:
    damage, field, problem = DAMAGE[name]
    document = own_document()
    damage(document)
    path = tmp_path / "damaged.json"
    path.write_text(json.dumps(document))
    assert_refused(path, field, problem)


def test_damaged_copies_of_a_sample(samples: list[Path], tmp_path: Path) -> None:
    text = samples[0].read_text()
    path = tmp_path / "damaged.json"
    for damage, field, problem in DAMAGE.values():
        document = json.loads(text)
        damage(document)
        path.write_text(json.dumps(document))
        assert_refused(path, field, problem)


def test_files_that_are_no_documents(tmp_path: Path) -> None:
    path = tmp_path / "damaged.json"
    text = (DATA / f"{OWN[0]}.json").read_text()
    cases: dict[str, bytes] = {
        "truncated": text[: len(text) // 2].encode(),
        "line 1, column 2": b"{rooms: []}",
        "expected an object": b"[]",
        "UTF-8": b"\xff\xfe\x00",
        "not a house file": b"[" * 100_000,
        "line 1, column 1": b"",
    }
    for problem, data in cases.items():
        path.write_bytes(data)
        if problem == "truncated":
            path.write_text(text[: text.index('"walls"') + 9])
        assert_refused(path, "$", problem)
    assert_refused(tmp_path / "absent.json", "$", "cannot read")
    assert_refused(tmp_path / "folder.json", "$", "cannot read")


# ------------------------------------------------------------------------------------------------------------ polygons

SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
coordinate = st.floats(-3, 3)


@given(coordinate, coordinate, st.floats(0.1, 3), st.floats(0.1, 3))
def test_overlap_of_rectangles(x: float, y: float, width: float, depth: float) -> None:
    other = ((x, y), (x + width, y), (x + width, y + depth), (x, y + depth))
    across = max(0.0, min(1.0, x + width) - max(0.0, x))
    along = max(0.0, min(1.0, y + depth) - max(0.0, y))
    assert overlap_area(SQUARE, other) == pytest.approx(across * along, abs=1e-9)
    assert overlap_area(other, SQUARE) == pytest.approx(across * along, abs=1e-9)


@given(st.floats(-math.pi, math.pi), coordinate, coordinate)
def test_overlap_with_itself_is_the_area(yaw: float, x: float, y: float) -> None:
    shape: list[Vec2] = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    turned = [(a + x, b + y) for a, b in (turn(corner, yaw) for corner in shape)]
    assert overlap_area(turned, turned) == pytest.approx(3.0, rel=1e-6)
    assert crossing(turned) is None


def test_simple_and_crossed_polygons() -> None:
    assert crossing(SQUARE) is None
    assert crossing(((0, 0), (1, 1), (1, 0), (0, 1))) is not None
    assert crossing(((0, 0), (2, 0), (1, 0), (1, 1))) is not None
    doubled = [corner for corner in SQUARE for _ in range(2)]
    assert simplified([*doubled, SQUARE[0]]) == SQUARE
    assert all(a != b for a, b in pairwise(SQUARE))


# --------------------------------------------------------------------------------------------------- the package's door


@pytest.mark.parametrize("first", ["import hthor.houses.check", "from hthor.houses.check import Finding", "pass"])
def test_check_is_the_function_in_whatever_order_things_are_imported(first: str) -> None:
    code = f"{first}\nfrom hthor import houses\nfrom hthor.houses.check import check\nassert houses.check is check"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def test_loading_wakes_nothing_heavy() -> None:
    code = "import sys, hthor.houses\nassert not {'numpy', 'numba', 'mujoco'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)
