"""Dealing tasks: everyone gets their share, every task is done, and the agent has no say in it."""

from __future__ import annotations

from collections import Counter

import eval_fakes as fakes
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import rules
from hthor.trials import sessions


@given(st.integers(1, 130), st.integers(-(2**40), 2**40))
def test_by_default_every_task_is_done_once(count: int, seed: int):
    tasks = [fakes.task(number) for number in range(count)]
    hands = [sessions.assign_tasks(tasks, seed, participant) for participant in range(sessions.sessions_needed(count))]
    assert sorted(number for hand in hands for number in hand) == list(range(count))
    assert max(map(len, hands)) <= rules.SESSION_TASKS
    assert max(map(len, hands)) - min(map(len, hands)) <= 1


@given(st.integers(0, 50), st.integers(0, 2**40))
def test_houses_are_mixed_in_every_hand(participant: int, seed: int):
    tasks = [fakes.task(number) for number in range(60)]
    hand = sessions.assign_tasks(tasks, seed, participant)
    homes = Counter(tasks[number].house for number in hand)
    assert set(homes) == set(fakes.HOUSES)
    assert max(homes.values()) <= 4


def test_more_people_cycle_through_the_tasks_in_other_orders():
    tasks = [fakes.task(number) for number in range(60)]
    hands = [sessions.assign_tasks(tasks, 0, participant) for participant in range(18)]
    assert set(Counter(number for hand in hands for number in hand).values()) == {3}
    assert len({tuple(hand) for hand in hands}) == 18
    assert {frozenset(hand) for hand in hands[:6]} != {frozenset(hand) for hand in hands[6:12]}


def test_the_agent_has_no_say():
    one, other = (fakes.run_of(60, name=name, absent=name == "silent")[1] for name in ("helper", "silent"))
    for here, there in zip(one, other, strict=True):
        assert [trial.task.id for trial in here.trials] == [trial.task.id for trial in there.trials]
        assert here.number == there.number


def test_no_robot_is_no_robot():
    plan, dealt = fakes.run_of(20, absent=True)
    assert plan.seats == ()
    assert [robot.agent.name for robot in plan.robots] == ["helper"]
    assert all(trial.robots == () for one in dealt for trial in one.trials)


@pytest.mark.parametrize("people", [1, 2, 6, 7, 13])
def test_the_plan_knows_how_many_trials_there_are(people: int):
    from hthor.eval.config import run_config

    suite, who = fakes.suite(57), fakes.crew("helper")
    plan = run_config.build_config(suite, who, humans="proxy", seed=3, participants=people)
    dealt = sessions.make_sessions(suite, agent=who, seed=3, participants=people)
    assert plan.trials == sum(len(one.trials) for one in dealt)
    assert plan.participants == len(dealt) == people


def test_seeds_deal_differently():
    tasks = [fakes.task(number) for number in range(60)]
    assert sessions.assign_tasks(tasks, 0, 0) != sessions.assign_tasks(tasks, 1, 0)
