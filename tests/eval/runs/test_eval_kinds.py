"""Choosing what is played: a suite, a kind of ours, or a user's own kind in one file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from hthor import houses, tasks
from hthor.console import exit_status
from hthor.errors import HthorError, UnknownName
from hthor.eval.config import cli_command, task_selection
from hthor.eval.config.options import EvalOptions
from hthor.eval.config.run_config import KindRef
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import trial_record
from hthor.eval.results import aggregate
from hthor.eval.runner import experiment, progress
from hthor.report.drawing import trial_figure
from hthor.trials import Sources
from hthor.trials.sessions import make_sessions

pytestmark = pytest.mark.usefixtures("no_workers")

HOUSES = ("elder", "rowan")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two houses are enough here."""
    monkeypatch.setattr(houses, "names", lambda: HOUSES)


@pytest.fixture(autouse=True)
def _forget():
    """Kinds that tests load are forgotten, so that each may call its own what it likes."""
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name.startswith("hthor.tasks.kinds."):
            del sys.modules[name]


def conducted(**asked) -> experiment.FinishedRun:
    (done,) = experiment.run_experiment(resolve(EvalOptions(**asked, control=False)), lambda _: progress.Silent())
    return done


def test_a_suite_is_narrowed_to_a_kind():
    whole = task_selection.select_tasks("smoke", "")
    assert (whole.kind, whole.robots, len(whole.suite.tasks)) == (None, ("scout",), 60)
    for name in ("manipulation", "mobile_manipulation"):
        part = task_selection.select_tasks("smoke", name)
        assert part.kind.name == "mobile_manipulation"
        assert (len(part.suite.tasks), part.suite.name) == (40, "smoke")
        assert part.suite.sha256 != whole.suite.sha256
    assert task_selection.select_tasks("", "") == whole


@pytest.mark.parametrize(
    ("suite", "kind", "told"),
    [
        ("smoke", "manipulaton", "unknown kind of task 'manipulaton'. Did you mean 'manipulation'?"),
        ("smoke", "collect", "the suite 'smoke' has no task of the kind 'multi_robot_collection'; it has: mobile_man"),
        ("", "nowhere/kind.py", "A path must lead to a Python file"),
    ],
)
def test_what_does_not_fit_is_told(suite: str, kind: str, told: str):
    with pytest.raises(HthorError) as caught:
        task_selection.select_tasks(suite, kind)
    assert told in str(caught.value)


@pytest.mark.parametrize("name", ["navigation", "manipulation", "collect", "rearrange", "tidy", "carry", "vln"])
def test_a_kind_with_a_suite_of_its_own_needs_no_other(name: str):
    if name not in tasks.suite_names():
        pytest.skip(f"no suite '{name}' yet")
    chosen = task_selection.select_tasks("", name)
    assert chosen.kind is None, "it is all of that suite"
    assert {task.kind for task in chosen.suite.tasks} == {task_selection.find_kind(name).name}
    assert chosen.robots == tuple(task_selection.find_kind(name).crew)


def test_a_new_kind_of_ours_needs_no_suite(few: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(tasks, "suite_names", lambda: ("smoke",))
    done = conducted(kind="navigation", agent=("silent",), out=tmp_path / "run", participants=1, jobs=1)
    suite = tasks.load_suite(str(tmp_path / "run" / "suite.json"))
    assert [(task.kind, task.house) for task in suite.tasks] == [("object_goal_navigation", house) for house in HOUSES]
    assert done.config.kind == KindRef(name="object_goal_navigation")
    command = cli_command.resume_command(tmp_path / "run", done.config)
    assert " --kind object_goal_navigation " in command
    assert "--suite" not in command


# --------------------------------------------------------------------------------------------------- a user's own kind


def test_the_example_kind_runs_as_it_is(root: Path, few: None, tmp_path: Path):
    file = root / "examples" / "put_away.py"
    assert len(file.read_text().splitlines()) < 100
    assert file.read_text().strip() in (root / "docs" / "kinds.md").read_text(), "the docs show it as it is"
    done = conducted(kind=str(file), agent=("oracle",), out=tmp_path / "run", participants=1, jobs=1)
    assert done.config.kind.name == "put_away"
    assert [robot.robot for robot in done.config.robots] == ["tender"], "the kind's own crew"
    assert (done.result.counts.trials, done.result.counts.faults) == (2, 0)
    assert done.result.metrics.progress.n == 2
    suite = tasks.load_suite(str(tmp_path / "run" / "suite.json"))
    assert [task.house for task in suite.tasks] == list(HOUSES)
    assert suite.tasks[0].instruction == "Put the tomato and the lettuce in the fridge."
    assert suite.sha256 == done.config.suite.sha256
    lines = (tmp_path / "run" / "trials.jsonl").read_bytes().splitlines(keepends=True)
    records = [trial_record.decode(line) for line in lines]
    assert {one.spec.kind_sha256 for one in records} == {done.config.kind.sha256}
    sheet = trial_figure.trial_figure(records[0].spec, records[0].log, houses.load(records[0].spec.task.house))
    assert [tick.get_text() for tick in sheet.axes[1].get_yticklabels()] == ["person", "robot", "progress"]
    names = {text.get_text() for text in sheet.axes[0].texts}
    assert {"tomato", "lettuce", "fridge"} <= names, "both targets and where they are to go"
    _, again, stored = aggregate.rescore(tmp_path / "run")
    assert again == stored == done.result


def test_the_same_file_gives_the_same_tasks(root: Path, few: None):
    one, two = (task_selection.select_tasks("", str(root / "examples" / "put_away.py")) for _ in range(2))
    assert one == two
    assert one.generated
    assert one.robots == ("tender",)


KIND = """
from hthor.tasks.kinds.object_goal_navigation import ObjectGoalNavigation

class Mine(ObjectGoalNavigation):
    name = "{name}"
    short = "mine"
    def met(self, task, snapshot, house=None):
        {met}
        return super().met(task, snapshot, house)
    def goals(self, house):
        {goals}
        return super().goals(house)

KIND = Mine()
"""


def written(folder: Path, stem: str, *, name: str = "", met: str = "pass", goals: str = "pass") -> Path:
    file = folder / f"{stem}.py"
    file.write_text(KIND.format(name=name or stem, met=met, goals=goals))
    return file


def test_a_mistake_in_a_kind_is_told_with_its_line(few: None, tmp_path: Path):
    file = written(tmp_path, "hasty", met="if snapshot.tick > 3: raise KeyError('who knows')")
    with pytest.raises(HthorError, match=r"hasty\.py:8, in met: KeyError: 'who knows'") as caught:
        conducted(kind=str(file), agent=("silent",), out=tmp_path / "run", jobs=1, participants=1)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("raise KeyError('who knows')", "in goals: KeyError: 'who knows'"),
        ("open('no such file')", "in goals: FileNotFoundError"),
        ("raise SystemExit(3)", "in goals: SystemExit: 3"),
    ],
)
def test_a_mistake_in_drawing_is_told_with_its_line(
    few: None, tmp_path: Path, said: str, words: str, capsys: pytest.CaptureFixture[str], monkeypatch: Any
):
    file = written(tmp_path, "early", goals=said)
    monkeypatch.setattr("sys.argv", ["hthor", "eval"])
    with pytest.raises(SystemExit) as caught:
        exit_status.conclude(lambda **_: task_selection.select_tasks("", str(file)))
    assert caught.value.code == 2
    assert f"{file}:11, {words}" in capsys.readouterr().err


def test_a_file_that_ends_python_is_refused(tmp_path: Path):
    (tmp_path / "leaving.py").write_text("raise SystemExit(3)\n")
    with pytest.raises(HthorError, match=r"leaving\.py: SystemExit: 3\. The file must load by itself"):
        task_selection.select_tasks("", str(tmp_path / "leaving.py"))


def test_houses_that_have_nothing_for_a_kind_are_left_out(few: None, tmp_path: Path):
    some = task_selection.select_tasks("", str(written(tmp_path, "choosy", goals="if house.id == 'elder': return ()")))
    assert [task.house for task in some.suite.tasks] == ["rowan"]
    assert "there is no task in elder" in some.notes[0]
    with pytest.raises(HthorError, match="there is no task in elder"):
        task_selection.select_tasks("", str(written(tmp_path, "useless", goals="return ()")))


def test_a_file_that_is_no_kind(tmp_path: Path):
    with pytest.raises(HthorError, match="its name must be the file's, 'misnamed'"):
        task_selection.select_tasks("", str(written(tmp_path, "misnamed", name="other")))
    (tmp_path / "number.py").write_text("KIND = 5\n")
    with pytest.raises(HthorError, match="must be an instance of a subclass of hthor"):
        task_selection.select_tasks("", str(tmp_path / "number.py"))
    (tmp_path / "empty.py").write_text("")
    with pytest.raises(HthorError, match="must define 'KIND'"):
        task_selection.select_tasks("", str(tmp_path / "empty.py"))


def test_a_kind_that_changes_during_its_run_ends_it(few: None, tmp_path: Path):
    from hthor.eval.runner import session_runner

    file = written(tmp_path, "fickle")
    chosen = task_selection.select_tasks("", str(file))
    (dealt,) = make_sessions(chosen.suite, agent="silent", participants=1, kind_sha256=chosen.kind.sha256)
    perform = session_runner.make_runner(Sources(kind_path=chosen.kind_path))
    written(tmp_path, "fickle", met="return False")
    with pytest.raises(HthorError, match=r"fickle\.py was changed while its run was going on"):
        next(perform(dealt))


def test_who_is_evaluated_must_be_said():
    with pytest.raises(HthorError, match="name an agent with --agent, or robots and their agents"):
        conducted()
    with pytest.raises(HthorError, match="leave out --robot"):
        conducted(robots="tall:oracle", robot="scout")
    with pytest.raises(UnknownName, match="unknown suite"):
        conducted(agent=("silent",), suite="smok")
