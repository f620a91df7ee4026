"""The proof that tasks can be done: sound ones pass, and each way of being wrong is found and named."""

from __future__ import annotations

import math

import msgspec
import pytest

from hthor import houses, plugins, rules, tasks
from hthor.catalog import priors
from hthor.eval.task_check import omniscient_solver, solvability
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.generation import generate
from hthor.types import Goal, Job, Pose
from hthor.world import World

HOUSE = houses.load("juniper")
MOVE = plugins.load("task kind", "mobile_manipulation")
SMOKE = tasks.load_suite("smoke")


def changed(task, **fields):
    return msgspec.structs.replace(task, **fields)


def with_object(task, id, **fields):
    objects = tuple(changed(one, **fields) if one.id == id else one for one in task.objects)
    return changed(task, objects=objects)


@pytest.fixture(scope="module")
def task():
    goal = Goal(target="mug", relation="on", destination="dining_table")
    row = scene_graph.find_triplet("mug", "near", "apple")
    assert row in priors.triplets()
    return generate.make_task(HOUSE, MOVE, goal, 3, name="test/juniper/mug", fixed=row)


def faults(task):
    return [(fault.field, fault.reason) for fault in solvability.check_task(task).faults]


def test_a_sound_task_passes_and_tells_what_it_takes(task):
    verdict = solvability.check_task(task)
    assert verdict.faults == ()
    assert 0.0 < verdict.drift < 0.005
    assert 0.0 < verdict.least <= verdict.seconds <= task.time_limit
    walking = verdict.metres / omniscient_solver.PACE_M_S
    assert walking <= verdict.seconds <= walking + 15.0


def test_an_object_that_would_fall_is_found(task):
    """Thirty centimetres above the table, and nothing else moves."""
    mug = next(one for one in task.objects if one.id == "mug")
    x, y, z = mug.position
    world = World("juniper")
    world.reset(with_object(task, "mug", position=(x, y, z + 0.3)))
    drift, _ = solvability.woken(world, with_object(task, "mug", position=(x, y, z + 0.3)))
    assert drift["mug"] > solvability.DRIFT_M
    assert all(way <= solvability.DRIFT_M for id, way in drift.items() if id != "mug")


def test_what_the_record_says_of_places_is_measured(task):
    other = next(one for one in task.objects if one.id == "book")
    assert faults(with_object(task, "mug", near=other.support))[0][0] == "objects[5].near"
    wrong = "sofa" if other.support != "sofa" else "bed"
    assert any(field == "objects[3].position" for field, _ in faults(with_object(task, "book", support=wrong)))


def test_a_goal_that_is_met_at_the_start_or_cannot_be_is_found(task):
    start = next(one.position for one in task.objects if one.id == "mug")
    find = changed(
        task,
        kind="object_goal_navigation",
        goal=Goal(target="mug", relation="find"),
        instruction="Find a mug.",
        human_start=facing(start),
    )
    assert ("human_start", "the goal is met before anybody has moved") in faults(find)
    late = changed(task, time_limit=2.0)
    assert [field for field, reason in faults(late) if "time is up" in reason] == ["goal"]
    assert [field for field, _ in faults(changed(task, t_star=300.0))] == ["t_star"]


def facing(point):
    """Where the person stands and sees the point from close by."""
    space = World("juniper").space["human"]
    for k in range(72):
        angle, reach = 2 * math.pi * k / 24, (0.6, 0.8, 1.0)[k // 24]
        x, y = point[0] + reach * math.cos(angle), point[1] + reach * math.sin(angle)
        if space.is_free(x, y):
            return Pose(x=x, y=y, yaw=angle - math.pi, pitch=-0.6)
    raise AssertionError("no free floor beside it")


def test_houses_and_records_that_are_wrong_are_told_first(task):
    assert faults(changed(task, house="junipr"))[0][0] == "house"
    assert faults(changed(task, human_start=Pose(x=-50.0, y=0.0)))[0][0] == "human_start"


def test_workers_check_what_one_process_checks(task):
    some = [task, changed(task, id="late", time_limit=2.0)]
    found = {verdict.task: verdict for verdict in solvability.check_tasks(some, jobs=2)}
    assert set(found) == {task.id, "late"}
    assert found[task.id] == solvability.check_task(task)
    assert found["late"].faults


# --------------------------------------------------------------------------------------------------------- the person


@pytest.mark.parametrize("number", [0, 3, *(pytest.param(n, marks=pytest.mark.nightly) for n in (6, 9))])
def test_nobody_is_quicker_than_the_least_time_nor_than_their_pace(number):
    task = SMOKE.tasks[number]
    feat = omniscient_solver.solve(World(task.house), task)
    assert feat.met
    assert feat.reason == ""
    assert plugins.load("task kind", task.kind).least(task) <= feat.seconds <= rules.TIME_LIMIT_S
    assert feat.metres <= feat.seconds * omniscient_solver.PACE_M_S + 1e-6
    assert math.dist(feat.way[0], (task.human_start.x, task.human_start.y)) < 1e-9


def test_several_jobs_are_done_one_after_the_other_and_what_takes_two_is_left(task):
    world = World("juniper")
    jobs = (Job(target="mug", relation="on", destinations=("dining_table",)), Job(target="book", relation="find"))
    both = changed(task, goal=changed(task.goal, jobs=jobs))
    feat = omniscient_solver.solve(world, both)
    assert feat.met
    heavy = changed(task, goal=changed(task.goal, jobs=(changed(jobs[0], hands=2),)))
    assert "2 bodies" in omniscient_solver.solve(world, heavy).reason
    assert solvability.check_task(heavy).seconds == 0.0
