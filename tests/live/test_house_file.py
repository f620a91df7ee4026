"""The file of a house that a page draws."""

from __future__ import annotations

import gc
import gzip
import json
import struct
import weakref
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from live_session import Book
from two_rooms import house, thing

from hthor import houses
from hthor.live.control import SessionControl
from hthor.live.desk import Desk
from hthor.live.gltf import house_file, lit_house
from hthor.live.gltf.house_file import HouseFile
from hthor.live.loop import RealTimeLoop
from hthor.live.scenery import Scenery
from hthor.world import World
from hthor.world.model.inventory import DEFAULT_OBJECTS

MOST_TRIANGLES, MOST_BYTES = 250_000, 4_000_000


class Glb:
    """A glTF file that was read."""

    def __init__(self, file: HouseFile) -> None:
        data = gzip.decompress(file.data)
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size = struct.unpack_from("<I", data, 12)[0]
        self.document: dict[str, Any] = json.loads(data[20 : 20 + size])
        self._data = data[28 + size :]
        assert self.document["buffers"] == [{"byteLength": len(self._data)}]

    def primitives(self, node: dict[str, Any]) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = self.document["meshes"][node["mesh"]]["primitives"]
        return found

    @property
    def meshes(self) -> list[dict[str, Any]]:
        return [node for node in self.document["nodes"] if "mesh" in node]

    @property
    def still_colours(self) -> list[bytes]:
        """The colours of what has the house's light, doors included."""
        still = [node for node in self.meshes if node.get("extras", {"lit": True}).get("lit")]
        return [self.values(one["attributes"]["COLOR_0"]).tobytes() for node in still for one in self.primitives(node)]

    @property
    def triangles(self) -> int:
        ends = [one["indices"] for node in self.meshes for one in self.primitives(node)]
        return sum(self.document["accessors"][end]["count"] // 3 for end in ends)

    def values(self, number: int) -> Any:
        accessor = self.document["accessors"][number]
        view = self.document["bufferViews"][accessor["bufferView"]]
        kind = {5120: "i1", 5121: "u1", 5123: "u2", 5125: "u4", 5126: "f4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        stride = view.get("byteStride", np.dtype(kind).itemsize * width) // np.dtype(kind).itemsize
        raw = np.frombuffer(self._data, kind, accessor["count"] * stride, view["byteOffset"])
        return raw.reshape(accessor["count"], stride)[:, :width]


@pytest.fixture(scope="module")
def world() -> World:
    table = thing("table", "dining_table", 2.0, 2.0)
    return World(house(table, thing("fridge", "fridge", 6.0, 4.5)), robots=["tender"])


@pytest.fixture(scope="module")
def file(world: World, tmp_path_factory: pytest.TempPathFactory) -> HouseFile:
    return house_file.house_file(world.scene, world.house, tmp_path_factory.mktemp("files"))


def test_the_file_holds_the_house_and_everything_that_moves(world: World, file: HouseFile) -> None:
    read = Glb(file)
    still, ceilings, *moving = read.meshes
    assert (still["name"], ceilings["name"]) == ("still", "ceilings")
    assert {node["extras"]["owner"] for node in moving} >= {"human", "robot", "apple"}
    assert [node["extras"]["part"] for node in moving] == sorted(node["extras"]["part"] for node in moving)
    places, high = (
        np.concatenate([read.values(one["attributes"]["POSITION"]) for one in read.primitives(node)])
        for node in (still, ceilings)
    )
    assert high[:, 2].min() > 0.8 * world.house.height, "nothing else hides with them"
    x0, y0, x1, y1 = world.top_view_bounds
    assert places[:, :2].min(0) == pytest.approx((x0, y0), abs=0.5)
    assert places[:, :2].max(0) == pytest.approx((x1, y1), abs=0.5)
    for node in read.meshes:
        for one in read.primitives(node):
            count = len(read.values(one["attributes"]["POSITION"]))
            assert read.values(one["indices"]).max() < count
            assert np.linalg.norm(read.values(one["attributes"]["NORMAL"]) / 127.0, axis=1) == pytest.approx(
                1, abs=0.02
            )


def test_colours_are_neither_black_nor_white(file: HouseFile) -> None:
    read = Glb(file)
    bright = np.concatenate(
        [read.values(one["attributes"]["COLOR_0"]).max(1) for node in read.meshes[:2] for one in read.primitives(node)]
    )
    assert 40 < np.median(bright) < 200
    assert bright.min() < 30 < 170 < bright.max()
    light = np.array(read.document["scenes"][0]["extras"]["probes"]["light"])
    assert light.max() > 0.5
    assert light.min() < 0.1


def test_the_same_house_gives_the_same_file_and_is_computed_once(
    world: World, file: HouseFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    again = house_file.house_file(world.scene, world.house, tmp_path)
    assert again == file
    monkeypatch.setattr(house_file, "_make", None)
    assert house_file.house_file(world.scene, world.house, tmp_path) == file


def test_the_light_of_a_house_is_computed_once_for_all_tasks_in_it(
    world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = Glb(house_file.house_file(world.scene, world.house, tmp_path))
    monkeypatch.setattr(lit_house, "_make", None)
    other = World(world.house, robots=["tender"], objects=[*DEFAULT_OBJECTS, ("keys", "keys")])
    second = Glb(house_file.house_file(other.scene, other.house, tmp_path))
    assert "keys" in {node.get("extras", {}).get("owner") for node in second.meshes}
    assert first.still_colours == second.still_colours


def test_scenery_tells_what_has_moved(world: World, monkeypatch: pytest.MonkeyPatch, file: HouseFile) -> None:
    monkeypatch.setattr(house_file, "house_file", lambda scene, house: file)
    scenery = Scenery(world)
    assert set(scenery.moved()) == set(range(len(world.scene.moving)))
    assert scenery.moved() == {}
    world.robot.rotate(1.0)
    assert set(scenery.moved()) == set(scenery.own["robot"])
    scenery.restart()
    assert set(scenery.moved()) == set(range(len(world.scene.moving)))


def test_a_session_lets_go_of_houses_that_it_has_left(file: HouseFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(house_file, "house_file", lambda scene, house: file)
    control = SessionControl()
    loop = RealTimeLoop({}, control, Desk(control, {}, Book()), publish=lambda file: file.key)
    left = World(house(), robots=["tender"])
    gone = weakref.ref(left)
    assert loop._scenery(left) is loop._scenery(left)
    loop._scenery(World(house(), robots=["tender"]))
    del left
    gc.collect()
    assert gone() is None


@pytest.mark.nightly
@pytest.mark.parametrize("name", houses.names())
def test_every_home_is_small_enough_for_a_headset(name: str, tmp_path: Path) -> None:
    check_size(name, tmp_path)


@pytest.mark.nightly
def test_the_sample_houses_are_small_enough_for_a_headset(samples: list[Path], tmp_path: Path) -> None:
    for path in samples:
        check_size(str(path), tmp_path)


def check_size(name: str, folder: Path) -> None:
    world = World(name, robots=["tender"])
    file = house_file.house_file(world.scene, world.house, folder)
    own = sum(len(part.mesh.faces) for part in world.scene.parts if part.puppet in world.scene.seats["human"])
    triangles = Glb(file).triangles - own
    print(f"{name}: {triangles} triangles, {len(file.data)} bytes")  # noqa: T201  shown with -s
    assert len(file.data) <= MOST_BYTES
    assert triangles <= MOST_TRIANGLES
