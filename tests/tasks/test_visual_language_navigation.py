"""Instructions that describe a way: true of the route, read to the right end, and mirrored in a mirrored house."""

from __future__ import annotations

import functools
import math

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import houses, plugins, tasks
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.navigation import directions
from hthor.tasks.arrangement.reachability import HEIGHT_M, START_MARGIN_M
from hthor.tasks.generation import difficulty, generate
from hthor.tasks.generation.suite_specs import SCENES, SUITE_SPECS
from hthor.tasks.kinds import visual_language_navigation as vln
from hthor.tasks.routes import literal_reader
from hthor.tasks.routes.instruction_writer import directions_of
from hthor.tasks.routes.landmarks import in_sight, outline_distance, places_along
from hthor.tasks.routes.passages import exits, passages
from hthor.tasks.routes.route import as_route, place_beside, shortest_route
from hthor.tasks.suite import encode_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import task_faults
from hthor.types import WALKERS, Goal, Pose, Snapshot

SUITE = tasks.load_suite("vln")
KIND = vln.KIND
HOUSES = {name: houses.load(name) for name in SCENES}
FLOOR = {name: FreeSpace.of(house, START_MARGIN_M, HEIGHT_M) for name, house in HOUSES.items()}
OTHER_HAND = {"left": "right", "right": "left", "ahead": "ahead", "behind": "behind", None: None}


def start_of(task):
    return task.human_start if task.goal.target == "person_1" else task.robot_starts[0]


def seen(task, x, y, yaw=0.0, tick=1):
    seat = WALKERS[task.goal.target]
    return Snapshot(tick=tick, poses={seat: Pose(x=x, y=y, yaw=yaw)}, things={}, in_view={}, holding={})


def room_of(house, x, y):
    return next((room for room in house.rooms if plane.inside((x, y), room.polygon)), None)


@functools.cache
def places_by(name, landmark):
    return place_beside(HOUSES[name], next(thing for thing in HOUSES[name].things if thing.id == landmark))


@st.composite
def routes(draw):
    """A house, a start on its floor, a landmark, and the shortest route to it in another room."""
    name = draw(st.sampled_from(SCENES[:4]))
    house, cells = HOUSES[name], FLOOR[name].centres(FLOOR[name].free)
    x, y = cells[draw(st.integers(0, len(cells) - 1))]
    start = Pose(x=float(x), y=float(y), yaw=draw(st.floats(-3.1, 3.1)))
    goal = draw(st.sampled_from(KIND.goals(house)))
    end = next(thing for thing in house.things if thing.kind == goal.destination and not thing.parent)
    route = shortest_route(house, start, places_by(name, end.id))
    return house, start, end, route


def written(found):
    house, start, end, route = found
    return None if route is None else directions_of(house, start, route, end)


# ----------------------------------------------------------------------------------------------------- the instruction


@settings(max_examples=cases(40))
@given(routes())
def test_whoever_reads_the_words_literally_gets_to_the_end_of_the_route(found):
    house, start, end, route = found
    steps = written(found)
    if steps is None:
        return
    doors, reached = literal_reader.follow(house, start, directions.read(directions.write(steps)))
    assert reached == end
    assert doors == tuple(one.exit.id for one in route.stretches if one.exit is not None)
    assert outline_distance(end, route.points[-1]) <= vln.NEAR_M
    assert room_of(house, *route.points[-1]).id == end.room


@settings(max_examples=cases(40))
@given(routes())
def test_every_side_and_room_that_is_named_is_true_of_the_route(found):
    house, _, _, route = found
    steps = written(found) or ()
    doors = [step for step in steps if step.act in ("door", "opening")]
    left = [stretch for stretch in route.stretches if stretch.exit is not None] if route and doors else []
    assert len(doors) == len(left)
    kinds = {room.id: room.kind for room in house.rooms}
    for number, (step, stretch) in enumerate(zip(doors, left, strict=True)):
        assert kinds[stretch.exit.other_side(stretch.room.id)] == step.room
        assert (step.act == "door") == stretch.exit.is_door
        before = steps[steps.index(step) - 1] if number or steps[0] is not step else None
        if before is None or before.act != "turn":
            (x, y), (u, v) = stretch.points[0], stretch.exit.middle
            bearing = plane.wrap(math.atan2(v - y, u - x) - stretch.heading)
            assert directions.off_side(step.side, bearing) <= literal_reader.OFF_RAD


@settings(max_examples=cases(40))
@given(routes())
def test_every_landmark_is_in_sight_where_it_is_mentioned_and_on_the_hand_that_is_named(found):
    house, _, _, route = found
    steps, number = written(found) or (), 0
    for step in steps:
        stretch = route.stretches[number]
        if step.landmark:
            alike = [one for one in house.things if one.kind == step.landmark and one.room == stretch.room.id]
            (thing,) = [one for one in alike if not one.parent]
            places = places_along(stretch.points)
            assert in_sight(house, thing, places)
            if step.act == "past":
                near = min(range(len(places)), key=lambda k, thing=thing: outline_distance(thing, places[k]))
                (ax, ay), (bx, by) = places[max(near - 1, 0)], places[near]
                cross = (bx - ax) * (thing.centre[1] - by) - (by - ay) * (thing.centre[0] - bx)
                assert (cross > 0.0) == (step.side == "left")
        number += step.act in ("door", "opening")


def mirrored(house):
    """The house as in a mirror: everything at -x."""

    def flip(point):
        return (-point[0], *point[1:])

    replace = msgspec.structs.replace
    return replace(
        house,
        id=f"{house.id}-mirrored",
        rooms=tuple(replace(one, polygon=tuple(map(flip, reversed(one.polygon)))) for one in house.rooms),
        walls=tuple(replace(one, a=flip(one.b), b=flip(one.a)) for one in house.walls),
        openings=tuple(replace(one, a=flip(one.b), b=flip(one.a)) for one in house.openings),
        things=tuple(replace(one, centre=flip(one.centre), yaw=-one.yaw) for one in house.things),
    )


MIRRORED = {name: mirrored(house) for name, house in HOUSES.items()}


@pytest.mark.parametrize("task", SUITE.tasks, ids=lambda task: task.id)
def test_a_mirrored_house_gives_mirrored_words(task):
    """Boxes are mirrored by turning them the other way; the walk and the sight are the mirrored ones."""
    house, start = MIRRORED[task.house], start_of(task)
    other = Pose(x=-start.x, y=start.y, yaw=plane.wrap(math.pi - start.yaw))
    route = as_route(house, other, tuple((-x, y) for x, y in task.goal.route))
    end = next(thing for thing in house.things if thing.kind == task.goal.destination and not thing.parent)
    steps = directions.read(task.instruction)
    expected = tuple(msgspec.structs.replace(step, side=OTHER_HAND[step.side]) for step in steps)
    assert directions_of(house, other, route, end) == expected


def test_rooms_without_a_wall_between_them_have_an_opening():
    openings = [one for one in passages(HOUSES["willow"]) if not one.is_door]
    assert [set(one.rooms) for one in openings] == [{"room|2", "room|3"}]
    assert all(one.is_door for one in passages(HOUSES["maple"]))
    assert {one.id for one in exits(HOUSES["willow"], "room|2")} == {openings[0].id}


# ------------------------------------------------------------------------------------------------------------ the goal


@pytest.mark.parametrize("task", SUITE.tasks, ids=lambda task: task.id)
def test_the_suite_is_valid_and_what_it_says(task):
    house, start = HOUSES[task.house], start_of(task)
    assert list(task_faults(task, house)) == []
    assert KIND.misfit(task, house) == ""
    assert KIND.t_star(task, house) == task.t_star
    assert difficulty.level_of(task, house) == task.difficulty
    assert task.goal.route[0] == pytest.approx((start.x, start.y), abs=1e-3)
    length = sum(math.dist(a, b) for a, b in zip(task.goal.route, task.goal.route[1:], strict=False))
    assert vln.LEAST_M <= length <= vln.MOST_M
    assert not KIND.met(task, seen(task, start.x, start.y), house)
    assert KIND.met(task, seen(task, *task.goal.route[-1]), house)


def test_each_scene_has_a_walk_of_a_person_and_one_of_a_robot():
    walkers = {(task.house, task.goal.target) for task in SUITE.tasks}
    assert walkers == {(house, target) for house in SCENES for target in WALKERS}
    assert {task.difficulty for task in SUITE.tasks} == {"easy", "medium", "hard"}


def test_progress_grows_along_the_route():
    for task in SUITE.tasks[::5]:
        places = places_along(task.goal.route)
        shares = [KIND.progress(task, seen(task, x, y), HOUSES[task.house]) for x, y in places[::4]]
        assert shares[0] == pytest.approx(0.0, abs=0.02)
        assert shares == sorted(shares)
        assert shares[-1] > 0.8


def test_the_next_room_is_too_far_even_behind_a_thin_wall():
    task = next(one for one in SUITE.tasks if one.house == "alder")
    end = next(thing for thing in HOUSES["alder"].things if thing.kind == task.goal.destination)
    cells = FLOOR["alder"].centres(FLOOR["alder"].free)
    near = [(float(x), float(y)) for x, y in cells if outline_distance(end, (float(x), float(y))) <= vln.NEAR_M]
    rooms = {room_of(HOUSES["alder"], x, y).id for x, y in near if KIND.met(task, seen(task, x, y), HOUSES["alder"])}
    assert rooms == {end.room}


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        (Goal(target="mug", relation="go", destination="bed"), "person_1 or robot_1"),
        (Goal(target="person_1", relation="on", destination="bed"), "relation 'go'"),
        (Goal(target="person_1", relation="go", destination="chair"), "can end at"),
    ],
)
def test_what_is_no_walk_is_told(goal, told):
    assert told in KIND.objection(goal, HOUSES["alder"])


def test_a_house_made_again_is_the_same():
    own = tuple(task for task in SUITE.tasks if task.house == "willow")
    assert generate.house_tasks(SUITE_SPECS["vln"], HOUSES["willow"]) == own


@pytest.mark.nightly
def test_the_suite_made_again_is_the_same_file():
    assert encode_suite(generate.build_suite(SUITE_SPECS["vln"])) == library.suite_path("vln").read_bytes()


def test_the_kind_is_found_by_its_short_name():
    assert plugins.load("task kind", "visual_language_navigation") is KIND
    assert KIND.short == SUITE.name
