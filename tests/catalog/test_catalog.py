from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog, looks
from hthor.catalog import colors, priors, procthor, props
from hthor.catalog.kind import Form, Kind
from hthor.catalog.kinds import _small
from hthor.errors import HouseError, UnknownName
from hthor.geometry.plane import turn
from hthor.types import Vec3

KINDS = [catalog.kind(name) for name in catalog.names()]
scale = st.floats(0.4, 3.0)
kinds = st.sampled_from(KINDS)


def extent(form: Form, axis: int) -> tuple[float, float]:
    low = min(part.centre[axis] - part.half[axis] for part in form.parts)
    return low, max(part.centre[axis] + part.half[axis] for part in form.parts)


def check_form(kind: Kind, size: Vec3) -> None:
    form = kind.form(size)
    for axis in range(3):
        assert extent(form, axis) == pytest.approx((-size[axis] / 2, size[axis] / 2), abs=1e-9)
    for part in form.parts:
        assert min(part.half) > 0
        assert len(set(part.rgba)) > 0
        assert all(0 <= channel <= 1 for channel in part.rgba)
        if part.shape != "box":
            along = "xyz".index(part.axis)
            assert part.half[along - 1] == pytest.approx(part.half[along - 2], abs=1e-6)
        if part.shape == "sphere":
            assert part.half[0] == pytest.approx(part.half[2], abs=1e-6)
    for surface in form.surfaces:
        assert min(surface.half) > 0
        assert surface.clearance > 0
        for axis in (0, 1):
            assert abs(surface.centre[axis]) + surface.half[axis] <= size[axis] / 2 + 1e-9
        assert -size[2] / 2 <= surface.centre[2] <= size[2] / 2 + 1e-9


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_kind_is_sound(kind: Kind) -> None:
    check_form(kind, kind.size)
    assert kind.mass > 0
    assert kind.title
    assert kind.indefinite.endswith(kind.title)
    assert 1 <= len(kind.parts()) <= (3 if kind.pickable else 16 if kind.openable else 10)
    assert kind.openable == bool(kind.joints()) == any(part.moves for part in kind.parts())
    assert kind.receptacle == bool(kind.surfaces())
    heights = [surface.centre[2] for surface in kind.surfaces()]
    assert heights == sorted(heights)


@given(kinds, st.tuples(scale, scale, scale))
def test_a_kind_keeps_its_form_at_other_sizes(kind: Kind, factors: Vec3) -> None:
    width, depth, height = (extent * factor for extent, factor in zip(kind.size, factors, strict=True))
    check_form(kind, (width, depth, height))


@given(kinds, st.tuples(scale, scale, scale))
def test_nothing_solid_stands_in_the_free_height_over_a_surface(kind: Kind, factors: Vec3) -> None:
    width, depth, height = (extent * factor for extent, factor in zip(kind.size, factors, strict=True))
    form = kind.form((width, depth, height))
    for surface in form.surfaces:
        low = (*(c - h for c, h in zip(surface.centre, surface.half, strict=False)), surface.centre[2])
        high = (*(c + h for c, h in zip(surface.centre, surface.half, strict=False)), low[2] + surface.clearance)
        for part in form.parts:
            shared = [
                min(high[axis], part.centre[axis] + part.half[axis])
                - max(low[axis], part.centre[axis] - part.half[axis])
                for axis in range(3)
            ]
            assert min(shared) < 1e-6, (kind.name, surface.name, part)


def test_the_benchmark_s_kinds() -> None:
    assert catalog.RECEPTACLES == (
        "fridge",
        "counter_top",
        "dining_table",
        "coffee_table",
        "sofa",
        "bed",
        "desk",
        "tv_stand",
    )
    assert catalog.TARGETS == ("apple", "tomato", "lettuce", "book", "remote_control", "mug")
    masses = {name: catalog.kind(name).mass for name in catalog.TARGETS}
    assert masses == {
        "apple": 0.2,
        "tomato": 0.12,
        "lettuce": 0.47,
        "book": 0.5,
        "remote_control": 0.15,
        "mug": 0.35,
    }
    assert all(catalog.kind(name).pickable for name in catalog.TARGETS)


@pytest.mark.parametrize("name", catalog.RECEPTACLES)
def test_every_surface_of_a_receptacle_holds_a_lettuce(name: str) -> None:
    lettuce = max(catalog.kind("lettuce").size)
    for surface in catalog.kind(name).surfaces():
        assert 2 * min(surface.half) >= lettuce
        assert surface.clearance >= lettuce


def test_a_closed_fridge_hides_its_shelves_and_an_open_one_bares_them() -> None:
    fridge = catalog.kind("fridge")
    (hinge,) = fridge.joints()
    door = max((part for part in fridge.parts() if part.moves), key=lambda part: part.half[0])
    assert door.half[0] == fridge.size[0] / 2
    assert door.half[2] == fridge.size[2] / 2
    assert fridge.surfaces()
    assert all(surface.inside for surface in fridge.surfaces())
    corners = [(door.centre[0] + i * door.half[0], door.centre[1] + j * door.half[1]) for i in (-1, 1) for j in (-1, 1)]
    front = door.centre[1] - door.half[1]
    for step in range(1, 21):
        swung = [
            turn((x - hinge.anchor[0], y - hinge.anchor[1]), hinge.travel * step / 20) for x, y in corners
        ]  # relative to the axis
        assert min(y + hinge.anchor[1] for _, y in swung) >= front - 0.02, "the door must swing out, not in"
    assert max(x + hinge.anchor[0] for x, _ in swung) <= -fridge.size[0] / 2 + 2 * door.half[1] + 0.02
    assert math.degrees(hinge.travel) == pytest.approx(100)


def test_names_for_people() -> None:
    assert catalog.kind("apple").indefinite == "an apple"
    assert catalog.kind("dining_table").indefinite == "a dining table"
    assert catalog.kind("tv_stand").definite == "the TV stand"


def test_an_unknown_kind_names_the_nearest() -> None:
    with pytest.raises(UnknownName, match="Did you mean 'fridge'"):
        catalog.kind("fridg")


def test_own_assets() -> None:
    fridge = catalog.kind("fridge")
    assert catalog.own_asset("hthor_fridge") == (fridge, fridge.size, 0)
    assert catalog.own_asset("hthor_counter_top_240x62x90") == (catalog.kind("counter_top"), (2.4, 0.62, 0.9), 0)
    assert catalog.own_asset("hthor_counter_top_240x62x90_v3") == (catalog.kind("counter_top"), (2.4, 0.62, 0.9), 3)
    assert catalog.own_asset("Fridge_1") is None
    assert catalog.own_asset("hthor_spaceship") is None


def test_the_priors_are_65_triplets_over_known_kinds() -> None:
    rows = priors.triplets()
    assert Counter(row.relation for row in rows) == {"on": 33, "near": 25, "in": 7}
    assert Counter(row.target for row in rows) == {
        "apple": 10,
        "tomato": 9,
        "lettuce": 8,
        "book": 9,
        "remote_control": 15,
        "mug": 14,
    }
    assert len({(row.target, row.relation, row.reference) for row in rows}) == 65
    for row in rows:
        assert catalog.kind(row.reference).relation == row.relation or row.relation == "near"
        assert row.relation == "near" or catalog.kind(row.reference).receptacle


@pytest.mark.parametrize("target", catalog.TARGETS)
def test_weights_follow_from_frequency_and_similarity(target: str) -> None:
    rows = [row for row in priors.triplets() if row.target == target]
    seen = [max(row.frequency, 0.01) for row in rows]
    alike = [math.exp(row.similarity / 0.15) for row in rows]
    weights = priors.weights(target)
    assert sum(weights.values()) == pytest.approx(1)
    for row, often, like in zip(rows, seen, alike, strict=True):
        wanted = 0.75 * often / sum(seen) + 0.25 * like / sum(alike)
        assert weights[row.relation, row.reference] == pytest.approx(wanted, abs=2e-3)


def test_weights_of_an_unknown_target() -> None:
    with pytest.raises(UnknownName, match="apple"):
        priors.weights("sofa")


def test_every_procthor_type_has_a_kind() -> None:
    assert set(procthor.KIND_OF.values()) <= set(catalog.names())
    assert procthor.kind_of("NeverSeen", pickable=True) == "object"
    assert procthor.kind_of("NeverSeen", pickable=False) == "furniture"


def test_an_asset_database(tmp_path: Path) -> None:
    row = {"assetId": "Bed_1", "objectType": "Bed", "boundingBox": {"x": 1.5, "y": 0.9, "z": 2.0}}
    path = tmp_path / "db.json"
    path.write_text(json.dumps({"Bed": [row, {"assetId": "Ghost", "objectType": "Bed", "boundingBox": None}]}))
    assert procthor.read(path) == {"Bed_1": procthor.Asset(kind="bed", size=(1.5, 2.0, 0.9))}
    row["boundingBox"] = {"x": -1.5, "y": 0.9, "z": 2.0}
    path.write_text(json.dumps({"Bed": [row]}))
    with pytest.raises(HouseError, match=r"db\.json.*Bed_1\.boundingBox.*positive"):
        procthor.read(path)
    path.write_text("[1, 2")
    with pytest.raises(HouseError, match="expected a ProcTHOR asset database"):
        procthor.read(path)
    with pytest.raises(HouseError, match="cannot be read"):
        procthor.read(tmp_path / "absent.json")


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind.finishes], ids=lambda kind: kind.name)
def test_finishes_change_looks_only(kind: Kind) -> None:
    assert kind.family != "target"
    seen = set()
    for variant in range(1 + len(kind.finishes)):
        form = kind.form(variant=variant)
        seen.add(tuple(part.rgba for part in form.parts))
        assert [(part.centre, part.half, part.moves) for part in form.parts] == [
            (part.centre, part.half, part.moves) for part in kind.parts()
        ]
    assert len(seen) == 1 + len(kind.finishes)


def test_a_drawer_s_floor_moves_with_it_and_stays_inside_when_pulled() -> None:
    for name in ("dresser", "side_table", "desk"):
        kind = catalog.kind(name)
        (joint,) = kind.joints()
        (floor,) = (surface for surface in kind.surfaces() if surface.moves)
        assert (joint.kind, joint.name, floor.moves, floor.inside) == ("slide", "drawer", "drawer", True)
        assert 0.25 < joint.travel < kind.size[1]
        assert kind.rests() == tuple(surface for surface in kind.surfaces() if not surface.inside)
        assert not kind.hides
    assert [kind.name for kind in KINDS if kind.hides] == ["fridge"]


def test_a_new_kind_is_one_row(monkeypatch: pytest.MonkeyPatch) -> None:
    row = _small("gadget", (0.1, 0.2, 0.05), 0.3, props.block, rgba=colors.RED)
    monkeypatch.setitem(catalog._KINDS, "gadget", row)
    assert catalog.kind("gadget").indefinite == "a gadget"
    assert catalog.own_asset("hthor_gadget") == (row, row.size, 0)
    (piece,) = looks.look.__wrapped__("gadget")  # not cached: the row is gone after this test
    assert piece.mesh.vertices.max(0) == pytest.approx((0.05, 0.1, 0.025))
