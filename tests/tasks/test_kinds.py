"""Kinds of task: one contract over all that are found, and what each of those made of jobs promises."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog, houses, jsonio, plugins, rules, tasks
from hthor.catalog import priors
from hthor.catalog.procthor import KIND_OF
from hthor.errors import HthorError, UnknownName
from hthor.geometry.plane import inside
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.tasks import job_times
from hthor.tasks.arrangement import commonsense_places
from hthor.tasks.arrangement.errands import Errand, Errands
from hthor.tasks.arrangement.free_spots import NEAR_M
from hthor.tasks.arrangement.reachability import HEIGHT_M, RADIUS_M, REACH_M, ReachableFloor
from hthor.tasks.generation import generate
from hthor.tasks.generation.suite_specs import SUITE_SPECS
from hthor.tasks.job_times import carrying_time
from hthor.tasks.jobs import PLACE_M, TOGETHER_M, is_done, jobs_left
from hthor.tasks.kinds import multi_robot_collection as collection
from hthor.tasks.subgoals import JobKind
from hthor.tasks.suite import encode_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import task_faults
from hthor.types import WALKERS, Goal, Job, Pose, Snapshot, TaskSpec, ThingState

EXAMPLES = Path(__file__).parents[2] / "examples"
EXAMPLE, WITH_PHASE = EXAMPLES / "put_away.py", EXAMPLES / "moved_apple.py"
KINDS = {name: plugins.load("task kind", name) for name in plugins.names("task kind")}
EXTENDED = {kind.short: kind for kind in KINDS.values() if isinstance(kind, JobKind)}
NIGHTLY = pytest.mark.nightly
DRAWN_IN = (
    ("elder", 1),
    *(
        pytest.param(*pair, marks=NIGHTLY)
        for pair in (("willow", 1), ("elder", 2), ("willow", 2), ("hazel", 1), ("hazel", 2))
    ),
)
HOUSES = {name: houses.load(name) for name in houses.names()}
_DRAWN: dict = {}


def drawn(kind, house, root):
    """A task of the kind, as its own draw makes it."""
    key = (kind.name, house, root)
    if key not in _DRAWN:
        goal, objects = kind.draw(HOUSES[house], root)
        _DRAWN[key] = TaskSpec(
            id=f"{kind.short}/{house}/{root}",
            kind=kind.name,
            house=house,
            house_sha256=HOUSES[house].sha256,
            human_start=HOUSES[house].start,
            robot_starts=(),
            objects=objects,
            goal=goal,
            instruction=kind.instruction(goal, objects),
            time_limit=kind.time_limit,
            t_star=1.0,
        )
    return _DRAWN[key]


def lying(placement, **changes):
    state = ThingState(id=placement.id, kind=placement.kind, position=placement.position, support=placement.support)
    return msgspec.structs.replace(state, **changes)


def seen(things, in_view=()):
    return Snapshot(tick=1, poses={}, things=things, in_view={"human": tuple(in_view)}, holding={})


def at_start(task):
    return {placement.id: lying(placement) for placement in task.objects}


def finished(task):
    """Every object where its job wants it, and no kind's own function asked how."""
    things, house = at_start(task), HOUSES[task.house]
    for job in task.goal.todo:
        state = things[job.target]
        if job.relation == "at":
            state = msgspec.structs.replace(state, position=job.place)
        elif job.relation != "find":
            support = next(one for one in house.things if one.id in job.destinations or one.kind in job.destinations)
            place = job.place or (support.centre[0], support.centre[1], 0.8)
            state = msgspec.structs.replace(state, position=place, support=support.id)
        things[job.target] = state
    return things


# ------------------------------------------------------------------------------------------------------ the contract


@pytest.mark.parametrize(("house", "root"), DRAWN_IN)
@pytest.mark.parametrize("name", [*KINDS, str(EXAMPLE), str(WITH_PHASE)])
def test_the_contract_of_every_kind(name, house, root):
    kind, home = plugins.load("task kind", name), HOUSES[house]
    task = drawn(kind, house, root)
    assert kind.draw(home, root) == (task.goal, task.objects)
    assert kind.phases(task, home, root) == kind.phases(task, home, root)
    task = msgspec.structs.replace(task, phases=kind.phases(task, home, root))
    told = kind.told_goal(task)
    assert [job.target for job in told.todo] == [job.target for job in task.goal.todo]
    assert all(job.relation != "back" or not (job.destinations or job.place) for job in told.todo)
    assert task.phases or told == task.goal, "nobody can remember what they were not shown"
    assert list(task_faults(task, home)) == []
    assert not kind.objection(task.goal, home)
    assert task.instruction.strip()
    assert task.instruction.endswith(".")
    assert not kind.solved(task.goal, task.objects, home)
    ids = [placement.id for placement in task.objects]
    assert {job.target for job in task.goal.todo} <= {*ids, *WALKERS}
    assert task.goal.target == task.goal.todo[0].target
    t_star = kind.t_star(task, home)
    assert 0.0 < t_star < task.time_limit
    if task.goal.relation == "go":
        return  # it is about bodies, and has tests of its own
    start, end = seen(at_start(task)), seen(finished(task), in_view=ids)
    assert not kind.met(task, start, home)
    assert 0.0 <= kind.progress(task, start, home) < 1.0
    assert kind.met(task, end, home)
    assert kind.progress(task, end, home) == 1.0


def test_every_kind_has_its_own_words_and_crews_that_exist():
    assert len({kind.short for kind in KINDS.values()}) == len(KINDS) >= 7
    for name, kind in KINDS.items():
        assert kind.name == name
        assert set(kind.crew) <= set(plugins.names("robot"))
        assert kind.time_limit >= rules.TIME_LIMIT_S
    assert KINDS["multi_robot_collection"].crew == ("tender", "puck")
    assert KINDS["collaborative_carrying"].crew == ("porter",)


@given(st.data())
def test_progress_is_one_when_the_goal_is_met_and_only_then(data):
    """Any state of the objects: at the start, done, in a hand, gone, or somewhere on the floor."""
    kind = data.draw(st.sampled_from(sorted(EXTENDED.values(), key=lambda kind: kind.name)))
    task = drawn(kind, "elder", 1)
    before, after = at_start(task), finished(task)
    things = {}
    for id in sorted(before):
        state = data.draw(st.sampled_from([before[id], after[id], after[id], None]))
        if state is not None:
            held = data.draw(st.sampled_from(["", "", "", "robot"]))
            x, y = data.draw(st.tuples(*[st.sampled_from([0.0, 0.0, 0.1, 3.0])] * 2))
            moved = (state.position[0] + x, state.position[1] + y, state.position[2])
            things[id] = msgspec.structs.replace(state, held_by=held, position=moved)
    share = kind.progress(task, seen(things), HOUSES["elder"])
    assert 0.0 <= share <= 1.0
    assert (share == 1.0) == kind.met(task, seen(things), HOUSES["elder"])


# -------------------------------------------------------------------------------------------------------------- jobs


def test_a_job_is_done_at_its_place_and_in_nobodys_hands():
    house = HOUSES["elder"]
    table = next(thing for thing in house.things if thing.kind == "dining_table")
    job = Job(target="mug", relation="on", destinations=(table.id,), place=table.centre)
    x, y, z = table.centre
    there = ThingState(id="mug", kind="mug", position=table.centre, support=table.id)
    assert is_done(job, there, house)
    assert not is_done(job, None, house)
    near, off = ((x + away, y, z) for away in (PLACE_M - 0.01, PLACE_M + 0.01))
    assert is_done(job, msgspec.structs.replace(there, position=near), house)
    for change in ({"position": off}, {"support": "sofa"}, {"held_by": "robot"}, {"bearers": ("human",)}):
        assert not is_done(job, msgspec.structs.replace(there, **change), house)
    anywhere = msgspec.structs.replace(job, place=None, destinations=("sofa", "dining_table"))
    assert is_done(anywhere, msgspec.structs.replace(there, position=off), house)
    assert not is_done(msgspec.structs.replace(job, relation="find"), there, house)


def test_a_room_is_reached_by_its_floor():
    house = HOUSES["elder"]
    trunk = drawn(KINDS["collaborative_carrying"], "elder", 1)
    (job,), place = trunk.goal.jobs, trunk.goal.jobs[0].place
    there = msgspec.structs.replace(lying(trunk.objects[0]), position=place)
    assert is_done(job, there, house)
    assert not is_done(job, msgspec.structs.replace(there, bearers=("human",)), house)
    room = next(room for room in house.rooms if room.id in job.destinations)
    for k in range(24):
        angle = k * math.pi / 12
        for away in (TOGETHER_M - 0.01, TOGETHER_M + 0.01):
            point = (place[0] + away * math.cos(angle), place[1] + away * math.sin(angle), place[2])
            moved = msgspec.structs.replace(there, position=point)
            assert is_done(job, moved, house) == (away < TOGETHER_M and inside(point[:2], room.polygon))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"jobs": ()}, "no jobs"),
        ({"target": "mug"}, "first job"),
        ({"jobs": ("twice",)}, "same object"),
        ({"jobs": (Job(target="apple", relation="on", destinations=("spaceship",)),)}, "spaceship"),
        ({"jobs": (Job(target="apple", relation="on", destinations=("rug",)),)}, "rug"),
        ({"jobs": (Job(target="apple", relation="on", place=(99.0, 0.0, 0.5)),)}, "no room"),
        ({"jobs": (Job(target="apple", relation="on"),)}, "neither"),
    ],
)
def test_impossible_goals_are_refused(change, says):
    kind, task = KINDS["multi_robot_collection"], drawn(KINDS["multi_robot_collection"], "elder", 1)
    if change.get("jobs") == ("twice",):
        change = {"jobs": task.goal.jobs[:1] * 2}
    goal = msgspec.structs.replace(task.goal, **change)
    assert says in kind.objection(goal, HOUSES["elder"])


@pytest.mark.parametrize("short", ["collect", pytest.param("tidy", marks=NIGHTLY)])
def test_t_star_is_no_more_than_a_person_alone_needs(short):
    """Who walks along exact paths between sampled places in reach, and does the jobs in any order, is never faster."""
    task, house = drawn(EXTENDED[short], "elder", 1), HOUSES["elder"]
    space = FreeSpace.of(house, RADIUS_M, HEIGHT_M)
    paths, there = Geodesics.of(space), {placement.id: placement for placement in task.objects}
    cells = space.centres(space.free)[::37]
    stops = []
    for job in jobs_left(task.goal, task.objects, house):
        x, y, _ = there[job.target].position
        stops.append([cell for cell in cells if math.dist(cell, (x, y)) <= REACH_M])
        supports = [one for one in house.things if one.id in job.destinations or one.kind in job.destinations]
        stops.append([cell for cell in cells for one in supports if math.dist(cell, one.centre[:2]) <= REACH_M])
    pairs = list(zip(stops[::2], stops[1::2], strict=True))
    t_star = EXTENDED[short].t_star(task, house)
    for order in itertools.permutations(pairs):
        here, walked = (task.human_start.x, task.human_start.y), 0.0
        for places in (places for pair in order for places in pair):
            ways = paths.distances(here, places)
            here, walked = tuple(places[int(np.argmin(ways))]), walked + float(ways.min())
        assert 0.0 < t_star <= walked / rules.PACE_M_S + len(stops) * rules.HANDLING_S


@pytest.mark.parametrize("short", ["collect", *(pytest.param(short, marks=NIGHTLY) for short in ("rearrange", "tidy"))])
def test_the_least_time_is_that_of_the_best_order(short):
    """It equals the shortest of the walks through all stops in each of the possible orders."""
    task, house = drawn(EXTENDED[short], "elder", 1), HOUSES["elder"]
    ground, there = ReachableFloor.of(house), {placement.id: placement for placement in task.objects}
    jobs = jobs_left(task.goal, task.objects, house)
    alone = [job_times.least_times(house, (there[job.target],), (job,)) for job in jobs]
    everything = job_times.least_times(house, task.objects, jobs)
    starts = ground.space.centres(ground.joined)[::997]
    rng = np.random.default_rng(0)
    errands = []
    for _ in jobs:
        masks = [ground._disc(tuple(starts[rng.integers(len(starts))]), 0.8) for _ in range(2)]
        errands.append(Errand(take=masks[0], put=masks[1], handling=1.0))
    walks = [
        ground.walk([mask for one in order for mask in (one.take, one.put)]).lengths(starts)
        for order in itertools.permutations(errands)
    ]
    best = np.min(walks, axis=0) / rules.PACE_M_S + len(jobs)
    assert Errands(ground, errands).seconds(starts) == pytest.approx(best, abs=1e-6)
    assert (everything(starts) >= np.max([each(starts) for each in alone], axis=0) - 1e-9).all()


def test_a_load_for_two_is_carried_at_their_pace():
    task, house = drawn(EXTENDED["carry"], "elder", 1), HOUSES["elder"]
    (job,), start = task.goal.jobs, [(task.human_start.x, task.human_start.y)]
    light = msgspec.structs.replace(job, hands=1)
    assert job_times.least_times(house, task.objects, (job,))(start) != job_times.least_times(
        house, task.objects, (light,)
    )(start)
    assert EXTENDED["carry"].t_star(task, house) >= carrying_time(house, task.objects[0], job)


def test_a_person_who_cannot_reach_an_object_has_no_t_star():
    task = drawn(KINDS["multi_robot_collection"], "elder", 1)
    outside = msgspec.structs.replace(task, human_start=Pose(x=-50.0, y=-50.0))
    assert KINDS["multi_robot_collection"].t_star(outside, HOUSES["elder"]) == math.inf


# -------------------------------------------------------------------------------------------------- the frozen suites


@pytest.fixture(params=["collect", "rearrange", "tidy", "carry"])
def suite(request):
    return tasks.load_suite(request.param)


def test_each_kind_has_two_tasks_in_each_scene(suite):
    kind = EXTENDED[suite.name]
    assert Counter(task.house for task in suite.tasks) == dict.fromkeys(houses.names(), 2)
    for task in suite.tasks:
        assert (task.kind, task.time_limit) == (kind.name, kind.time_limit)
        assert task.instruction == kind.instruction(task.goal, task.objects)
        assert len(task.robot_starts) >= len(kind.crew)
    assert len({jsonio.canonical((task.house, task.objects)) for task in suite.tasks}) == len(suite.tasks)


@pytest.mark.parametrize(
    "house", [name if name == "elder" else pytest.param(name, marks=NIGHTLY) for name in houses.names()]
)
def test_least_times_in_a_suite_are_those_of_its_kind(suite, house):
    own = [task for task in suite.tasks if task.house == house]
    assert own
    for task in own:
        assert EXTENDED[suite.name].t_star(task, HOUSES[house]) == task.t_star


@pytest.mark.parametrize("name", ["collect", "rearrange", "tidy", "carry"])
def test_a_task_made_anew_is_the_same(name):
    spec = SUITE_SPECS[name]
    again = generate.make_ordered_task(spec, HOUSES["elder"], spec.orders(spec, HOUSES["elder"])[0])
    assert again == next(task for task in tasks.load_suite(name).tasks if task.house == "elder")


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["collect", "rearrange", "tidy", "carry"])
def test_a_house_made_anew_is_the_same(name):
    again = generate.house_tasks(SUITE_SPECS[name], HOUSES["elder"])
    assert again == tuple(task for task in tasks.load_suite(name).tasks if task.house == "elder")
    assert library.suite_path(name).read_bytes() == encode_suite(tasks.load_suite(name))


def test_apples_are_apart_and_too_much_for_one():
    suite = tasks.load_suite("collect")
    cold = 0
    for task in suite.tasks:
        house = HOUSES[task.house]
        rooms = {thing.id: thing.room for thing in house.things}
        kinds = {thing.id: thing.kind for thing in house.things}
        where = [placement.support for placement in task.objects]
        assert [placement.id for placement in task.objects] == list(collection.APPLES)
        assert {placement.kind for placement in task.objects} == {"apple"}
        assert len({rooms[support] for support in where if kinds[support] != "fridge"}) == sum(
            kinds[support] != "fridge" for support in where
        )
        assert len({rooms[support] for support in where}) >= 2
        assert suite.tasks.index(task) % 3 or EXTENDED["collect"].misfit(task, house) == ""
        cold += "fridge" in {kinds[support] for support in where}
    assert 6 <= cold <= 14


def test_a_person_alone_is_never_timed_too_long():
    """`alone` against every order of fetching, walked along exact paths between real stands."""
    task = tasks.load_suite("collect").tasks[3]
    house = HOUSES[task.house]
    space = FreeSpace.of(house, RADIUS_M, HEIGHT_M)
    paths = Geodesics.of(space)
    place = next(thing for thing in house.things if thing.id in task.goal.jobs[0].destinations)
    end = space.nearest_free(place.centre[0], place.centre[1])
    stands = [space.nearest_free(*placement.position[:2]) for placement in task.objects]
    start = (task.human_start.x, task.human_start.y)
    there = [paths.distance(stand, end) for stand in stands]
    tours = [paths.distance(start, stand) - way + 2 * sum(there) for stand, way in zip(stands, there, strict=True)]
    assert rules.TIME_LIMIT_S < collection.alone(task, house) <= min(tours) / collection.PACE_M_S + 4.0


def test_a_task_that_needs_no_help_or_too_much_is_a_misfit():
    task, kind = tasks.load_suite("collect").tasks[3], EXTENDED["collect"]
    house = HOUSES[task.house]
    assert collection.TEAM_S < rules.TIME_LIMIT_S < collection.ALONE_S
    assert collection.team(task, house) <= collection.TEAM_S
    place = next(thing for thing in house.things if thing.id in task.goal.jobs[0].destinations)
    x, y = FreeSpace.of(house, RADIUS_M, HEIGHT_M).nearest_free(*place.centre[:2])
    near = tuple(msgspec.structs.replace(one, position=(x, y, 0.8)) for one in task.objects)
    assert "alone" in kind.misfit(msgspec.structs.replace(task, objects=near), house)
    far = max(zip(collection.ways(house, task.objects, task.goal), task.objects, strict=True), key=lambda pair: pair[0])
    all_far = tuple(msgspec.structs.replace(one, position=far[1].position) for one in task.objects)
    assert "hardly" in kind.misfit(msgspec.structs.replace(task, objects=all_far), house)


def test_shuffled_targets_are_elsewhere_and_the_rest_in_place():
    for task in tasks.load_suite("rearrange").tasks:
        house = HOUSES[task.house]
        there = {placement.id: placement for placement in task.objects}
        todo = {job.target for job in jobs_left(task.goal, task.objects, house)}
        assert 2 <= len(todo) <= 4
        assert {job.target for job in task.goal.jobs} == set(catalog.TARGETS) == set(there)
        assert task.goal.target == task.goal.jobs[0].target in todo
        for job in task.goal.jobs:
            away = math.dist(there[job.target].position, job.place)
            same = there[job.target].support in job.destinations
            assert (away >= 1.5 and not same) if job.target in todo else (away == 0.0 and same)


def test_the_tour_shows_the_tidy_house_and_nobody_is_told_more():
    kind = EXTENDED["rearrange"]
    for task in tasks.load_suite("rearrange").tasks:
        (tour,) = task.phases
        assert kind.solved(task.goal, tour.objects, HOUSES[task.house]), "everything is where it belongs"
        assert tour.restarts
        told = kind.told_goal(task)
        assert {job.target for job in told.jobs} == {job.target for job in task.goal.jobs}
        assert told.target == task.goal.target, "the instruction names it"
        assert {(job.relation, job.destinations, job.place) for job in told.jobs} == {("back", (), None)}
        assert task.longest == task.time_limit + tour.time_limit


def test_the_record_can_be_handed_out_instead():
    kind, toured = EXTENDED["rearrange"], tasks.load_suite("rearrange").tasks
    handed = tasks.load_suite("rearrange-record").tasks
    assert [msgspec.structs.replace(task, phases=()) for task in toured] == list(handed)
    assert all(kind.told_goal(task) == task.goal for task in handed)


def test_a_fault_of_a_phase_is_named():
    task = tasks.load_suite("rearrange").tasks[0]
    (tour,), house = task.phases, HOUSES[task.house]
    aloft = msgspec.structs.replace(tour.objects[0], position=(*tour.objects[0].position[:2], 2.0))
    strange = msgspec.structs.replace(tour.objects[0], id="pear")
    for faulty, field in (
        (msgspec.structs.replace(tour, name=""), "phases[0].name"),
        (msgspec.structs.replace(tour, time_limit=0.0), "phases[0].time_limit"),
        (msgspec.structs.replace(tour, objects=(aloft, *tour.objects[1:])), "phases[0].objects[0].position"),
        (msgspec.structs.replace(tour, objects=(strange, *tour.objects[1:])), "phases[0].objects"),
    ):
        found = [where for where, _ in task_faults(msgspec.structs.replace(task, phases=(faulty,)), house)]
        assert field in found
    twice = msgspec.structs.replace(task, phases=(tour, tour))
    assert [where for where, _ in task_faults(twice, house)] == ["phases[1].name"]


def test_only_a_briefing_says_back():
    task = tasks.load_suite("rearrange").tasks[0]
    told = EXTENDED["rearrange"].told_goal(task)
    assert "only briefings" in EXTENDED["rearrange"].objection(told, HOUSES[task.house])


def test_what_is_displaced_counts_against_what_is_fixed():
    kind, task = EXTENDED["rearrange"], tasks.load_suite("rearrange").tasks[0]
    house, things, end = HOUSES[task.house], at_start(task), finished(task)
    todo = [job.target for job in jobs_left(task.goal, task.objects, house)]
    fine = next(job.target for job in task.goal.jobs if job.target not in todo)
    assert kind.progress(task, seen(things), house) == 0.0
    fixed = {**things, todo[0]: end[todo[0]]}
    assert kind.progress(task, seen(fixed), house) == pytest.approx(1 / len(todo))
    harmed = {**fixed, fine: msgspec.structs.replace(things[fine], support="", position=(0.0, 0.0, 0.0))}
    assert kind.progress(task, seen(harmed), house) == 0.0
    worse = {**things, fine: harmed[fine]}
    assert kind.progress(task, seen(worse), house) == 0.0
    wrecked = {**end, fine: harmed[fine]}
    assert kind.progress(task, seen(wrecked), house) == pytest.approx(1 - 1 / len(todo))
    assert not kind.met(task, seen(wrecked), house)


def test_strewn_targets_are_where_nobody_wants_them_and_the_rest_where_they_may_be():
    for task in tasks.load_suite("tidy").tasks:
        house = HOUSES[task.house]
        kinds = {thing.id: thing.kind for thing in house.things}
        verdicts = {one.id: commonsense_places.places_of(one.id)[kinds[one.support]].verdict for one in task.objects}
        out = [target for target, verdict in verdicts.items() if verdict == "out"]
        assert 2 <= len(out) <= 4
        assert sorted(job.target for job in jobs_left(task.goal, task.objects, house)) == sorted(out)
        assert task.goal.target in out
        assert {job.target for job in task.goal.jobs} == set(catalog.TARGETS)
        for job in task.goal.jobs:
            assert set(job.destinations) <= set(kinds.values())
            assert all(commonsense_places.places_of(job.target)[kind].verdict != "out" for kind in job.destinations)


def test_trunks_stand_free_in_one_room_and_go_to_another():
    for task in tasks.load_suite("carry").tasks:
        house, (trunk,), (job,) = HOUSES[task.house], task.objects, task.goal.jobs
        room = next(room for room in house.rooms if room.id in job.destinations)
        assert job.hands == 2
        assert not inside(trunk.position[:2], room.polygon)
        assert inside(job.place[:2], room.polygon)
        mark = next(thing for thing in house.things if thing.kind == task.goal.destination)
        assert mark.room == room.id
        assert len([thing for thing in house.things if thing.kind == mark.kind]) == 1
        clear = FreeSpace.of(house, 0.6, HEIGHT_M)
        assert clear.is_free(*trunk.position[:2])
        assert clear.is_free(*job.place[:2])


def test_what_is_collected_and_tidied_is_in_reach_of_an_arm():
    for name in ("collect", "tidy"):
        for task in tasks.load_suite(name).tasks[:4]:
            space = FreeSpace.of(HOUSES[task.house], RADIUS_M, HEIGHT_M)
            for placement in task.objects:
                x, y, _ = placement.position
                assert math.dist(space.nearest_free(x, y), (x, y)) <= NEAR_M


# ----------------------------------------------------------------------------------------------------- the judgement


def test_the_judgement_covers_every_place_and_follows_its_numbers():
    bearing = {kind for kind in catalog.names() if catalog.kind(kind).rests()}
    for target in catalog.TARGETS:
        found = commonsense_places.places_of(target)
        assert set(found) == bearing
        edges = {place: weight for (how, place), weight in priors.weights(target).items() if how != "near"}
        for kind, row in found.items():
            if row.basis == "prior":
                assert row.share == pytest.approx(edges[kind] / sum(edges.values()), abs=1e-4)
                assert "priors" in row.source
            else:
                assert kind not in edges
                assert "receptacles.json" in row.source
            if row.basis == "none":
                assert row.share == 0.0
            expected = "out" if row.share < 0.03 else "acceptable" if row.share < 0.1 else "belongs"
            assert row.verdict == expected
        assert "belongs" in {row.verdict for row in found.values()}


def test_the_judgement_counts_what_its_source_says():
    """The counts are in the rows: "23 of 103"."""
    rows = [row for row in commonsense_places.all_places() if row.basis == "scenes"]
    for row in rows:
        names, _, count = row.source.removeprefix("receptacles.json: ").rpartition(", ")
        seen_there, total = (int(word) for word in count.split(" of "))
        assert row.share == pytest.approx(seen_there / total, abs=1e-4)
        assert {KIND_OF[name] for name in names.split(", ")} == {row.kind}
    assert len(rows) > 40


@pytest.mark.parametrize(
    ("target", "kind", "out"),
    [
        ("remote_control", "sink", True),
        ("remote_control", "sofa", False),
        ("book", "fridge", True),
        ("lettuce", "bed", True),
        ("lettuce", "fridge", False),
        ("mug", "chair", True),
        ("apple", "dining_table", False),
        ("apple", "stove", False),
    ],
)
def test_common_sense(target, kind, out):
    assert commonsense_places.is_misplaced(target, kind) == out
    assert ("stove" in commonsense_places.usual_places("apple")) is False


def test_nothing_is_judged_of_what_is_no_target():
    with pytest.raises(UnknownName, match="spaceship"):
        commonsense_places.places_of("spaceship")


# ------------------------------------------------------------------------------------------------------ small houses


def test_a_house_that_is_too_small_is_refused():
    house = msgspec.structs.replace(HOUSES["elder"], things=())
    for kind in EXTENDED.values():
        with pytest.raises(HthorError, match="house 'elder'"):
            kind.draw(house, 1)


def test_a_search_is_a_goal_of_one_job():
    assert Goal(target="apple", relation="find").todo == (Job(target="apple", relation="find"),)


@pytest.mark.parametrize("file", [EXAMPLE, WITH_PHASE])
def test_the_example_in_the_docs_is_the_file_and_short(file):
    text = file.read_text()
    assert text in (EXAMPLE.parents[1] / "docs" / "kinds.md").read_text()
    assert text.count("\n") < 100
