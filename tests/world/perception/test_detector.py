"""Noisy detectors: the rates are those declared, chance is keyed by event, and what is reported could be there."""

from __future__ import annotations

import math

import eval_fakes as fakes
import pytest
import world_house as tiny
from hypothesis import given
from hypothesis import strategies as st
from world_house import COFFEE, TABLE, on, task, wait

from hthor.errors import HthorError
from hthor.eval.config import run_config
from hthor.eval.records import trial_record
from hthor.eval.results import aggregate
from hthor.trials import sessions
from hthor.types import Detection, DetectorSpec, Pick, Pose, detector_specs
from hthor.world import World
from hthor.world.perception.detector_noise import GLIMPSE_TICKS

HUMAN = Pose(x=8.6, y=1.2)
AT_TABLE = Pose(x=2.5, y=3.4, yaw=-math.pi / 2, pitch=-0.3)
FIRST, GLIMPSES = "scout", 400


def start(world: World, seed: int = 0) -> None:
    world.reset(task(on(TABLE, "apple"), on(COFFEE, "lettuce"), human=HUMAN, robots=(AT_TABLE,)), seed=seed)
    world.parts.seats["robot"].pose = AT_TABLE


@pytest.fixture(scope="module")
def worlds() -> dict[str, World]:
    kinds = {"ideal": "ideal", "misses": "miss=0.3", "lies": "false_alarm=0.25", "blurs": "position_sigma=0.05"}
    return {name: World(tiny.house(), robots=(FIRST,), detectors=(text,)) for name, text in kinds.items()}


def glimpses(world: World, seed: int = 0, ticks: int = GLIMPSE_TICKS) -> list[tuple[Detection, ...]]:
    """What the robot's detector reports at the table, in each glimpse."""
    start(world, seed)
    out = []
    for number in range(GLIMPSES):
        world.simulation.tick = number * ticks
        out.append(world.detections("robot"))
    return out


def named(report: tuple[Detection, ...], id: str) -> Detection | None:
    return next((detection for detection in report if detection.id == id), None)


def within(count: int, chance: float) -> bool:
    """Whether a count of ``GLIMPSES`` is likely, at four standard deviations."""
    return abs(count - GLIMPSES * chance) < 4.0 * math.sqrt(GLIMPSES * chance * (1.0 - chance))


def test_objects_are_missed_as_often_as_declared_and_nothing_else_is(worlds: dict[str, World]) -> None:
    start(worlds["ideal"])
    truth = {detection.id: detection for detection in worlds["ideal"].detections("robot")}
    assert "apple" in truth
    missed = 0
    for report in glimpses(worlds["misses"]):
        missed += named(report, "apple") is None
        assert {one.id for one in report} >= {one.id for one in truth.values() if one.family != "object"}
        assert all(detection == truth[detection.id] for detection in report)
    assert within(missed, 0.3)


def test_false_alarms_are_as_many_as_declared_and_each_could_be_true(worlds: dict[str, World]) -> None:
    world, alarms = worlds["lies"], 0
    for report in glimpses(world):
        ghosts = [detection for detection in report if detection.id == "lettuce"]
        alarms += len(ghosts)
        assert named(report, "apple") is not None
        for ghost in ghosts:
            assert (ghost.kind, ghost.family, ghost.held_by) == ("lettuce", "object", "")
            assert ghost.support in {detection.id for detection in report}
            assert ghost.distance <= world.bodies["robot"].sight_range
            eye = (AT_TABLE.x, AT_TABLE.y, world.bodies["robot"].eye)
            assert math.dist(eye, ghost.position) == pytest.approx(ghost.distance)
            assert not world.parts.geoms.hidden(eye, ghost.position)
            place = world.parts.detectors["robot"]._places.of(ghost.support)[-1]
            assert place.holds(ghost.position, ghost.size[2])
    assert within(alarms, 0.25)


def test_positions_are_off_by_what_is_declared(worlds: dict[str, World]) -> None:
    true = (2.5, 2.6, 0.78)
    off = [
        value - true[axis]
        for report in glimpses(worlds["blurs"])
        for axis, value in enumerate(named(report, "apple").position)
    ]
    spread = math.sqrt(sum(error**2 for error in off) / len(off))
    assert spread == pytest.approx(0.05, rel=0.1)
    assert abs(sum(off) / len(off)) < 4.0 * 0.05 / math.sqrt(len(off))


def test_chance_depends_on_the_event_and_not_on_who_looked_before(worlds: dict[str, World]) -> None:
    world = worlds["misses"]
    whole = glimpses(world)
    start(world)
    for number in (377, 5, 5, 12):
        world.simulation.tick = number * GLIMPSE_TICKS
        assert world.detections("robot") == whole[number]
    assert glimpses(world) == whole
    assert glimpses(world, seed=1) != whole
    assert len(set(glimpses(world, ticks=1)[3 * GLIMPSE_TICKS : 4 * GLIMPSE_TICKS])) == 1  # a glimpse is of one piece


def test_what_it_holds_is_never_missed() -> None:
    world = World(tiny.house(), robots=("tender",), detectors=(DetectorSpec(name="blind", miss=1.0),))
    world.reset(task(on(TABLE, "apple", v=0.25), human=HUMAN, robots=(AT_TABLE,)))
    world.parts.seats["robot"].pose = Pose(x=2.5, y=3.4, yaw=-math.pi / 2)
    assert named(world.detections("robot"), "apple") is None
    world.start("robot", Pick(object="apple"))
    wait(world, 30)
    assert world.holding("robot") == "apple"
    held = named(world.detections("robot"), "apple")
    assert held is None or held.held_by == "robot"  # it may be out of the picture, below the camera


def test_the_person_s_eyes_never_err(worlds: dict[str, World]) -> None:
    for world in worlds.values():
        start(world)
        assert "human" not in world.detectors
        assert world.detections("human") == world.parts.visibility.detections(world.parts.seats["human"])


def test_a_body_declares_its_own_and_a_trial_overrules_it() -> None:
    assert World(tiny.house(), robots=("scout", "scout"), detectors=("noisy",)).detectors == {
        "robot": detector_specs.NOISY,
        "robot2": detector_specs.IDEAL,
    }
    with pytest.raises(HthorError, match="2 detectors for 1 robots"):
        World(tiny.house(), robots=("scout",), detectors=("ideal", "ideal"))


@given(miss=st.floats(0, 1), false_alarm=st.floats(0, 1), sigma=st.floats(0, 1))
def test_rates_are_read_back_from_their_one_spelling(miss: float, false_alarm: float, sigma: float) -> None:
    spec = detector_specs.parse(f"position_sigma={sigma!r}, miss={miss!r},false_alarm={false_alarm!r}")
    again = detector_specs.parse(spec.name)
    assert again == detector_specs.parse(again.name)
    assert (again.miss, again.false_alarm, again.position_sigma) == pytest.approx((miss, false_alarm, sigma), abs=1e-9)


def test_names_of_detectors() -> None:
    assert detector_specs.parse("ideal") == DetectorSpec(name="ideal")
    assert detector_specs.parse("miss=0") == detector_specs.IDEAL
    assert detector_specs.parse("false_alarm=0.05,miss=.2").name == "miss=0.2,false_alarm=0.05"
    assert detector_specs.canonical_name("own") == "own"
    for text in ("perfect", "miss", "miss=0.1,miss=0.2", "hit=0.5"):
        with pytest.raises(HthorError, match=r"unknown detector.*Valid: own, ideal, noisy"):
            detector_specs.parse(text)
    for text in ("miss=1.5", "miss=-0.1", "false_alarm=nan", "position_sigma=much"):
        with pytest.raises(HthorError, match="must be from 0 to 1"):
            detector_specs.canonical_name(text)


def test_a_run_says_which_detector_it_used() -> None:
    suite = fakes.suite(10)
    text = detector_specs.canonical_name("false_alarm=0.05,miss=0.2")
    crews = [fakes.crew("helper", detector=detector) for detector in ("own", text)]
    plain, noisy = (run_config.build_config(suite, crew, humans="proxy", seed=0, participants=None) for crew in crews)
    assert [plan.robots[0].detector for plan in (plain, noisy)] == ["own", "miss=0.2,false_alarm=0.05"]
    assert plain.folder_name != noisy.folder_name
    dealt = sessions.make_sessions(suite, agent=crews[1])
    assert {seat.detector for trial in dealt[0].trials for seat in trial.robots} == {text}
    keys = {trial_record.key(trial) for trial in sessions.make_sessions(suite, agent=crews[0])[0].trials}
    assert keys.isdisjoint(trial_record.key(trial) for trial in dealt[0].trials)
    assert aggregate.make_result(noisy, [], []).robots[0].detector == text
    alone = fakes.crew("silent", absent=True)
    assert run_config.build_config(suite, alone, humans="proxy", seed=0, participants=None).robots[0].detector == ""
