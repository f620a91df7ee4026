"""What the engine says of a house: what penetrates, which surfaces hold what, and that a proof is repeatable."""

from __future__ import annotations

import math

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from two_rooms import SIDE, TABLE, house, on, thing

from hthor import catalog
from hthor.errors import HthorError
from hthor.houses.checks.house_checks import check
from hthor.houses.checks.house_rules import error, is_sound
from hthor.world.validation import house_soundness, physics_checks
from hthor.world.validation.house_soundness import check_soundness
from hthor.world.validation.physics_checks import PENETRATION_MAX_M, drop_findings, penetration_findings

FURNITURE = [
    name for name in catalog.names() if not catalog.kind(name).pickable and not catalog.kind(name).wall_mounted
]
RECEPTACLES = [name for name in FURNITURE if catalog.kind(name).rests()]


def pairs(*things):
    return {
        pair: depth
        for pair, depth in physics_checks.penetration_depths(house(*things)).items()
        if depth > PENETRATION_MAX_M
    }


def test_what_stands_apart_or_rests_does_not_penetrate():
    assert pairs(TABLE, on("bowl", "bowl", TABLE), thing("chair", "chair", 2.5, 1.75, 0.0)) == {}


@given(st.floats(0.006, 0.2), st.sampled_from(("bin", "bowl", "side_table", "vase")))
@settings(max_examples=cases(20))
def test_the_depth_is_how_far_one_thing_was_pushed_into_another(depth: float, kind: str):
    """Blocks side by side, pushed together, or a round thing pressed into the table's top."""
    if kind == "side_table":
        other = thing("it", "ottoman", 1.0 + 0.7 - depth, 1.0)
        found = pairs(thing("block", "ottoman", 1.0, 1.0), other)
        assert found == {("block", "it"): pytest.approx(depth, abs=1e-6)}
    else:
        low = catalog.kind(kind).size[2]
        deep = min(depth, 0.01, 0.4 * low)
        other = thing("it", kind, 2.5, 2.5, bottom=0.74 - deep)
        assert pairs(TABLE, other)["it", "table"] == pytest.approx(deep, abs=1e-4)


def test_an_empty_space_under_a_table_is_no_penetration():
    """Exact over parts: a bin under the table is inside its bounding box, yet touches nothing."""
    assert pairs(TABLE, thing("bin", "bin", 2.5, 2.5)) == {}


def test_walls_and_the_floor_count_and_are_named():
    sunk = thing("sunk", "bin", 1.0, 1.0, bottom=-0.02)
    stuck = thing("stuck", "dresser", 2.5, 0.05 + 0.24 - 0.03)
    words = {finding.where: finding.problem for finding in penetration_findings(house(sunk, stuck))}
    assert words == {"sunk": "the bin is 20 mm deep in the floor", "stuck": "the dresser is 30 mm deep in the wall"}


def test_both_things_are_named():
    (finding,) = penetration_findings(house(TABLE, thing("other", "dining_table", 3.0, 2.5)))
    assert finding.rule == "penetration"
    assert "'table' (dining table)" in f"'{finding.where}' {finding.problem}"
    assert "'other'" in finding.problem or finding.where == "other"


# --------------------------------------------------------------------------------------------------------------- drops


@pytest.mark.parametrize("name", RECEPTACLES)
def test_every_surface_of_every_kind_takes_every_target(name: str):
    spec = house(thing("it", name, 2.5, 2.5, math.pi / 2))
    trials = list(physics_checks._trials(spec))
    assert len(trials) == len(catalog.kind(name).rests()) * len(catalog.TARGETS)
    assert [str(finding) for finding in drop_findings(spec)] == []


def test_a_full_surface_takes_nothing_and_says_what_does_not_fit():
    table = thing("it", "side_table", 2.5, 2.5)
    (board,) = catalog.kind("side_table").rests()
    spec = house(table, on("lamp", "lamp", table))
    problems = [finding.problem for finding in drop_findings(spec)]
    assert any("no free place for the lettuce" in problem and board.name in problem for problem in problems)
    assert not any("remote control" in problem for problem in problems)
    assert {finding.rule for finding in drop_findings(spec)} == {"surface-takes"}


def test_what_does_not_stay_is_told(monkeypatch: pytest.MonkeyPatch):
    """A ball let go half over the edge falls to the floor."""
    table = thing("it", "side_table", 2.5, 2.5)

    def edge(place, size, solids, near):
        return [(place.centre[0] + place.half[0] + 0.05, place.centre[1], place.centre[2] + size[2] / 2 + 0.005)]

    monkeypatch.setattr(physics_checks, "free_spots", edge)
    problems = [finding.problem for finding in drop_findings(house(table))]
    assert any("the apple put on the top of the side table strays" in problem for problem in problems)


def test_objects_tried_together_do_not_meet():
    """Six targets at the same spot, none pushes another."""
    spec = house(thing("it", "stool", 2.5, 2.5))
    spots = {trial.at[:2] for trial in physics_checks._trials(spec) if trial.at is not None}
    assert len(spots) == 1
    assert drop_findings(spec) == ()


# --------------------------------------------------------------------------------------------------------------- homes


def test_a_home_that_the_proof_refuses_is_followed_by_the_next_attempt(monkeypatch: pytest.MonkeyPatch):
    tried = []

    def generate(seed, rooms, *, first, tries):
        tried.append((seed, rooms, first, first + tries))
        return {"metadata": {"generator": {"attempt": first + 1}}}

    refusal = error("penetration", "sofa", "is deep in the wall")
    verdicts = iter([(refusal,), ()])
    monkeypatch.setattr(house_soundness.generator, "generate", generate)
    monkeypatch.setattr(house_soundness.loader, "house_from_document", lambda document, name: house())
    monkeypatch.setattr(house_soundness, "check_soundness", lambda spec, radius: next(verdicts))
    home = house_soundness.generate_valid_home(7, 5)
    assert tried == [(7, 5, 0, house_soundness.ATTEMPTS), (7, 5, 2, house_soundness.ATTEMPTS)]
    assert (home.attempt, home.refused) == (3, (refusal,))
    monkeypatch.setattr(house_soundness, "check_soundness", lambda spec, radius: (refusal,))
    with pytest.raises(HthorError, match=r"seed 7 gave no sound home of 5 rooms.*deep in the wall.*another seed"):
        house_soundness.generate_valid_home(7, 5)


def test_a_home_is_sound_and_the_same_every_time():
    home = house_soundness.generate_valid_home(11, 4)
    assert check_soundness(home.house, house_soundness.RADIUS_M) == home.findings
    assert is_sound(home.findings)
    assert len(home.house.rooms) == 4
    assert house_soundness.generate_valid_home(11, 4).document == home.document


# --------------------------------------------------------------------------------------------------------------- proof


def test_a_proof_is_the_strict_check_and_the_engine_s_word():
    spec = house(TABLE, thing("stuck", "dresser", 2.5, 0.05 + 0.24 - 0.03), start=(1.0, 1.5))
    findings = check_soundness(spec)
    assert set(check(spec, 0.25, strict=True)) < set(findings)
    assert {finding.rule for finding in findings} == {"penetration", "receptacles-present"}
    assert check_soundness(spec) == findings


def test_the_leaf_in_a_doorway_needs_room_to_swing():
    """It hangs at the doorway's lower end and turns into room a: a bin there is in its way, one in room b is not."""
    spec = house(TABLE)
    hung = msgspec.structs.replace(spec, openings=(msgspec.structs.replace(spec.openings[0], openable=True),))
    for x, hit in ((SIDE - 0.7, True), (SIDE + 0.7, False)):
        things = (TABLE, thing("bin", "bin", x, SIDE / 2 - 0.2))
        found = [
            f for f in check_soundness(msgspec.structs.replace(hung, things=things), 0.2) if f.rule == "swing-free"
        ]
        assert [f.where for f in found] == ["door"] * hit
        assert all("in 'bin'" in f.problem for f in found)


def test_a_furnished_room_is_proved_sound_but_for_what_it_lacks():
    bed = thing("bed", "bed", 0.9, SIDE - 0.05 - 1.06, math.pi)
    fridge = thing("fridge", "fridge", SIDE + 2.5, SIDE - 0.05 - 0.37, math.pi)
    spec = house(TABLE, bed, fridge, on("egg", "egg", fridge, v=0.8, surface=2), on("pillow", "pillow", bed, v=-0.6))
    assert {finding.rule for finding in check_soundness(spec)} == {"receptacles-present"}
