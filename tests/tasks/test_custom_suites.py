"""Suites of one's own: made, found again with their houses, looked through before they are played, and narrowed."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import msgspec
import pytest

from hthor import cli, houses, tasks
from hthor.errors import HthorError, TaskError, UnknownName
from hthor.eval.config import cli_command, run_config, task_selection
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning import custom_houses
from hthor.eval.planning.resolve import resolve
from hthor.eval.task_check import solvability
from hthor.houses.assets import DATABASE
from hthor.tasks.generation import custom_suite
from hthor.tasks.generation.custom_suite import Recipe
from hthor.tasks.suite import encode_suite, make_suite
from hthor.tasks.suites import library, suite_files
from hthor.tasks.validate import find_faults
from hthor.types import HouseSpec, TaskSpec

DATA = Path(houses.__file__).parent / "data"
RECIPE = Recipe(name="mine", tasks=3, seed=5)
ELDER = houses.load("elder")
CUP = {"assetId": "Cup_1", "objectType": "Cup", "boundingBox": {"x": 0.08, "y": 0.1, "z": 0.08},
       "primaryProperty": "CanPickup"}  # fmt: skip


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A house file of one's own, with an asset that hthor does not know and the database that does."""
    folder = tmp_path_factory.mktemp("homes")
    document: Any = json.loads((DATA / "elder.json").read_bytes())
    table = next(row for row in document["objects"] if row["assetId"].startswith("hthor_dining_table"))
    place = {**table["position"], "y": 2 * table["position"]["y"] + 0.05}
    table["children"] = [{"id": "cup", "assetId": "Cup_1", "position": place, "rotation": {"x": 0, "y": 0, "z": 0}}]
    (folder / "my home.json").write_text(json.dumps(document))
    other = {**CUP, "assetId": "Cup_2"}
    (folder / DATABASE).write_text(json.dumps({"Cup": [CUP, other]}))
    return folder / "my home.json"


@pytest.fixture(scope="module")
def made(home: Path) -> tuple[TaskSpec, ...]:
    return custom_suite.make_tasks(RECIPE, houses.load(home))


@pytest.fixture
def suite(home: Path, made: tuple[TaskSpec, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    files = suite_files.make_files("mine", custom_suite.VERSION, suite_files.find_sources([str(home)]), [made])
    return suite_files.write_files(tmp_path / "mine.json", files)


def broken(path: Path, *numbers: int) -> Path:
    """The suite with objects of some tasks a metre too high."""
    found = library.read_suite(path)
    rows = [_raised(task) if number in numbers else task for number, task in enumerate(found.tasks)]
    path.write_bytes(encode_suite(make_suite(found.name, found.version, tuple(rows))))
    return path


def _raised(task: TaskSpec) -> TaskSpec:
    first, *others = task.objects
    x, y, z = first.position
    return msgspec.structs.replace(task, objects=(msgspec.structs.replace(first, position=(x, y, z + 1.0)), *others))


# -------------------------------------------------------------------------------------------------------------- making


def test_equal_recipes_give_equal_tasks_and_other_seeds_others(home: Path, made: tuple[TaskSpec, ...]):
    assert custom_suite.make_tasks(RECIPE, houses.load(home)) == made
    assert custom_suite.make_tasks(msgspec.structs.replace(RECIPE, seed=6, tasks=1), houses.load(home))[0] not in made
    assert [task.id for task in made] == sorted({task.id for task in made}, key=[task.id for task in made].index)
    assert {task.house for task in made} == {"my home"}


def test_what_cannot_be_done_is_drawn_again_with_another_goal_in_the_end(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(custom_suite, "_LAPS", 2)
    first = custom_suite.make_tasks(Recipe(name="mine", tasks=1, kinds=("mobile_manipulation",)), ELDER)[0].goal
    tried: list[TaskSpec] = []

    def possible(task: TaskSpec, house: HouseSpec) -> bool:
        tried.append(task)
        return task.goal != first

    (task,) = custom_suite.make_tasks(Recipe(name="mine", tasks=1, kinds=("mobile_manipulation",)), ELDER, possible)
    assert task.goal != first
    assert len(tried) > 1
    with pytest.raises(HthorError, match="has no room for another task like 'mine/elder/navigation-01'"):
        custom_suite.make_tasks(
            Recipe(name="mine", tasks=1, kinds=("object_goal_navigation",)), ELDER, lambda *_: False
        )


def test_a_suite_brings_its_houses_and_what_they_need(suite: Path, made: tuple[TaskSpec, ...], home: Path):
    names = sorted(path.name for path in suite.with_suffix(".houses").iterdir())
    assert names == [DATABASE, "my home.json"]
    rows = json.loads((suite.with_suffix(".houses") / DATABASE).read_bytes())
    assert rows == {"Cup": [CUP]}, "only what the house names"
    found = tasks.load_suite(suite)
    assert found.tasks == made
    assert found.houses.load("my home") == houses.load(home)
    assert set(library.house_files(suite)) == set(names)


def test_a_folder_does_as_well(home: Path, made: tuple[TaskSpec, ...], tmp_path: Path):
    files = suite_files.make_files("mine", custom_suite.VERSION, suite_files.find_sources([str(home)]), [made])
    out = suite_files.write_files(tmp_path / "mine", files)
    assert sorted(path.name for path in out.iterdir()) == ["houses", "suite.json"]
    assert tasks.load_suite(out).tasks == made
    with pytest.raises(HthorError, match="exists"):
        suite_files.check_unused(out)


def test_houses_are_told_apart_by_name(home: Path, tmp_path: Path):
    twin = tmp_path / home.name
    shutil.copy(home, twin)
    shutil.copy(home.parent / DATABASE, tmp_path / DATABASE)
    with pytest.raises(HthorError, match="two of the houses are called 'my home'"):
        suite_files.find_sources([str(home), str(twin)])
    shutil.copy(DATA / "alder.json", tmp_path / "birch.json")
    with pytest.raises(HthorError, match="has the name of one of hthor's own houses"):
        suite_files.find_sources([str(tmp_path / "birch.json")])
    assert suite_files.find_sources(["alder"])[0].file is None
    for name in ("smoke", "a b", "", "../x"):
        with pytest.raises(HthorError, match="suite"):
            suite_files.check_name(name)


# -------------------------------------------------------------------------------------------------- before it is played


def test_every_unsound_task_is_named(suite: Path):
    found = library.read_suite(broken(suite, 0, 2))
    assert {one.index for one in find_faults(found)} == {0, 2}
    with pytest.raises(TaskError) as error:
        task_selection.select_tasks(str(suite), "")
    assert "2 of the suite's 3 tasks cannot be run as they are" in str(error.value)
    assert all(found.tasks[number].id in str(error.value) for number in (0, 2))
    assert "hthor tasks check" in str(error.value)


def test_the_check_lists_every_task(suite: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    ids = [task.id for task in library.read_suite(broken(suite, 0, 1, 2)).tasks]
    monkeypatch.setattr(sys, "argv", ["hthor", "tasks", "check", str(suite), "--jobs", "1"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 1
    said = capsys.readouterr()
    assert [line.split(": ")[0] for line in said.out.splitlines() if "rests on no surface" in line] == ids
    assert "tasks, 3 unsound" in said.err


def test_one_fault_is_told_as_it_is(suite: Path):
    with pytest.raises(TaskError, match=r"mine\.json: tasks\[1\]\.objects\[0\]\.position: .* rests on no surface"):
        task_selection.checked_suite(str(broken(suite, 1)))


def test_that_a_suite_is_sound_is_remembered_until_it_changes(suite: Path, monkeypatch: pytest.MonkeyPatch):
    looked: list[str] = []
    monkeypatch.setattr(task_selection, "validate", lambda found, file: looked.append(file))
    assert task_selection.checked_suite(str(suite)) == task_selection.checked_suite(str(suite))
    assert len(looked) == 1
    house = suite.with_suffix(".houses") / "my home.json"
    house.write_bytes(house.read_bytes() + b" ")
    task_selection.checked_suite(str(suite))
    assert len(looked) == 2, "the houses count, too"


def test_a_kind_that_is_not_there_is_a_fault_and_no_end(made: tuple[TaskSpec, ...], home: Path):
    verdict = solvability.check_task(msgspec.structs.replace(made[0], kind="nothing"), houses.load(home))
    assert [fault.field for fault in verdict.faults] == ["kind"]
    assert solvability.repeated([made[0], made[1], made[0]])[0].task == made[0].id
    assert not solvability.repeated(made)


# -------------------------------------------------------------------------------------------------------------- a part


def test_a_suite_is_narrowed_to_houses_and_difficulty():
    whole = task_selection.select_tasks("paper", "")
    some = task_selection.narrow_selection(whole, ("birch", "alder"), "easy")
    assert {(task.house, task.difficulty) for task in some.suite.tasks} == {("alder", "easy"), ("birch", "easy")}
    assert some.houses == ("alder", "birch"), "in the suite's order, so that the same choice is the same run"
    assert some.suite.sha256 != whole.suite.sha256
    assert "no result for the leaderboard" in some.notes[-1]
    assert task_selection.narrow_selection(whole, (), "") is whole
    with pytest.raises(UnknownName, match=r"unknown house of the suite .paper. .aldr.*alder"):
        task_selection.narrow_selection(whole, ("aldr",), "")


def test_difficulty_is_worked_out_where_a_suite_does_not_tell():
    whole = task_selection.narrow_selection(task_selection.select_tasks("smoke", ""), ("alder",), "")
    parts = [len(task_selection.narrow_selection(whole, (), level).suite.tasks) for level in ("easy", "medium")]
    assert 0 < sum(parts) <= len(whole.suite.tasks)


def test_the_part_is_in_the_configuration_and_the_command(tmp_path: Path):
    options = EvalOptions(agent=("frontier",), suite="paper", house=("alder",), difficulty="easy", control=False)
    plan = resolve(options).runs[0].config
    assert (plan.houses, plan.difficulty) == (("alder",), "easy")
    assert "paper-alder-easy" in plan.folder_name
    assert "--house alder --difficulty easy" in cli_command.resume_command(tmp_path, plan)
    whole = resolve(EvalOptions(agent=("frontier",), suite="paper", control=False)).runs[0].config
    assert not whole.houses
    assert run_config.differences(whole, plan)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"house": ("alder", "x.json")}, "--house alder is a suite's house"),
        ({"house": ("x.json",), "suite": "smoke"}, "leave out --suite"),
        ({"house": ("x.json",), "kind": "mine.py"}, "hthor's kinds of task"),
        ({"house": ("no such file.json",)}, "no such file.json"),
    ],
)
def test_what_does_not_go_with_a_house_of_ones_own(options: Any, words: str):
    with pytest.raises(HthorError, match=words):
        custom_houses.make_suite(EvalOptions(agent=("frontier",), **options), lambda _: None)


def test_a_house_of_ones_own_is_made_into_a_suite_once(
    home: Path, made: tuple[TaskSpec, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(custom_houses.proved, "make_tasks", lambda recipe, given, jobs: iter([(0, made)]))
    told: list[str] = []
    options = EvalOptions(agent=("frontier",), house=(str(home),), jobs=1, control=False)
    first = custom_houses.make_suite(options, told.append)
    assert custom_houses.make_suite(options, told.append) == first
    assert len(told) == 1
    assert tasks.load_suite(str(first)).tasks == made
    assert tasks.load_suite(str(first)).name == "in-my-home"
