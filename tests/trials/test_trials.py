"""Trials without a run are those of a run, and any loop can drive them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import pytest

from hthor import tasks
from hthor.episode import EpisodeLog, play
from hthor.errors import HthorError
from hthor.eval.config import run_config
from hthor.eval.runner import session_runner
from hthor.trials import TrialRunner, find_team, form_team, make_session, make_sessions, make_sources
from hthor.trials.sessions import make_setup

AGENT = """
from hthor.types import Action, Move


class Agent:
    def begin(self, briefing):
        pass

    def act(self, now):
        return Action(motion=Move(forward=0.2))
"""


def test_a_session_of_a_suite_is_that_of_a_run() -> None:
    suite = tasks.load_suite("smoke")
    team, people = form_team(["scout"], ["frontier"]), find_team("proxy")
    config = run_config.build_config(suite, team, humans=people, seed=3, participants=None)
    sessions = make_sessions("smoke", agent="frontier", seed=3)
    assert sum(len(session.trials) for session in sessions) == config.trials
    first = sessions[0].trials[0]
    assert (first.code_sha256, first.rules_sha256, first.suite_sha256) == (
        config.code_sha256,
        config.rules_sha256,
        config.suite.sha256,
    )
    assert first.robots == config.robots


def test_a_session_of_any_tasks_has_them_in_order() -> None:
    chosen = tasks.load_suite("paper").tasks[4:1:-1]
    session = make_session(chosen, agent="oracle", seed=2, number=7)
    assert [trial.task for trial in session.trials] == list(chosen)
    assert {(trial.session, trial.seed, trial.suite_sha256) for trial in session.trials} == {(7, 2, "")}
    assert [trial.index for trial in session.trials] == [0, 1, 2]
    assert {trial.humans[0].participant for trial in session.trials} == {7}


def test_unknown_names_are_errors() -> None:
    with pytest.raises(HthorError, match="smokey"):
        make_sessions("smokey", agent="frontier")
    with pytest.raises(HthorError, match="frontiers"):
        make_setup([], agent="frontiers")


def test_a_loop_drives_the_trials() -> None:
    asked: list[Any] = []

    def loop(trial: Any, world: Any, humans: Any, robots: Any) -> EpisodeLog:
        asked.append((trial, sorted(humans), sorted(robots)))
        return play(trial, world, humans, robots)

    session = make_session(_short(2), agent="frontier")
    own = [played.log for played in TrialRunner(loop=loop).play(session)]
    assert [trial for trial, *_ in asked] == list(session.trials)
    assert {(*humans, *robots) for _, humans, robots in asked} == {("human", "robot")}
    assert own == [played.log for played in TrialRunner().play(session)]


def test_an_agent_in_a_file_plays_as_in_a_run(tmp_path: Path) -> None:
    path = tmp_path / "my_agent.py"
    path.write_text(AGENT, encoding="utf-8")
    team = form_team(["scout"], [str(path)])
    session = make_session(_short(1), agent=team)
    (played,) = TrialRunner(make_sources(team)).play(session)
    (done,) = session_runner.make_runner(make_sources(team))(session)
    assert played.log.events == done.record.events
    assert played.log.faults == ()
    assert played.log.ticks == done.record.ticks > 0


def _short(count: int) -> list[Any]:
    """The first tasks of `smoke`, of four seconds each."""
    some = tasks.load_suite("smoke").tasks[:count]
    return [msgspec.structs.replace(task, time_limit=4.0, phases=()) for task in some]
