from __future__ import annotations

import copy
import functools
import json
import math
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog, houses, jsonio
from hthor.errors import HouseError, UnknownName
from hthor.geometry.plane import inside, rectangle, signed_area, turn
from hthor.houses.checks.polygons import distance_to_segment, find_crossing, overlap_area, simplify
from hthor.types import HouseSpec, Opening, Vec2, Wall
from hthor.world.validation.house_soundness import check_soundness

OWN = houses.names()
DATA = Path(houses.__file__).parent / "data"
PRESENT = ("sink", "chair", "house_plant", "painting")
"""What every home has besides the receptacles; test_generator knows which has what of the rest."""


@functools.cache
def loaded(name: str) -> HouseSpec:
    return houses.load(name)


@pytest.fixture(params=OWN)
def house(request: pytest.FixtureRequest) -> HouseSpec:
    return loaded(request.param)


def own_document() -> Any:
    return json.loads((DATA / f"{OWN[0]}.json").read_bytes())


# ------------------------------------------------------------------------------------------------------- our own houses


def test_there_are_ten_houses_of_many_sizes() -> None:
    assert OWN == ("alder", "birch", "cedar", "elder", "hazel", "juniper", "linden", "maple", "rowan", "willow")
    specs = [houses.load(name) for name in OWN]
    assert {len(spec.rooms) for spec in specs} == {4, 5, 6, 7}
    areas = [sum(signed_area(room.polygon) for room in spec.rooms) for spec in specs]
    assert all(70 <= area <= 180 for area in areas)
    assert max(areas) > 2 * min(areas)


@pytest.mark.parametrize(
    "name", [name if name in ("elder", "hazel") else pytest.param(name, marks=pytest.mark.nightly) for name in OWN]
)
def test_a_house_of_our_own_is_proved_sound(name: str) -> None:
    """Every rule, the engine's among them: nothing floats, sticks in something or bars a door; all can be reached."""
    assert [str(finding) for finding in check_soundness(houses.load(name))] == []


def test_rooms_tile_the_floor_and_have_names_of_their_own(house: HouseSpec) -> None:
    """Beyond every stretch of a room's outline is another room, or a wall to the outside runs along it."""
    assert len({room.name for room in house.rooms}) == len(house.rooms)
    assert {room.kind for room in house.rooms} == {"kitchen", "living_room", "bedroom", "bathroom"}
    outside = [wall for wall in house.walls if wall.room == "exterior"]
    for index, room in enumerate(house.rooms):
        assert all(overlap_area(room.polygon, other.polygon) < 1e-9 for other in house.rooms[:index])
        for (ax, ay), (bx, by) in pairwise((*room.polygon, room.polygon[0])):
            length = math.dist((ax, ay), (bx, by))
            for share in (0.03, 0.23, 0.49, 0.77, 0.97):
                x, y = ax + share * (bx - ax), ay + share * (by - ay)
                beyond = (x + 0.05 * (by - ay) / length, y - 0.05 * (bx - ax) / length)
                neighbours = sum(inside(beyond, other.polygon) for other in house.rooms)
                shut = any(distance_to_segment((x, y), wall.a, wall.b) < 1e-6 for wall in outside)
                assert (neighbours, shut) in ((1, False), (0, True)), (room.id, x, y)


def test_every_receptacle_and_a_lived_in_home(house: HouseSpec) -> None:
    kinds = {thing.kind for thing in house.things}
    assert {*catalog.RECEPTACLES, *PRESENT} <= kinds
    assert not kinds & set(catalog.TARGETS)
    assert len({thing.id for thing in house.things}) == len(house.things)
    assert {room.id for room in house.rooms} == {thing.room for thing in house.things}
    assert len(house.things) >= 18 * len(house.rooms), "a home holds many things"
    assert len(kinds) >= 50


def test_things_are_in_the_room_that_they_name(house: HouseSpec) -> None:
    rooms = {room.id: room for room in house.rooms}
    for thing in house.things:
        corners = rectangle((thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw)
        assert all(inside(corner, rooms[thing.room].polygon) for corner in corners), thing.id


def test_doors_and_windows(house: HouseSpec) -> None:
    doors = [opening for opening in house.openings if opening.kind == "door"]
    outside = [door for door in doors if "exterior" in door.rooms]
    assert len(outside) == 1
    assert all(door.passable == (door not in outside) for door in doors)
    assert all(0.9 - 1e-9 <= math.dist(door.a, door.b) <= 1.6 + 1e-9 for door in doors)
    windows = [opening for opening in house.openings if opening.kind == "window"]
    assert 2 * len(windows) >= len(house.rooms)
    assert not any(window.passable for window in windows)
    faces = [wall for wall in house.walls if wall.room == "exterior"]
    for opening in house.openings:
        sides = [wall for wall in house.walls if wall.room in opening.rooms]
        along = [wall.room for wall in sides if on_line(opening, wall)]
        assert set(along) == set(opening.rooms), opening.id
        if opening.kind == "window":
            assert any(on_line(opening, wall) for wall in faces), "there is sky behind a window"


def on_line(opening: Opening, wall: Wall) -> bool:
    return max(distance_to_segment(point, wall.a, wall.b) for point in (opening.a, opening.b)) < 1e-6


def test_some_houses_have_an_open_plan() -> None:
    empty = {}
    for name in OWN:
        walls = json.loads((DATA / f"{name}.json").read_bytes())["walls"]
        empty[name] = {wall["id"] for wall in walls if wall.get("empty")}
        assert not empty[name] & {wall.id for wall in houses.load(name).walls}
    assert 0 < sum(bool(walls) for walls in empty.values()) < len(OWN)


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
    "half of a character": (_set("objects", 1, "id", to="chair\ud800"), "objects[1].id", "chair\\ud800"),
    "half of a character in a key": (_set("objects", 1, "\ud800", to=1), "objects[1]", "half of a character"),
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
        "is outside",
    ),
    "a window above its wall": (
        _set("windows", 0, "holePolygon", 1, "y", to=9),
        "windows[0].holePolygon[1].y",
        "is outside",
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
    assert find_crossing(turned) is None


def test_simple_and_crossed_polygons() -> None:
    assert find_crossing(SQUARE) is None
    assert find_crossing(((0, 0), (1, 1), (1, 0), (0, 1))) is not None
    assert find_crossing(((0, 0), (2, 0), (1, 0), (1, 1))) is not None
    doubled = [corner for corner in SQUARE for _ in range(2)]
    assert simplify([*doubled, SQUARE[0]]) == SQUARE
    assert all(a != b for a, b in pairwise(SQUARE))


# --------------------------------------------------------------------------------------------------- the package's door


@pytest.mark.parametrize(
    "first",
    [
        "import hthor.houses.checks.house_checks",
        pytest.param("from hthor.houses.checks.house_checks import Finding", marks=pytest.mark.nightly),
        "pass",
    ],
)
def test_check_is_the_function_in_whatever_order_things_are_imported(first: str) -> None:
    imports = "from hthor import houses\nfrom hthor.houses.checks.house_checks import check"
    code = f"{first}\n{imports}\nassert houses.check is check"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=900)


def test_loading_wakes_nothing_heavy() -> None:
    code = "import sys, hthor.houses\nassert not {'numpy', 'numba', 'mujoco'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=900)
