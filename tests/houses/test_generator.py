from __future__ import annotations

import functools
import hashlib
import json
import math
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import catalog, houses, jsonio
from hthor.errors import HthorError, UnknownName
from hthor.geometry.plane import signed_area
from hthor.houses import generator, loader
from hthor.houses.checks.house_checks import check
from hthor.houses.checks.house_rules import is_sound
from hthor.houses.generator import document, shipped, validity
from hthor.houses.generator.attempt import AttemptFailed
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan import doors, growth, layout, room_specs
from hthor.houses.generator.furnishing.clutter import all_fit
from hthor.houses.generator.furnishing.item_styles import ItemStyler
from hthor.types import HouseSpec

few = settings(max_examples=3, suppress_health_check=list(HealthCheck))
seeds = st.integers(min_value=0, max_value=10**6)
counts = st.integers(min_value=4, max_value=7)
HOUSES = ((3, 4), *(pytest.param(*pair, marks=pytest.mark.nightly) for pair in ((4, 5), (5, 6))), (6, 7))


@functools.cache
def made(seed: int, rooms: int, needs: frozenset[str] | None = None) -> HouseSpec:
    return loader.house_from_document(generator.generate(seed, rooms, needs=needs), "made")


@functools.cache
def _document() -> bytes:
    return jsonio.canonical(generator.generate(3, 4))


def small_document() -> dict[str, Any]:
    """A fresh copy of the document of a small house."""
    return json.loads(_document())


# ----------------------------------------------------------------------------------------------------- whole houses


@pytest.mark.parametrize(("seed", "rooms"), HOUSES)
def test_a_generated_house_is_sound(seed: int, rooms: int) -> None:
    house = made(seed, rooms)
    assert len(house.rooms) == rooms
    assert is_sound(check(house, 0.25, strict=True))
    space, free = validity.floor(house)
    assert list(validity.find_faults(house, space, validity.reached(free))) == []
    kinds = {thing.kind for thing in house.things}
    assert {*catalog.RECEPTACLES, "sink", "chair"} <= kinds
    assert not kinds & set(catalog.TARGETS)
    area = sum(signed_area(room.polygon) for room in house.rooms)
    assert growth.AREA_M2[0] - 1e-6 <= area <= growth.AREA_M2[1] + 1e-6


@pytest.mark.parametrize(("seed", "rooms"), HOUSES)
def test_one_front_door_and_all_others_open(seed: int, rooms: int) -> None:
    house = made(seed, rooms)
    inner = [opening for opening in house.openings if opening.kind == "door" and opening.passable]
    front = [opening for opening in house.openings if opening.kind == "door" and not opening.passable]
    assert len(front) == 1
    assert "exterior" in front[0].rooms
    assert rooms - 2 <= len(inner) <= rooms - 1, "one open plan at most, and no door too many"
    assert all(math.dist(opening.a, opening.b) >= 0.9 for opening in inner)


def test_the_same_seed_gives_the_same_bytes_in_another_process() -> None:
    here = hashlib.sha256(_document()).hexdigest()
    code = (
        "import hashlib; from hthor import jsonio; from hthor.houses import generator;"
        "print(hashlib.sha256(jsonio.canonical(generator.generate(3, 4))).hexdigest())"
    )
    there = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONHASHSEED": "7"},
    )
    assert there.stdout.strip() == here


def test_what_is_written_is_what_loads(tmp_path: Path) -> None:
    made_ = small_document()
    generator.write(made_, tmp_path / "a.json")
    generator.write(made_, tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    assert houses.load(tmp_path / "a.json").sha256 == jsonio.sha256(made_)


# ------------------------------------------------------------------------------------------------------------- requests


@few
@given(seeds, st.sets(st.sampled_from(generator.OPTIONAL)))
def test_a_house_has_the_optional_kinds_asked_for_and_no_others(seed: int, needs: set[str]) -> None:
    kinds = {thing.kind for thing in made(seed, 4, frozenset(needs)).things}
    assert kinds & set(generator.OPTIONAL) == needs


def test_requests_that_cannot_be_met_are_refused() -> None:
    with pytest.raises(HthorError, match="4 to 7 rooms, got 3"):
        generator.generate(0, 3)
    with pytest.raises(UnknownName, match="room spec 'castle'"):
        generator.generate(0, 4, "castle")
    with pytest.raises(HthorError, match=r"'5-room' does not have 4 rooms; specs that do: 4-room"):
        generator.generate(0, 4, "5-room")
    with pytest.raises(UnknownName, match=r"optional kind 'pilow'.*Did you mean 'pillow'"):
        generator.generate(0, 4, needs={"pilow"})
    with pytest.raises(HthorError, match="the text 'pillow'"):
        generator.generate(0, 4, needs="pillow")


def test_when_all_attempts_fail_the_rules_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object) -> None:
        raise AttemptFailed("room-area", "too small")

    monkeypatch.setattr(generator, "build_document", failing)
    with pytest.raises(generator.GeneratorError, match=r"in 2 attempts: attempt 0: too small \(room-area\)") as info:
        generator.generate(5, 4, tries=2)
    assert info.value.reasons == (("room-area", "too small"),) * 2


def test_a_failed_attempt_is_followed_by_another_one(monkeypatch: pytest.MonkeyPatch) -> None:
    true, calls = generator.build_document, []

    def once(*arguments: object) -> object:
        calls.append(arguments)
        if len(calls) == 1:
            raise AttemptFailed("start-free", "no floor")
        return true(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(generator, "build_document", once)
    assert generator.generate(5, 4)["metadata"]["generator"]["attempt"] == 1


# ------------------------------------------------------------------------------------------------------------- stages


@given(seeds, counts)
@settings(max_examples=cases(40))
def test_rooms_tile_the_cells_of_the_outline(seed: int, rooms: int) -> None:
    dice = Dice(seed)
    shape, tree = growth.draw_boundary(rooms, dice), room_specs.choose_spec(rooms, dice, None).tree
    if shape is None:
        return
    labels = growth.grow_rooms(shape.cells, tree, dice)
    if labels is None:
        return
    assert ((labels > 0) == shape.cells).all()
    assert set(np.unique(labels[shape.cells]).tolist()) == set(range(2, rooms + 2))
    plan = layout.plan_rooms(shape, labels, tree)
    if plan is not None:
        assert sum(room.area for room in plan.rooms) == pytest.approx(float(shape.cells.sum()) * shape.scale**2)
        for room in plan.rooms:
            assert signed_area(room.polygon) == pytest.approx(room.area)


@given(seeds, counts)
@settings(max_examples=cases(40))
def test_doors_join_all_rooms_as_a_tree_and_bathrooms_are_dead_ends_of_their_level(seed: int, rooms: int) -> None:
    dice = Dice(seed)
    shape, tree = growth.draw_boundary(rooms, dice), room_specs.choose_spec(rooms, dice, None).tree
    labels = None if shape is None else growth.grow_rooms(shape.cells, tree, dice)
    plan = None if shape is None or labels is None else layout.plan_rooms(shape, labels, tree)
    pairs = None if plan is None else doors.choose_doors(tree, plan, dice)
    if plan is None or pairs is None:
        return
    assert len(pairs) == rooms - 1
    reached = {2}
    for _ in pairs:
        reached |= {room for pair in pairs if reached & set(pair) for room in pair}
    assert reached == set(range(2, rooms + 2))
    degree = Counter(room for pair in pairs for room in pair)
    assert all(degree[room.number] == 1 for room in plan.rooms if room.kind == room_specs.BATHROOM)


def test_the_beta_distribution_has_its_mean_and_variance() -> None:
    draws = np.array([Dice(3).beta(2.0, 6.0, k) for k in range(1500)])
    assert draws.mean() == pytest.approx(0.25, abs=0.015)
    assert draws.var() == pytest.approx(0.25 * 0.75 / 9.0, rel=0.15)


def test_a_surface_that_is_full_is_noticed() -> None:
    (surface,) = catalog.kind("stool").rests((0.36, 0.36, 0.48))
    assert all_fit(surface, [])
    assert not all_fit(surface, [(-0.05, -0.05, 0.05, 0.05, 0.1)])


def test_rules_name_what_is_wrong() -> None:
    made_ = small_document()
    sofa = next(row for row in made_["objects"] if row["assetId"].startswith("hthor_sofa"))
    table = next(row for row in made_["objects"] if row["assetId"].startswith("hthor_dining_table"))
    sofa["position"] = {**table["position"], "y": sofa["position"]["y"]}
    house = loader.house_from_document(made_, "crowded")
    space, free = validity.floor(house)
    rules = {rule for rule, _, _ in validity.find_faults(house, space, validity.reached(free))}
    assert "thing-in-thing" in rules


def test_names_count_kinds_that_come_more_than_once() -> None:
    maker = ItemStyler(Dice(1))
    pieces = [maker.make("chair"), maker.make("sofa"), maker.make("chair")]
    assert list(document.names(pieces)) == ["chair_1", "sofa", "chair_2"]
    assert [piece.kind for piece in document.without(pieces, {"chair_1"})] == ["sofa", "chair"]


# ------------------------------------------------------------------------------------------------------- the scenes

PRESENCE = {
    "pillow": 9,
    "television": 9,
    "laptop": 7,
    "armchair": 6,
    "shelf": 6,
    "bowl": 6,
    "plate": 6,
    "dresser": 6,
    "coffee_machine": 6,
    "bread": 5,
    "egg": 4,
}


@pytest.mark.parametrize(
    "scene",
    [shipped.SCENES[0], pytest.param(shipped.SCENES[5], marks=pytest.mark.nightly)],
    ids=lambda scene: scene.name,
)
def test_the_committed_scenes_are_what_their_rows_make(scene: shipped.Recipe) -> None:
    path = Path(houses.__file__).parent / "data" / f"{scene.name}.json"
    assert path.read_bytes() == jsonio.pretty(shipped.make_house(scene))


def test_the_ten_scenes_have_the_optional_references_that_the_priors_count_on() -> None:
    assert houses.names() == tuple(sorted(scene.name for scene in shipped.SCENES))
    specs_ = [houses.load(scene.name) for scene in shipped.SCENES]
    kinds = [{thing.kind for thing in spec.things} for spec in specs_]
    assert {kind: sum(kind in had for had in kinds) for kind in PRESENCE} == PRESENCE
    assert set(PRESENCE) == set(generator.OPTIONAL)
    for spec, had in zip(specs_, kinds, strict=True):
        assert {*catalog.RECEPTACLES, "sink", "chair"} <= had
        assert not had & set(catalog.TARGETS)
        assert 4 <= len(spec.rooms) <= 7
        assert 70 <= sum(signed_area(room.polygon) for room in spec.rooms) <= 180
