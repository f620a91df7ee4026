"""Task kinds, suites and their making: what a task promises is checked again, by other means than made it."""

from __future__ import annotations

import json
import math
from collections import Counter

import msgspec
import numpy as np
import pytest

from hthor import catalog, houses, jsonio, plugins, rules, tasks
from hthor.catalog import priors
from hthor.errors import HthorError, TaskError, UnknownName
from hthor.geometry.plane import to_house, to_local
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import house_geodesics
from hthor.tasks.arrangement.placement import SupportSurfaces, distance_to_thing
from hthor.tasks.arrangement.reachability import EYE_M, HEIGHT_M, RADIUS_M, REACH_M, ReachableFloor, lines_of_sight
from hthor.tasks.arrangement.target_arrangement import NEAR_M, arrange
from hthor.tasks.generation import generate, suite_specs
from hthor.tasks.kinds.mobile_manipulation import TEMPLATES
from hthor.tasks.suite import encode_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import task_faults
from hthor.types import WALKERS, Goal, HouseSpec, Placement, Pose, Room, Snapshot, Thing, ThingState, Wall

FIND, MOVE = (plugins.load("task kind", name) for name in ("object_goal_navigation", "mobile_manipulation"))
SMOKE = tasks.load_suite("smoke")
HOUSES = {name: houses.load(name) for name in {task.house for task in SMOKE.tasks}}


@pytest.fixture(params=SMOKE.tasks, ids=lambda task: task.id)
def task(request):
    return request.param


def furniture(name, kind, x, y, yaw=0.0):
    size = catalog.kind(kind).size
    return Thing(id=name, kind=kind, asset="", centre=(x, y, size[2] / 2), size=size, yaw=yaw)


def hall(*things, length=10.0, depth=4.0):
    """One empty room with things in it."""
    corners = ((0.0, 0.0), (length, 0.0), (length, depth), (0.0, depth))
    pairs = zip(corners, (*corners[1:], corners[0]), strict=True)
    walls = tuple(Wall(id=f"w{k}", room="a", a=a, b=b, height=2.5) for k, (a, b) in enumerate(pairs))
    room = Room(id="a", kind="kitchen", name="kitchen", polygon=corners)
    return HouseSpec(
        id="hall",
        sha256="",
        rooms=(room,),
        walls=walls,
        openings=(),
        things=things,
        height=2.5,
        start=Pose(x=1.0, y=2.0),
    )


def apple_on(thing, u=0.0, v=0.0):
    rest = min(SupportSurfaces(hall(thing)).all, key=lambda rest: abs(rest.centre[2] - 0.9))
    x, y, z = rest.point(u, v)
    relation = "in" if rest.surface.inside else "on"
    position = (x, y, z + catalog.kind("apple").size[2] / 2)
    return Placement(id="apple", kind="apple", position=position, support=thing.id, relation=relation)


# ------------------------------------------------------------------------------------------- every task of the suite


def test_the_suite_has_its_sixty_tasks():
    counts = Counter((task.house, task.kind) for task in SMOKE.tasks)
    assert {house for house, _ in counts} == set(houses.names())
    assert {kind: {count for (_, other), count in counts.items() if other == kind} for _, kind in counts} == {
        FIND.name: {2},
        MOVE.name: {4},
    }
    assert len({task.id for task in SMOKE.tasks}) == len(SMOKE.tasks) == 60
    assert len({jsonio.canonical((task.house, task.objects, task.goal)) for task in SMOKE.tasks}) == 60


def test_tasks_that_follow_one_another_are_a_mixture():
    """Ten are in ten houses; with three of each house come the two kinds, as often as in the whole suite."""
    for first in range(len(SMOKE.tasks) - 9):
        ten = SMOKE.tasks[first : first + 10]
        assert len({task.house for task in ten}) == 10
        assert len({task.goal.target for task in ten}) >= 3
    for first in range(len(SMOKE.tasks) - 29):
        assert Counter(task.kind for task in SMOKE.tasks[first : first + 30])[FIND.name] == 10
    assert min(Counter(task.goal.target for task in SMOKE.tasks).values()) >= 5


def least(task):
    return plugins.load("task kind", task.kind).least(task)


@pytest.mark.parametrize("name", houses.names())
def test_difficulty_spreads(name):
    """Each house has easy and hard tasks, and none far from the next."""
    times = sorted(least(task) for task in SMOKE.tasks if task.house == name)
    assert times[0] < 7.5
    assert times[-1] > 17.5
    assert np.diff(times).max() < 5.5


def test_every_target_is_placed_exactly_on_the_surface_that_it_names(task):
    things = {thing.id: thing for thing in HOUSES[task.house].things}
    assert [placement.id for placement in task.objects] == list(catalog.TARGETS)
    for placement in task.objects:
        thing, size = things[placement.support], catalog.kind(placement.kind).size
        x, y, z = to_local(placement.position, thing.centre, thing.yaw)
        under = [
            surface
            for surface in catalog.kind(thing.kind).surfaces(thing.size)
            if abs(z - size[2] / 2 - surface.centre[2]) < 1e-6
            and all(abs(a - c) < h for a, c, h in zip((x, y), surface.centre[:2], surface.half, strict=True))
            and size[2] < surface.clearance
        ]
        assert under, f"{placement.id} floats"
        assert placement.relation == catalog.kind(thing.kind).relation


def test_no_two_objects_and_no_clutter_share_a_place(task):
    def corners(placement):
        w, d, h = (extent / 2 for extent in catalog.kind(placement.kind).size)
        grid = [(i * w, j * d, k * h * 0.99) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
        return [to_house(point, placement.position, placement.yaw) for point in grid]

    solids = [
        (part, thing.centre, thing.yaw)
        for thing in HOUSES[task.house].things
        for part in catalog.kind(thing.kind).parts(thing.size)
    ]
    for placement in task.objects:
        near = [row for row in solids if math.dist(row[1], placement.position) < 2.5]
        for point in corners(placement):
            for part, centre, yaw in near:
                local = to_local(point, centre, yaw)
                assert any(abs(a - c) >= h - 1e-6 for a, c, h in zip(local, part.centre, part.half, strict=True))
        for other in task.objects:
            if other.id != placement.id:
                half = [extent / 2 for extent in catalog.kind(other.kind).size]
                for point in corners(placement):
                    local = to_local(point, other.position, other.yaw)
                    assert any(abs(a) >= h for a, h in zip(local, half, strict=True))


def test_starts_are_free_and_away_from_the_target_and_from_each_other(task):
    space, human = FreeSpace.of(HOUSES[task.house], 0.30, HEIGHT_M), task.human_start
    starts = (human, *task.robot_starts)
    assert len(starts) == 3
    x, y, _ = next(placement.position for placement in task.objects if placement.id == task.goal.target)
    for number, start in enumerate(starts):
        assert space.is_free(start.x, start.y)
        assert math.hypot(start.x - x, start.y - y) > 1.5
        assert all(math.hypot(start.x - other.x, start.y - other.y) > 1.0 for other in starts[:number])
    assert math.isfinite(
        house_geodesics(HOUSES[task.house], RADIUS_M, HEIGHT_M).distance(*((s.x, s.y) for s in starts[:2]))
    )


def test_t_star_is_that_of_the_kind_and_the_least_time_a_plausible_bound(task):
    spec, kind = HOUSES[task.house], plugins.load("task kind", task.kind)
    assert kind.t_star(task, spec) == task.t_star
    assert kind.t_star_of(kind.least(task)) == task.t_star
    assert task.t_star == pytest.approx(rules.T_STAR_BASE_S + rules.T_STAR_SLOWNESS * least(task), abs=1e-3)
    target = next(placement for placement in task.objects if placement.id == task.goal.target)
    start = (task.human_start.x, task.human_start.y)
    straight = math.dist(start, target.position[:2])
    assert least(task) >= straight - rules.FIND_RANGE_M - 0.1
    if task.kind == FIND.name:
        # Somebody who walks to the nearest place beside the target and looks takes longer.
        ground = ReachableFloor.of(spec)
        lit = ground.space.centres(ground.seeing(target, frozenset({target.support})))
        longest = house_geodesics(spec, RADIUS_M, HEIGHT_M).distances(start, lit).min() + rules.HANDLING_S
        assert least(task) <= longest / rules.PACE_M_S
        assert kind.instruction(task.goal, task.objects) == task.instruction


def test_no_task_is_solved_before_it_begins(task):
    spec, kind = HOUSES[task.house], plugins.load("task kind", task.kind)
    assert not kind.solved(task.goal, task.objects, spec)
    target = next(placement for placement in task.objects if placement.id == task.goal.target)
    eye = (task.human_start.x, task.human_start.y, EYE_M)
    close = math.dist(eye, target.position) <= rules.FIND_RANGE_M
    assert not (close and lines_of_sight(spec, frozenset()).seen([eye], [target.position])[0])
    assert list(task_faults(task, spec)) == []


# --------------------------------------------------------------------------------------------------------- the kinds


@pytest.mark.parametrize("name", plugins.names("task kind"))
def test_every_kind_keeps_the_contract(name):
    kind, spec = plugins.load("task kind", name), next(iter(HOUSES.values()))
    goals = kind.goals(spec)
    assert kind.name == name
    assert len(set(map(jsonio.canonical, goals))) == len(goals) > 0
    assert all(kind.objection(goal, spec) == "" for goal in goals)
    goal, objects = kind.draw(spec, 3)
    assert kind.objection(goal, spec) == ""
    assert kind.instruction(goal, objects).endswith(".")
    assert not kind.solved(goal, objects, spec)
    assert {job.target for job in goal.todo} <= {placed.id for placed in objects} | set(WALKERS)


def test_there_are_nineteen_templates_and_they_read_well():
    assert sum(map(len, TEMPLATES.values())) == 19
    table = furniture("t", "dining_table", 5.0, 2.0)
    goal = Goal(target="apple", relation="in", destination="fridge")
    assert MOVE.instruction(goal, (apple_on(table),)) == "Pick an apple and place it in a fridge."
    assert FIND.instruction(Goal(target="apple", relation="find"), (apple_on(table),)) == "Find an apple."


def snapshot(support="", held_by="", in_view=()):
    apple = ThingState(id="apple", kind="apple", position=(0.0, 0.0, 0.0), support=support, held_by=held_by)
    return Snapshot(tick=1, poses={}, things={"apple": apple}, in_view={"human": in_view}, holding={})


def test_a_search_is_met_when_the_person_has_the_target_in_view():
    task = msgspec.structs.replace(SMOKE.tasks[0], goal=Goal(target="apple", relation="find"))
    assert FIND.met(task, snapshot(in_view=("mug", "apple")), HOUSES[task.house])
    assert not FIND.met(task, snapshot(in_view=("mug",)), HOUSES[task.house])


def test_manipulation_is_met_when_the_target_rests_at_its_destination_and_nobody_holds_it():
    spec = hall(furniture("cold", "fridge", 3.0, 2.0), furniture("board", "dining_table", 6.0, 2.0))
    goal = Goal(target="apple", relation="in", destination="fridge")
    task = msgspec.structs.replace(SMOKE.tasks[0], goal=goal)
    assert MOVE.met(task, snapshot("cold"), spec)
    assert not MOVE.met(task, snapshot("board"), spec)
    assert not MOVE.met(task, snapshot(""), spec)
    assert not MOVE.met(task, snapshot("cold", held_by="human"), spec)


def test_manipulation_is_done_on_any_thing_of_the_destinations_kind():
    task = next(task for task in SMOKE.tasks if task.kind == MOVE.name)
    things = HOUSES[task.house].things
    right = next(thing.id for thing in things if thing.kind == task.goal.destination)
    state = ThingState(id=task.goal.target, kind="", position=(0.0, 0.0, 0.0), support=right)
    view = Snapshot(tick=1, poses={}, things={task.goal.target: state}, in_view={}, holding={})
    assert MOVE.met(task, view, HOUSES[task.house])


def test_least_time_of_a_search_in_an_empty_hall():
    table = furniture("t", "dining_table", 8.0, 2.0)
    apple = apple_on(table)
    level = math.sqrt(rules.FIND_RANGE_M**2 - (EYE_M - apple.position[2]) ** 2)
    times = FIND.least_times(hall(table), (apple,), Goal(target="apple", relation="find"))([(1.0, 2.0), (8.0, 2.0)])
    assert 7.0 - level - 0.12 <= times[0] <= 7.0 - level
    assert math.isinf(times[1])


def test_a_closed_fridge_costs_reaching_and_opening():
    fridge = furniture("cold", "fridge", 8.0, 3.5, math.pi)
    apple = apple_on(fridge)
    goal, spec = Goal(target="apple", relation="find"), hall(fridge)
    assert not ReachableFloor(spec).seeing(apple).any()
    assert ReachableFloor(spec).seeing(apple, frozenset({"cold"})).any()
    times = FIND.least_times(spec, (apple,), goal)([(1.0, 1.0)])
    assert times[0] >= math.dist((1.0, 1.0), (8.0, 3.5)) - rules.FIND_RANGE_M - 0.2 + rules.HANDLING_S
    assert math.isfinite(times[0])


def test_least_time_of_manipulation_in_an_empty_hall():
    table, counter = furniture("t", "dining_table", 3.0, 3.4), furniture("c", "counter_top", 8.0, 3.6)
    apple = apple_on(table, v=-0.9)
    goal = Goal(target="apple", relation="on", destination="counter_top")
    (time,) = MOVE.least_times(hall(table, counter), (apple,), goal)([(1.0, 1.0)])
    edge = np.array([8.0 - counter.size[0] / 2, 3.6 - counter.size[1] / 2])
    bound = math.dist((1.0, 1.0), edge) - REACH_M - 0.2 + 2 * rules.HANDLING_S
    assert bound <= time <= bound + 1.0
    into = Goal(target="apple", relation="in", destination="fridge")
    both = hall(table, counter, furniture("cold", "fridge", 8.0, 0.5))
    assert MOVE.least_times(both, (apple,), into)([(7.0, 1.5)])[0] >= 2 * (4.0 - 2 * REACH_M) + 3 * rules.HANDLING_S


def test_objections_say_what_is_wrong():
    spec = hall(furniture("t", "dining_table", 5.0, 2.0))
    assert "fridge" in MOVE.objection(Goal(target="apple", relation="in", destination="fridge"), spec)
    assert "relation" in MOVE.objection(Goal(target="apple", relation="in", destination="dining_table"), spec)
    assert "find" in FIND.objection(Goal(target="apple", relation="on", destination="bed"), spec)


# ---------------------------------------------------------------------------------------------------------- generation


def test_arrangements_follow_the_priors_and_the_ban():
    spec = HOUSES["juniper"]
    kinds = {thing.id: thing.kind for thing in spec.things}
    for root in range(6):
        for placement in arrange(spec, root, {"apple": "counter_top"}):
            assert placement.id != "apple" or kinds[placement.support] != "counter_top"
            assert _explained(spec, placement, kinds[placement.support])


def _explained(spec, placement, kind):
    """Whether any triplet of the target fits; nearness to other targets is not looked into."""
    for relation, reference in priors.weights(placement.kind):
        if relation != "near" and reference == kind:
            return True
        if relation == "near" and reference in catalog.TARGETS:
            return True
        marks = [thing for thing in spec.things if thing.kind == reference]
        if relation == "near" and any(distance_to_thing(placement.position[:2], mark) <= NEAR_M for mark in marks):
            return True
    return False


def test_an_empty_hall_has_no_place_for_anything():
    with pytest.raises(HthorError, match="no place for"):
        arrange(hall(), 1)


def test_a_rebuild_gives_the_same_bytes(tmp_path):
    plan = suite_specs.SUITE_SPECS["smoke"]
    rebuilt = generate.house_tasks(plan, HOUSES["juniper"])
    assert [jsonio.canonical(task) for task in rebuilt] == [
        jsonio.canonical(task) for task in SMOKE.tasks if task.house == "juniper"
    ]
    assert encode_suite(SMOKE) == library.suite_path("smoke").read_bytes()
    assert SMOKE.sha256 == jsonio.sha256(json.loads(library.suite_path("smoke").read_bytes())["tasks"])


def test_the_command_names_its_plans(capsys):
    assert generate.main(["smok"]) == 2
    assert "Did you mean 'smoke'" in capsys.readouterr().err


# ------------------------------------------------------------------------------------------------------ damaged suites


def damaged(tmp_path, change, rehash=True):
    """A copy of the suite's first tasks with one change, frozen anew or not."""
    document = {"name": "own", "version": 1, "tasks": [msgspec.to_builtins(task) for task in SMOKE.tasks[:3]]}
    document["sha256"] = jsonio.sha256(document["tasks"])
    change(document)
    if rehash and "tasks" in document:
        document["sha256"] = jsonio.sha256(document["tasks"])
    path = tmp_path / "own.json"
    path.write_bytes(jsonio.canonical(document))
    return path


def at(*keys, value):
    def change(document):
        place = document
        for key in keys[:-1]:
            place = place[key]
        place[keys[-1]] = value

    return change


T1 = ("tasks", 1)


@pytest.mark.parametrize(
    ("change", "field", "problem"),
    [
        (at("tasks", value=[]), "tasks", "empty"),
        (at("version", value="one"), "version", "int"),
        (at(*T1, "goal", "relation", value="under"), "tasks[1].goal.relation", "Invalid enum value"),
        (at(*T1, "kind", value="mobile_manipulatoin"), "tasks[1].kind", "Did you mean 'mobile_manipulation'"),
        (at(*T1, "house", value="junipr"), "tasks[1].house", "Did you mean 'juniper'"),
        (at(*T1, "house_sha256", value="0" * 64), "tasks[1].house_sha256", "was made for"),
        (at(*T1, "id", value=SMOKE.tasks[0].id), "tasks[1].id", "distinct"),
        (at(*T1, "objects", 0, "kind", value="appel"), "tasks[1].objects[0].kind", "Did you mean 'apple'"),
        (at(*T1, "objects", 0, "kind", value="sofa"), "tasks[1].objects[0].kind", "cannot be picked up"),
        (at(*T1, "objects", 0, "id", value="mug"), "tasks[1].objects[5].id", "taken"),
        (at(*T1, "objects", 0, "support", value="nowhere"), "tasks[1].objects[0].support", "no thing 'nowhere'"),
        (at(*T1, "objects", 0, "position", value=[1.0, 1.0, 9.0]), "tasks[1].objects[0].position", "no surface"),
        (at(*T1, "objects", 0, "near", value="nowhere"), "tasks[1].objects[0].near", "no thing or object 'nowhere'"),
        (
            lambda own: own["tasks"][1]["objects"][0].pop("support"),
            "tasks[1].objects[0].position",
            "nor does it lie on",
        ),
        (at(*T1, "goal", "destination", value="rocking_horse"), "tasks[1].goal", "rocking_horse"),
        (at(*T1, "goal", "target", value="pear"), "tasks[1].goal.target", "not one of the task's objects"),
        (at(*T1, "human_start", "x", value=-50.0), "tasks[1].human_start", "in a wall"),
        (at(*T1, "robot_starts", 1, "y", value=-50.0), "tasks[1].robot_starts[1]", "in a wall"),
        (at(*T1, "t_star", value=0.0), "tasks[1].t_star", "positive"),
        (at(*T1, "time_limit", value=-1.0), "tasks[1].time_limit", "positive"),
    ],
)
def test_a_damaged_suite_names_file_and_field(tmp_path, change, field, problem):
    path = damaged(tmp_path, change)
    with pytest.raises(TaskError) as caught:
        tasks.load_suite(path)
    assert caught.value.field == field
    assert problem in caught.value.problem
    assert str(path) in str(caught.value)


def test_two_objects_in_one_place_and_a_goal_met_at_once_are_found(tmp_path):
    def stack(document):
        objects = document["tasks"][0]["objects"]
        objects[1].update(position=objects[0]["position"], support=objects[0]["support"], kind=objects[0]["kind"])

    with pytest.raises(TaskError, match="in one another"):
        tasks.load_suite(damaged(tmp_path, stack))
    task = next(task for task in SMOKE.tasks if task.kind == MOVE.name)
    kinds = {thing.id: thing.kind for thing in HOUSES[task.house].things}
    support = next(placement.support for placement in task.objects if placement.id == task.goal.target)
    goal = msgspec.structs.replace(
        task.goal, destination=kinds[support], relation=catalog.kind(kinds[support]).relation
    )
    found = list(task_faults(msgspec.structs.replace(task, goal=goal), HOUSES[task.house]))
    assert ("goal", "is met before anybody has moved") in found


def test_a_sound_suite_of_ones_own_loads_from_its_path(tmp_path):
    path = damaged(tmp_path, lambda document: None)
    assert tasks.load_suite(path).tasks == tasks.load_suite(str(path)).tasks == SMOKE.tasks[:3]


def test_a_suite_that_was_changed_or_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(TaskError, match="changed after it was made"):
        tasks.load_suite(damaged(tmp_path, at(*T1, "t_star", value=1.0), rehash=False))
    (tmp_path / "own.json").write_bytes(b"{")
    with pytest.raises(TaskError, match="not JSON"):
        tasks.load_suite(tmp_path / "own.json")
    with pytest.raises(TaskError, match="cannot be read"):
        tasks.load_suite("absent.json")
    with pytest.raises(UnknownName, match="Did you mean 'smoke'"):
        tasks.load_suite("smok")
    assert "smoke" in tasks.suite_names()
