"""`--limit` and `--step-limit`: which tasks are played, what is part of a run's identity, what the board takes."""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from pathlib import Path
from typing import Any

import guest_agents
import msgspec
import pytest
from command_line import run
from eval_fakes import character, people, player, suite
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor import tasks
from hthor.cli import app
from hthor.errors import HthorError, RunError
from hthor.eval import dry_run
from hthor.eval.config import cli_command, run_config, task_selection
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import pairing
from hthor.eval.runner import engines, session_runner
from hthor.guest import GuestFault
from hthor.leaderboard.entries import overrides
from hthor.trials import Sources, TrialRunner, robot_team, sessions
from hthor.trials.sessions import Session
from hthor.types import Action

pytestmark = pytest.mark.usefixtures("no_workers")

SMOKE = tasks.load_suite("smoke").tasks


@given(st.integers(1, len(SMOKE) - 1))
def test_a_larger_choice_contains_a_smaller_one(count: int) -> None:
    some, more = task_selection.choose_subset(SMOKE, count), task_selection.choose_subset(SMOKE, count + 1)
    assert len(some) == count
    assert set(some) < set(more)
    assert list(some) == [task for task in SMOKE if task in some], "in the suite's order"


@pytest.mark.parametrize("count", [10, 20, 30])
def test_a_choice_is_spread_over_houses_and_kinds(count: int) -> None:
    whole, some = (
        tasks.load_suite("standard").tasks,
        task_selection.choose_subset(tasks.load_suite("standard").tasks, count),
    )
    for field in ("house", "kind"):
        every = Counter(getattr(task, field) for task in whole)
        here = Counter(getattr(task, field) for task in some)
        for name, number in every.items():
            assert abs(here[name] - count * number / len(whole)) <= 1.0, (field, name, here)


def test_a_limited_run_has_other_tasks_and_says_so() -> None:
    whole = task_selection.select_tasks("smoke", "")
    some = task_selection.limit_selection(whole, 10)
    assert some.limit == 10
    assert len(some.suite.tasks) == 10
    assert some.suite.name == "smoke"
    assert some.suite.sha256 != whole.suite.sha256
    assert "no result for the leaderboard" in some.notes[-1]
    assert task_selection.limit_selection(whole, len(whole.suite.tasks)) is whole, "all of them is the whole suite"
    with pytest.raises(HthorError, match=rf"--limit 999: the suite 'smoke' has {len(SMOKE)} tasks"):
        task_selection.limit_selection(whole, 999)


def submitted() -> robot_team.RobotTeam:
    return robot_team.form_team(
        ["scout"], [robot_team.AgentInfo(ref=robot_team.load_agent_info("oracle").ref, path="somewhere.py")]
    )


def plan(**more: object) -> run_config.RunConfig:
    return run_config.build_config(suite(30), submitted(), humans=people(), seed=0, participants=None, **more)  # type: ignore[arg-type]


def test_both_are_part_of_a_run_and_of_the_command_that_plays_it() -> None:
    bare, short = plan(), plan(limit=30, step_limit_s=2.5)
    assert bare.sha256 != short.sha256
    assert b"limit" not in msgspec.json.encode(bare)
    assert "-30-" in short.folder_name
    words = cli_command.resume_command(Path("runs/x"), short)
    assert "--limit 30" in words
    assert "--step-limit 2.5" in words
    assert overrides.overridden_settings(bare) == {}
    assert overrides.overridden_settings(short) == {"limit": "30", "step_limit": "2.5"}


def test_a_deadline_is_part_of_the_trials_of_submitted_agents_alone() -> None:
    for who, there in ((submitted(), 2.5), (robot_team.form_team(["scout"], ["oracle"]), msgspec.UNSET)):
        trial = sessions.make_sessions(suite(10), agent=who, humans=people(), step_limit_s=2.5)[0].trials[0]
        usual = sessions.make_sessions(suite(10), agent=who, humans=people())[0].trials[0]
        assert trial.step_limit_s == there
        assert usual.step_limit_s is msgspec.UNSET
        assert (trial_record.key(trial) == trial_record.key(usual)) == (there is msgspec.UNSET)
        assert pairing.pairing_key(trial) == pairing.pairing_key(usual), "the person's day is the same"


def test_a_worker_is_given_the_time_that_its_agents_have() -> None:
    one = suite(1).tasks
    assert engines.trial_limit_s(one, 1, 60.0) >= engines.trial_limit_s(one, 1) + 55.0 * one[0].time_limit / 0.1
    assert engines.trial_limit_s(one, 1, 0.5) == engines.trial_limit_s(one, 1)


SLOW = """
import time
from hthor.types import Action


class Agent:
    def begin(self, briefing):
        pass

    def act(self, observation):
        time.sleep(0.3)
        return Action()
"""


@pytest.mark.parametrize("seconds", [0.1, None])
def test_an_agent_that_takes_longer_than_the_limit_fails(tmp_path: Path, seconds: float | None) -> None:
    (tmp_path / "slow.py").write_text(SLOW)
    slow = robot_team.load_agent_info(str(tmp_path / "slow.py"))
    who = robot_team.form_team(["scout"], [slow])
    trials = sessions.make_sessions(suite(1), agent=who, humans="greedy", step_limit_s=seconds)[0].trials
    with TrialRunner(Sources(agent_paths=who.agent_paths, manifests=who.manifests)).enter(
        Session(number=0, trials=trials)
    ) as company:
        mind = company.ready_agents()["robot"]
        mind.begin(guest_agents.BRIEFING)
        if seconds is None:
            assert mind.act(guest_agents.look()) == Action()
            return
        with pytest.raises(GuestFault, match=r"gave no answer within 0\.1 s$") as caught:
            mind.act(guest_agents.look())
    assert caught.value.kind == "timeout"


def test_the_control_of_a_limited_run_has_the_same_tasks(tmp_path: Path) -> None:
    asked = resolve(EvalOptions(agent=("oracle",), suite="smoke", limit=12, out=tmp_path / "run"))
    control = asked.baseline_of[tmp_path / "run"].config
    assert control.limit == 12
    assert control.trials == 12
    assert control.suite == asked.runs[0].config.suite
    assert asked.runs[0].config.participants == 2


# ------------------------------------------------------------------------------------------------------ names and lists


def test_a_name_is_a_folder_and_a_heading_and_changes_no_trial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    one = resolve(EvalOptions(agent=("oracle",), name="first-try"))
    bare = resolve(EvalOptions(agent=("oracle",), control=False))
    (part,), (plain,) = one.runs, bare.runs
    assert part.folder.path == Path("runs/first-try")
    assert part.config.name == part.title == "first-try"
    assert part.config.team_name == plain.config.name == "oracle"
    assert (part.config.sha256, part.config.untitled) == (plain.config.sha256, plain.config)
    assert one.baseline_of[part.folder.path].folder.path == Path("runs/first-try/control"), "where it is found again"
    several = resolve(EvalOptions(agent=("oracle", "frontier"), name="both", control=False))
    assert [str(each.folder) for each in several.runs] == ["runs/both/oracle", "runs/both/frontier"]
    assert [each.config.name for each in several.runs] == ["both-oracle", "both-frontier"]


@pytest.mark.parametrize("name", ["", "-x", "a/b", "..", "a b", "x" * 61])
def test_a_name_that_is_no_folders_is_refused(name: str) -> None:
    with pytest.raises(HthorError, match="letters, digits"):
        run_config.check_title(name)


def test_a_run_keeps_the_name_that_it_began_with(tmp_path: Path) -> None:
    named = msgspec.structs.replace(plan(), title="first")
    RunFolder(tmp_path / "run").write_config(named)
    RunFolder(tmp_path / "run").check_free(plan())
    assert RunFolder(tmp_path / "run").write_config(plan()) == named
    with pytest.raises(RunError, match="is called 'first'"):
        RunFolder(tmp_path / "run").check_free(msgspec.structs.replace(plan(), title="second"))


@pytest.fixture(scope="module")
def shelf(tmp_path_factory: pytest.TempPathFactory, no_workers: None) -> Path:
    """A folder of runs: one that is whole, one with faults that was interrupted, and three that cannot be read."""
    folder = tmp_path_factory.mktemp("shelf")
    words = ("eval", "--suite", "fake", "--no-control", "--max-faults", "100%")
    load = tasks.load_suite
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tasks, "load_suite", lambda word: suite(20) if word == "fake" else load(word))
        patch.setattr(session_runner, "make_runner", player)
        patch.setattr(robot_team, "load_agent_info", lambda word, *_: character(word))
        told(*words, "--agent", "helper", "--name", "good", "--out", str(folder / "whole"))
        told(*words, "--agent", "clumsy", "--out", str(folder / "deep" / "half"))
    log = folder / "deep" / "half" / "trials.jsonl"
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:12]))
    (folder / "deep" / "half" / "result.json").unlink()
    for name, text in {"torn": '{"schema": "hthor.r', "old": '{"schema": "hthor.run/1"}', "deep/not": "\udcff"}.items():
        (folder / name).mkdir()
        (folder / name / "run.json").write_text(text, errors="surrogateescape")
    return folder


def told(*words: str) -> dict[str, Any]:
    """The document of a command that is run in this process."""
    found = CliRunner().invoke(app, [*words, "--json"], catch_exceptions=False)
    assert found.exit_code == 0
    return json.loads(found.stdout)


def test_runs_are_listed_even_beside_broken_ones(shelf: Path) -> None:
    document = told("runs", "list", str(shelf))
    found = {one["folder"]: one for one in document["runs"]}
    assert set(found) == {"whole", "deep/half", "torn", "old", "deep/not"}
    whole, half = found["whole"], found["deep/half"]
    assert (whole["name"], whole["agents"], whole["done"], whole["total"]) == ("good", ["helper"], 20, 20)
    assert (half["name"], half["done"], half["total"], half["suite"]) == ("clumsy", 12, 20, "fake")
    assert 0.0 <= half["success"] <= 1.0
    assert half["faults"] > 0
    assert all(found[name]["problem"] for name in ("torn", "old", "deep/not"))
    shown = CliRunner().invoke(app, ["runs", "list", str(shelf)], env={"COLUMNS": "400"})  # paths do not break
    assert "12 of 20" in shown.stdout
    assert "old: cannot be read" in shown.stdout
    rows = list(
        csv.reader(io.StringIO(CliRunner().invoke(app, ["runs", "list", str(shelf), "--format", "csv"]).stdout))
    )
    assert len(rows) == 6


def test_a_folder_without_runs_says_so(tmp_path: Path) -> None:
    assert "no run below" in CliRunner().invoke(app, ["runs", "list", str(tmp_path)]).stdout
    with pytest.raises(RunError, match=r"none is not a folder\."):
        CliRunner().invoke(app, ["runs", "list", str(tmp_path / "none")], catch_exceptions=False)


def test_a_run_is_viewed_with_what_to_do_next(shelf: Path) -> None:
    document = told("runs", "view", str(shelf / "deep" / "half"))
    assert document["result"] is None, "trials are missing"
    assert len(document["trials"]) == 12
    assert document["next"][0].startswith("hthor eval --agent clumsy")
    whole = told("runs", "view", str(shelf / "whole"))
    assert whole["result"]["name"] == "good"
    assert whole["next"] == [f"hthor replay {shelf}/whole 0", f"hthor report {shelf}/whole"]


def test_trials_are_chosen_by_what_they_are(shelf: Path) -> None:
    def numbers(*words: str) -> list[int]:
        return [one["number"] for one in told("runs", "view", str(shelf / "whole"), *words)["trials"]]

    every, met, failed = numbers(), numbers("--met"), numbers("--failed")
    assert every == sorted(met + failed) == list(range(20))
    assert met
    assert numbers("--faulty") == []
    assert 0 < len(numbers("--house", "barn")) < 20
    assert 0 < len(numbers("--participant", "1")) < 20
    one = numbers("--task", "t003")
    assert len(one) == 1
    shown = CliRunner().invoke(app, ["runs", "view", str(shelf / "whole"), "--house", "barn"]).stdout
    assert f"{len(numbers('--house', 'barn'))} of 20 trials" in shown


def test_a_first_dry_run_plays_a_few_trials_and_keeps_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ("eval", "--agent", "helper", "--suite", "fake", "--dry-run", "--out", str(tmp_path / "new"))
    code, document, said = run(*words, play="slow_player:0.02")
    assert code == 0
    assert list(tmp_path.iterdir()) == []
    assert "3 trials are played to see what they take" in said
    (one,) = (one for one in document["runs"] if not one["control"])
    assert one["pace"]["played"] == 3
    assert one["pace"]["folder"] == ""
    assert document["seconds"] >= 2 * 10 * 0.02, "twenty trials without and with a robot, by two workers at most"


def test_a_slow_first_trial_is_followed_by_a_second() -> None:
    """The first may have compiled for a minute, so that alone it would tell ten times what a run takes."""
    assert not dry_run._enough([55.0])
    assert dry_run._enough([55.0, 56.0])
    assert not dry_run._enough([5.0, 6.0]), "a third builds a house again"


def test_a_pace_counts_starts_and_houses_once() -> None:
    known = dry_run._cost_of([5.0, 7.0, 7.5])
    assert known == dry_run.TrialCost(trial_s=0.5, start_s=3.0, house_s=1.5, played=3)
    assert known.seconds(100, workers=2, houses=10) == 3.0 + 50 * 0.5 + 10 * 1.5
    assert known.seconds(4, workers=2, houses=10) == 3.0 + 2 * 0.5 + 2 * 1.5
    assert dry_run._cost_of([4.0]) == dry_run.TrialCost(trial_s=4.0, played=1)
    assert dry_run._cost_of([]) is None
