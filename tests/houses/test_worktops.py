"""Worktops round a corner are as deep as worktops: for support, for who walks and reaches, and in pictures."""

from __future__ import annotations

import copy
import itertools
import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog, houses
from hthor.geometry.plane import to_local
from hthor.houses import loader
from hthor.houses.space import solids
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.solids import Slab
from hthor.types import HouseSpec, Thing
from hthor.world import World

DATA = Path(houses.__file__).parent / "data"
SCENE = "juniper"
HEIGHT_M = 0.938
DATABASE = {
    "CounterTop": [
        {"assetId": name, "objectType": "CounterTop", "boundingBox": {"x": w, "y": HEIGHT_M, "z": d},
         "primaryProperty": "Static"}
        for name, w, d in (("Countertop_L_10x10", 3.05, 3.05), ("Countertop_C_10x8", 3.05, 2.48),
                           ("Countertop_I_8x2", 2.44, 0.61))
    ],
    "Cup": [{"assetId": "Cup_1", "objectType": "Cup", "boundingBox": {"x": 0.08, "y": 0.1, "z": 0.08},
             "primaryProperty": "CanPickup"}],
}  # fmt: skip


def worktop(w: float, d: float, yaw: float = 0.0) -> Thing:
    return Thing(id="top", kind="counter_top", asset="", centre=(1.0, 2.0, 0.45), size=(w, d, 0.9), yaw=yaw)


def outline(thing: Thing) -> Slab:
    low = thing.centre[2] - thing.size[2] / 2
    return Slab(thing.centre[:2], thing.size[:2], thing.yaw, low, low + thing.size[2])


@given(
    st.sampled_from("LC"), st.floats(1.4, 4.0), st.floats(0.8, 4.0), st.sampled_from([0.0, 0.5, math.pi / 2, math.pi])
)
def test_the_units_fill_the_outline_and_nothing_else(plan: str, w: float, d: float, yaw: float):
    whole = worktop(w, d, yaw)
    units = loader.split_worktop(whole, plan)
    depth, arms = loader.DEPTH_M, {"L": 1, "C": 2}[plan]
    assert len(units) == 1 + 2 * arms
    assert len({unit.id for unit in units}) == len(units)
    area = sum(unit.size[0] * unit.size[1] for unit in units)
    assert area == pytest.approx(w * d - (w - arms * depth) * (d - depth))
    assert all(min(unit.size[:2]) == pytest.approx(depth) or min(unit.size[:2]) < depth for unit in units)
    for unit in units:
        u, v, _ = to_local(unit.centre, whole.centre, whole.yaw)
        assert abs(u) < w / 2
        assert abs(v) < d / 2
    for one, two in itertools.combinations(units, 2):
        assert solids.overlap_depth(outline(one), outline(two)) < 1e-9
    assert catalog.kind("counter_top").surfaces(units[0].size)


@pytest.mark.parametrize(("plan", "w", "d"), [("", 3.0, 3.0), ("I", 2.4, 0.61), ("L", 3.0, 0.65), ("C", 1.25, 3.0)])
def test_a_straight_or_tiny_one_is_one_thing(plan: str, w: float, d: float):
    assert loader.split_worktop(worktop(w, d), plan) == (worktop(w, d),)


def house(folder: Path, asset: str, rotation: int = 0) -> HouseSpec:
    """A scene with nothing in it but this worktop in the middle of its largest square room, cups all over its box."""
    document: Any = copy.deepcopy(json.loads((DATA / f"{SCENE}.json").read_bytes()))
    size = next(row for row in DATABASE["CounterTop"] if row["assetId"] == asset)["boundingBox"]
    floors = [room["floorPolygon"] for room in document["rooms"]]
    corners = max((floor for floor in floors if len(floor) == 4), key=_least)
    x, z = ((min(c[axis] for c in corners) + max(c[axis] for c in corners)) / 2 for axis in "xz")
    turn = {"x": 0, "y": rotation, "z": 0}
    cups = [
        {"id": f"cup {i} {j}", "assetId": "Cup_1", "rotation": turn, "position": {
            "x": x + _turned(u * size["x"], v * size["z"], rotation)[0], "y": HEIGHT_M + 0.1,
            "z": z + _turned(u * size["x"], v * size["z"], rotation)[1]}}
        for i, u in enumerate((-0.45, 0.0, 0.45)) for j, v in enumerate((-0.45, 0.0, 0.45))
    ]  # fmt: skip
    row = {"id": "top", "assetId": asset, "position": {"x": x, "y": HEIGHT_M / 2, "z": z}, "rotation": turn}
    document["objects"] = [{**row, "children": cups}]
    (folder / "asset-database.json").write_text(json.dumps(DATABASE))
    (folder / "corner.json").write_text(json.dumps(document))
    return houses.load(folder / "corner.json")


def _least(corners: Any) -> float:
    return min(max(c[axis] for c in corners) - min(c[axis] for c in corners) for axis in "xz")


def _turned(x: float, z: float, degrees: int) -> tuple[float, float]:
    """Unity's yaw runs clockwise, seen from above."""
    angle = math.radians(degrees)
    return (x * math.cos(angle) + z * math.sin(angle), z * math.cos(angle) - x * math.sin(angle))


@pytest.mark.parametrize("rotation", [0, 90, 180, 270])
def test_an_l_is_an_l_for_who_walks_and_puts_things_down(tmp_path: Path, rotation: int):
    spec = house(tmp_path, "Countertop_L_10x10", rotation)
    tops = [thing for thing in spec.things if thing.kind == "counter_top"]
    assert [top.id for top in tops] == ["top", "top|right_corner", "top|right"]
    whole = (tops[0].centre[0], tops[0].centre[1])
    cups = {thing.id: thing for thing in spec.things if thing.kind == "cup"}
    on = {name: cup.parent for name, cup in cups.items() if cup.lift == pytest.approx(0.05)}
    # back row and right column lie on it; what the file has over the notch lies on nothing
    corner, right = "top|right_corner", "top|right"
    assert on == {"cup 0 0": "top", "cup 1 0": "top", "cup 2 0": corner, "cup 2 1": right, "cup 2 2": right}
    notch = cups["cup 1 1"].centre[:2]
    space = FreeSpace.of(spec, 0.2)
    assert space.is_free(*notch), whole
    assert not space.is_free(*cups["cup 2 2"].centre[:2])


def test_a_c_has_two_arms_and_an_i_is_straight(tmp_path: Path):
    spec = house(tmp_path, "Countertop_C_10x8")
    names = {thing.id for thing in spec.things if thing.kind == "counter_top"}
    assert names == {"top", "top|right_corner", "top|right", "top|left_corner", "top|left"}
    by_id = {thing.id: thing for thing in spec.things}
    assert FreeSpace.of(spec, 0.2).is_free(*by_id["cup 1 1"].centre[:2])
    assert by_id["cup 0 2"].parent == "top|left"
    assert [thing.id for thing in house(tmp_path, "Countertop_I_8x2").things if thing.kind == "counter_top"] == ["top"]


def test_fronts_look_to_the_inside(tmp_path: Path):
    spec = house(tmp_path, "Countertop_C_10x8")
    tops = {thing.id: thing for thing in spec.things if thing.kind == "counter_top"}
    middle = tops["top"].centre
    for side in ("left", "right"):
        arm = tops[f"top|{side}"]
        u, v, _ = to_local(middle, arm.centre, arm.yaw)
        assert v > 0.0, (side, u, v)


def test_the_world_puts_things_on_every_unit_and_draws_no_slab(tmp_path: Path):
    spec = house(tmp_path, "Countertop_L_10x10")
    world = World(spec)
    world.reset()
    for unit in ("top", "top|right_corner", "top|right"):
        world.put_object("mug", on=unit)
        assert world.state("mug").support == unit
    notch = next(thing for thing in spec.things if thing.id == "cup 1 1").centre
    solid = world.model.geom_contype != 0
    near = (abs(world.model.geom_pos[:, 0] - notch[0]) < 0.3) & (abs(world.model.geom_pos[:, 1] - notch[1]) < 0.3)
    sizes = world.model.geom_size[solid & near]
    assert not any(size[0] > 0.5 and size[1] > 0.5 and size[2] < 0.1 for size in sizes)


def test_the_sample_houses_have_no_worktop_deeper_than_one(samples: list[Path]):
    found = [thing for path in samples for thing in houses.load(path).things if thing.kind == "counter_top"]
    assert found
    assert max(min(thing.size[:2]) for thing in found) <= 0.93  # an island's, of the database's largest depth
