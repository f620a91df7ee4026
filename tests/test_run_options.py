"""`--limit` and `--step-limit`: which tasks are played, what is part of a run's identity, what the board takes."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import msgspec
import pytest
import test_guest
from eval_fakes import persons, suite
from hypothesis import given
from hypothesis import strategies as st

from hthor import tasks
from hthor.errors import HthorError
from hthor.eval import cast, command, crews, intent, pairing, programme, record, selection, session, setup, waiting
from hthor.eval.session import Session
from hthor.guest import GuestFault
from hthor.leaderboard import overrides
from hthor.types import Action

SMOKE = tasks.suite("smoke").tasks


@given(st.integers(1, len(SMOKE) - 1))
def test_a_larger_choice_contains_a_smaller_one(count: int) -> None:
    some, more = selection.choose(SMOKE, count), selection.choose(SMOKE, count + 1)
    assert len(some) == count
    assert set(some) < set(more)
    assert list(some) == [task for task in SMOKE if task in some], "in the suite's order"


@pytest.mark.parametrize("count", [10, 20, 30])
def test_a_choice_is_spread_over_houses_and_kinds(count: int) -> None:
    whole, some = tasks.suite("standard").tasks, selection.choose(tasks.suite("standard").tasks, count)
    for field in ("house", "kind"):
        every = Counter(getattr(task, field) for task in whole)
        here = Counter(getattr(task, field) for task in some)
        for name, number in every.items():
            assert abs(here[name] - count * number / len(whole)) <= 1.0, (field, name, here)


def test_a_limited_run_has_other_tasks_and_says_so() -> None:
    whole = programme.choose("smoke", "")
    some = programme.shorten(whole, 10)
    assert some.limit == 10
    assert len(some.suite.tasks) == 10
    assert some.suite.name == "smoke"
    assert some.suite.sha256 != whole.suite.sha256
    assert "no result for the leaderboard" in some.notes[-1]
    assert programme.shorten(whole, len(whole.suite.tasks)) is whole, "all of them is the whole suite"
    with pytest.raises(HthorError, match=rf"--limit 999: the suite 'smoke' has {len(SMOKE)} tasks"):
        programme.shorten(whole, 999)


def submitted() -> crews.Crew:
    return crews.form(["scout"], [crews.Character(ref=crews.introduce("oracle").ref, path="somewhere.py")])


def plan(**more: object) -> setup.Setup:
    return setup.settle(suite(30), submitted(), human=persons(), seed=0, participants=None, **more)  # type: ignore[arg-type]


def test_both_are_part_of_a_run_and_of_the_command_that_plays_it() -> None:
    bare, short = plan(), plan(limit=30, step_limit_s=2.5)
    assert bare.sha256 != short.sha256
    assert b"limit" not in msgspec.json.encode(bare)
    assert "-30-" in short.folder_name
    words = command.of(Path("runs/x"), short)
    assert "--limit 30" in words
    assert "--step-limit 2.5" in words
    assert overrides.of(bare) == {}
    assert overrides.of(short) == {"limit": "30", "step_limit": "2.5"}


def test_a_deadline_is_part_of_the_trials_of_submitted_agents_alone() -> None:
    for who, there in ((submitted(), 2.5), (crews.form(["scout"], ["oracle"]), msgspec.UNSET)):
        trial = session.sessions(suite(10), agent=who, human=persons(), step_limit_s=2.5)[0].trials[0]
        usual = session.sessions(suite(10), agent=who, human=persons())[0].trials[0]
        assert trial.step_limit_s == there
        assert usual.step_limit_s is msgspec.UNSET
        assert (record.key(trial) == record.key(usual)) == (there is msgspec.UNSET)
        assert pairing.occasion(trial) == pairing.occasion(usual), "the person's day is the same"


def test_a_worker_is_given_the_time_that_its_agents_have() -> None:
    one = suite(1).tasks
    assert waiting.limit(one, 1, 60.0) >= waiting.limit(one, 1) + 55.0 * one[0].time_limit / 0.1
    assert waiting.limit(one, 1, 0.5) == waiting.limit(one, 1)


SLOW = """
import time
from hthor.types import Action


class Agent:
    def begin(self, briefing):
        pass

    def act(self, observation):
        time.sleep(0.6)
        return Action()
"""


@pytest.mark.parametrize("seconds", [0.1, None])
def test_an_agent_that_takes_longer_than_the_limit_fails(tmp_path: Path, seconds: float | None) -> None:
    (tmp_path / "slow.py").write_text(SLOW)
    slow = crews.introduce(str(tmp_path / "slow.py"))
    who = crews.form(["scout"], [slow])
    trials = session.sessions(suite(1), agent=who, human="greedy", step_limit_s=seconds)[0].trials
    with cast.Stage(cast.Sources(minds=who.minds)).enter(Session(participant=0, trials=trials)) as company:
        mind = company.robots()["robot"]
        mind.begin(test_guest.BRIEFING)
        if seconds is None:
            assert mind.act(test_guest.look()) == Action()
            return
        with pytest.raises(GuestFault, match=r"gave no answer within 0\.1 s$") as caught:
            mind.act(test_guest.look())
    assert caught.value.kind == "timeout"


def test_the_control_of_a_limited_run_has_the_same_tasks(tmp_path: Path) -> None:
    asked = intent.settle(
        intent.Options(agents=("oracle",), suite="smoke", limit=12, control=True, out=tmp_path / "run")
    )
    control = asked.control_of[tmp_path / "run"].plan
    assert control.limit == 12
    assert control.trials == 12
    assert control.suite == asked.parts[0].plan.suite
    assert asked.parts[0].plan.participants == 2
