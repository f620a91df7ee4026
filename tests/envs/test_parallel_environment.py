"""The environment of PettingZoo: its contract, and that busy robots go on."""

from __future__ import annotations

import pickle
import warnings
from typing import Any

import numpy as np
import pytest
from learning_tasks import few

pytest.importorskip("gymnasium", reason="needs the extra learn")
pytest.importorskip("pettingzoo", reason="needs the extra learn")

from gymnasium.error import ResetNeeded

from hthor.agents.skills.learner import LearnerView
from hthor.envs import AssistParallelEnv
from hthor.episode import play
from hthor.errors import HthorError
from hthor.types import Action, Briefing, Observation

SUITE = few("collect", count=2)


class Counting:
    """An agent whose decisions go through its actions in turn, by its own count."""

    def __init__(self, jobs: int) -> None:
        self.jobs, self.count = jobs, 0

    def begin(self, briefing: Briefing) -> None:
        self.view = LearnerView(briefing, self.jobs)

    def act(self, observation: Observation) -> Action:
        self.view.see(observation)
        if not observation.idle:
            return Action()
        self.count += 1
        return self.view.action(turn(self.count, len(self.view.names)))


def turn(count: int, actions: int) -> int:
    return (7 * count) % actions


def rollout(env: Any, steps: int = 40, seed: int = 0) -> list[Any]:
    random = np.random.default_rng(seed)
    found: list[Any] = [env.reset(seed=seed)]
    while len(found) < steps and env.agents:
        found.append(env.step({seat: int(random.integers(env.action_space(seat).n)) for seat in env.agents}))
    return found


def test_pettingzoo_accepts_it() -> None:
    from pettingzoo.test import parallel_api_test

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(AssistParallelEnv(SUITE), num_cycles=1000)


def test_the_agents_are_the_robots_seats() -> None:
    env = AssistParallelEnv(SUITE)
    assert (env.possible_agents, env.agents) == (["robot", "robot2"], [])
    assert "take 1" in env.actions["robot"]
    assert "take 1" not in env.actions["robot2"]
    with pytest.raises(ResetNeeded):
        env.step({})
    env.reset(seed=0)
    assert env.agents == env.possible_agents


def test_busy_robots_go_on_and_a_trial_is_that_of_the_batch() -> None:
    env = AssistParallelEnv(few("collect", 20.0, 1))
    _, infos = env.reset(seed=2)
    counts, busy = dict.fromkeys(env.agents, 0), 0
    while env.agents:
        actions = {}
        for seat in env.agents:
            free = infos[seat]["free"]
            busy += not free
            assert free or infos[seat]["action_mask"].tolist() == [1, *[0] * (len(env.actions[seat]) - 1)]
            counts[seat] += free
            actions[seat] = turn(counts[seat], len(env.actions[seat])) if free else 3
        _, rewards, terminated, truncated, infos = env.step(actions)
        assert len(set(rewards.values())) == 1
    assert busy
    assert set(truncated.values()) == {True}
    assert set(terminated.values()) == {False}
    trial, source = env.trial, env._source
    agents = {seat: Counting(source.jobs) for seat in env.possible_agents}
    log = env.log()
    assert play(trial, source._runner.world(trial), source._runner.make_people(trial), agents) == log


def test_the_same_seed_gives_the_same_bytes_after_a_pickle_too() -> None:
    env = AssistParallelEnv(SUITE, observation="rgbd")
    first = rollout(env)
    again = rollout(pickle.loads(pickle.dumps(env)))
    assert pickle.dumps(first) == pickle.dumps(again)
    env.close()
    assert env.agents == []


def test_actions_that_are_none_are_refused() -> None:
    env = AssistParallelEnv(SUITE)
    env.reset(seed=0)
    _, _, _, _, infos = env.step({"robot": None, "robot2": 99})
    assert all("an action is a whole number" in infos[seat]["refused"] for seat in ("robot", "robot2"))
    with pytest.raises(HthorError, match="actions must be a dict"):
        env.step([1, 2])
    with pytest.raises(HthorError, match="name at least one robot"):
        AssistParallelEnv(SUITE, robots=[])
