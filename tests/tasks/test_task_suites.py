"""The suites that ship, and what `hthor tasks` says of them: counted, read, made again, refused when wrong."""

from __future__ import annotations

import json
import sys
from collections import Counter

import msgspec
import numpy as np
import pytest

from hthor import catalog, cli, houses, jsonio, plugins, tasks
from hthor.catalog import priors
from hthor.errors import UnknownName
from hthor.eval.task_check import solvability
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.generation import difficulty, generate, suite_specs
from hthor.tasks.kind import TaskKind
from hthor.tasks.kinds.mobile_manipulation import TEMPLATES
from hthor.tasks.suite import encode_suite, in_turn, make_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import task_faults
from hthor.types import Goal, Placement, Snapshot

NAVIGATION, MANIPULATION, PAPER = (tasks.load_suite(name) for name in ("navigation", "manipulation", "paper"))
EXACT = (NAVIGATION, MANIPULATION)
SOME = [*NAVIGATION.tasks[::61], *MANIPULATION.tasks[::173]]
PLAYED = [
    task if number in (0, 3) else pytest.param(task, marks=pytest.mark.nightly) for number, task in enumerate(SOME[::4])
]
"""At each commit a task of each of both suites is solved."""


@pytest.fixture
def hthor(monkeypatch, capsys):
    """Run a command in this process: its exit code, standard output and standard error."""
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    monkeypatch.setenv("_TYPER_FORCE_DISABLE_TERMINAL", "1")

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["hthor", *words])
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = end.code
        return (code, *capsys.readouterr())

    return run


# ------------------------------------------------------------------------------------------------------------ the data


def test_the_suites_have_as_many_tasks_as_the_benchmark():
    assert (len(NAVIGATION.tasks), len(MANIPULATION.tasks)) == (565, 1583)
    for suite in EXACT:
        assert {task.house for task in suite.tasks} == set(suite_specs.SCENES)
        assert len({task.id for task in suite.tasks}) == len(suite.tasks)
        assert {task.goal.target for task in suite.tasks} == set(catalog.TARGETS)
    placed = {(task.goal.target, task.goal.destination) for task in MANIPULATION.tasks}
    assert placed == {(target, place) for target, places in TEMPLATES.items() for place in places}
    assert len(placed) == 19
    said = {task.id.split("/", 2)[2] for task in NAVIGATION.tasks}
    assert said == {scene_graph.triplet_words(row) for row in priors.triplets()}
    assert len(said) == 65


def claim(task):
    """The target, the relation and the reference that a task's id names."""
    if task.kind == "object_goal_navigation":
        return tuple(task.id.split("/")[2].split("-"))
    return (task.goal.target, *task.id.split("/")[3].split("-"))


def test_every_target_is_where_the_id_of_its_task_says():
    for suite in EXACT:
        kinds = {name: {thing.id: thing.kind for thing in houses.load(name).things} for name in suite_specs.SCENES}
        for task in suite.tasks:
            target, relation, reference = claim(task)
            mine = next(one for one in task.objects if one.id == target == task.goal.target)
            known = kinds[task.house] | {one.id: one.kind for one in task.objects}
            if relation == "near":
                assert known[mine.near] == reference
            else:
                assert (mine.relation, known[mine.support], mine.near) == (relation, reference, "")
            assert known.get(mine.support) != task.goal.destination


def test_every_stratum_has_its_share():
    for suite in EXACT:
        counts = Counter(task.difficulty for task in suite.tasks)
        assert set(counts) == {"easy", "medium", "hard"}
        assert min(counts.values()) >= len(suite.tasks) / 5
    assert set(Counter(task.difficulty for task in PAPER.tasks)) == {"easy", "medium", "hard"}
    assert Counter(task.house for task in PAPER.tasks) == dict.fromkeys(suite_specs.SCENES, 3)
    assert {task.kind for task in PAPER.tasks} == {"mobile_manipulation"}


@pytest.mark.parametrize("task", SOME, ids=lambda task: task.id)
def test_a_slice_is_valid_and_as_difficult_as_it_says(task):
    house = houses.load(task.house)
    assert list(task_faults(task, house)) == []
    assert difficulty.level_of(task, house) == task.difficulty
    assert plugins.load("task kind", task.kind).t_star(task, house) == task.t_star
    assert len(task.robot_starts) == suite_specs.ROBOTS
    assert {one.id for one in task.objects} >= set(catalog.TARGETS)


@pytest.mark.parametrize("task", PLAYED, ids=lambda task: task.id)
def test_a_slice_can_be_done(task):
    assert solvability.check_task(task).faults == ()


# ------------------------------------------------------------------------------------------------------ made again


@pytest.mark.parametrize("name", ["navigation", "manipulation"])
def test_a_slice_made_again_is_the_same(name):
    plan, frozen = suite_specs.SUITE_SPECS[name], {task.id: task for task in tasks.load_suite(name).tasks}
    for scene, place in (("willow", 7), ("hazel", 31)):
        house = houses.load(scene)
        made = generate.make_ordered_task(plan, house, plan.orders(plan, house)[place])
        assert jsonio.canonical(made) == jsonio.canonical(frozen[made.id])


@pytest.mark.parametrize("name", ["smoke", "paper"])
def test_a_house_made_again_is_the_same_and_houses_take_turns(name):
    plan, frozen = suite_specs.SUITE_SPECS[name], tasks.load_suite(name).tasks
    columns = {house: tuple(task for task in frozen if task.house == house) for house in plan.houses}
    assert tuple(in_turn(list(columns.values()))) == frozen
    assert generate.house_tasks(plan, houses.load("willow")) == columns["willow"]


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["smoke", "paper"])
def test_a_suite_made_again_is_the_same_file(name):
    assert encode_suite(generate.build_suite(suite_specs.SUITE_SPECS[name])) == library.suite_path(name).read_bytes()


@pytest.mark.parametrize("name", sorted(suite_specs.SUITE_SPECS))
def test_files_are_canonical_and_carry_their_hash(name):
    data = library.suite_path(name).read_bytes()
    assert len(data) < 3_000_000
    suite = library.read_suite(name)
    assert encode_suite(suite) == data
    assert suite.sha256 == jsonio.sha256(json.loads(data)["tasks"])
    assert (suite.name, suite.version) == (name, suite_specs.SUITE_SPECS[name].version)


# --------------------------------------------------------------------------------------------------- kinds of any sort


class Visit(TaskKind):
    """A kind of few words: there is no target to start away from, and no place is far."""

    name, short, time_limit = "visit", "visit", 30.0

    def goals(self, house):
        return ()

    def objection(self, goal, house):
        return ""

    def draw(self, house, root):
        return Goal(target="vase", relation="find"), (Placement(id="mug", kind="mug", position=(0.0, 0.0, 0.0)),)

    def instruction(self, goal, objects):
        return "Go there."

    def solved(self, goal, objects, house):
        return False

    def met(self, task, snapshot: Snapshot, house=None):
        return False

    def least_times(self, house, objects, goal):
        return lambda starts: np.ones(len(starts))


def test_a_kind_without_a_target_gets_starts_all_the_same():
    task = generate.make_task(houses.load("willow"), Visit(), None, 5, name="visit/willow/1", robots=3)
    assert (task.t_star, task.time_limit, len(task.robot_starts)) == (1.0, 30.0, 3)
    assert task == generate.make_task(houses.load("willow"), Visit(), None, 5, name="visit/willow/1", robots=3)


# ---------------------------------------------------------------------------------------------------------- difficulty


def test_difficulty_grows_with_the_way_and_with_what_lies_before():
    task = MANIPULATION.tasks[0]
    house = houses.load(task.house)
    far = msgspec.structs.replace(task, t_star=160.0)
    assert difficulty.level_of(far, house) == "hard"
    assert difficulty.measure_difficulty(far, house).before == difficulty.measure_difficulty(task, house).before
    assert 0.0 <= difficulty.measure_difficulty(task, house).before <= 1.0
    kind = plugins.load("task kind", task.kind)
    times = (1.0, kind.medium_from, kind.hard_from)
    levels = [difficulty.Difficulty(least=t, before=0.0).level for t in times]
    assert levels == ["easy", "medium", "hard"]


def test_masses_are_those_of_the_priors():
    house = houses.load("alder")
    kinds = {thing.id: thing.kind for thing in house.things}
    total = Counter()
    for id, mass in difficulty.prior_mass(house, "mug").items():
        total[kinds[id]] += mass
    weights = priors.weights("mug")
    assert weights["in", "sink"] < total["sink"] < 2 * weights["in", "sink"]  # a mug near an apple may be there too
    assert sum(total.values()) <= 1.0
    assert set(difficulty.prior_mass(house, "laptop").values()) == {1.0}


# ------------------------------------------------------------------------------------------------------------ commands


def test_list_counts_the_suites_and_their_tasks(hthor):
    code, out, _ = hthor("tasks", "list", "--json")
    assert code == 0
    found = {row["name"]: row["tasks"] for row in json.loads(out)}
    assert (found["navigation"], found["manipulation"], found["paper"], found["smoke"]) == (565, 1583, 30, 60)
    assert len(json.loads(hthor("tasks", "list", "manipulation", "--json")[1])) == 1583
    code, out, _ = hthor("tasks", "list", "navigation")
    assert code == 0
    assert "565 tasks" in out


def test_list_narrows_down(hthor):
    words = ("tasks", "list", "smoke", "--house", "alder", "--kind", "manipulation", "--json")
    rows = json.loads(hthor(*words)[1])
    assert len(rows) == 4
    assert {row["house"] for row in rows} == {"alder"}
    rows = json.loads(hthor("tasks", "list", "navigation", "--target", "mug", "--difficulty", "hard", "--json")[1])
    assert rows
    assert {(row["target"], row["difficulty"]) for row in rows} == {("mug", "hard")}
    code, _, err = hthor("tasks", "list", "--house", "alder")
    assert code == 2
    assert "name a suite" in err


def test_show_tells_all_about_a_task_and_guesses_names(hthor):
    code, out, _ = hthor("tasks", "show", "navigation/alder/apple-in-fridge")
    assert code == 0
    for word in ("Find an apple.", "in fridge", "T*", "robot 4", "apple *"):
        assert word in out
    document = json.loads(hthor("tasks", "show", "navigation/alder/apple-in-fridge", "--json")[1])
    assert document["task"]["goal"]["target"] == "apple"
    code, _, err = hthor("tasks", "show", "navigation/alder/apple-in-frige")
    assert code == 2
    assert "Did you mean 'navigation/alder/apple-in-fridge'" in err


def test_draw_writes_a_picture(hthor, tmp_path):
    path = tmp_path / "a.png"
    code, out, _ = hthor("tasks", "draw", "smoke/willow/manipulation-01", "--out", str(path))
    assert (code, out.strip()) == (0, str(path))
    assert path.read_bytes()[:4] == b"\x89PNG"
    code, _, err = hthor("tasks", "draw", "smoke/willow/manipulation-01", "--out", str(tmp_path / "a.txt"))
    assert code == 2
    assert ".png" in err


def test_check_names_task_field_and_reason(hthor, tmp_path, monkeypatch):
    """In this process; that worker processes do the same is shown with suites of one's own."""
    monkeypatch.setattr(
        solvability, "run_in_workers", lambda work, items, jobs: (row for row in enumerate(map(work, items)))
    )
    task = next(task for task in PAPER.tasks if task.house == "willow")
    late = msgspec.structs.replace(task, id="late", t_star=300.0)
    path = tmp_path / "own.json"
    path.write_bytes(encode_suite(make_suite("own", 1, (task, late))))
    code, out, err = hthor("tasks", "check", str(path), "--jobs", "1")
    assert code == 1
    assert "late: t_star: means at least 114.4 s" in out
    assert "2/2 tasks, 1 unsound" in err
    code, out, err = hthor("tasks", "check", str(path), "--jobs", "1", "--json", "--quiet")
    assert (code, err) == (1, "")
    assert [fault["task"] for fault in json.loads(out)["faults"]] == ["late"]


def test_a_task_is_found_by_its_id_in_ones_own_file_too(tmp_path):
    path = tmp_path / "own.json"
    path.write_bytes(encode_suite(make_suite("own", 1, PAPER.tasks[:2])))
    assert library.find_task(PAPER.tasks[1].id, path)[1] == PAPER.tasks[1]
    with pytest.raises(UnknownName, match="unknown task"):
        library.find_task("paper/alder/nothing", path)
