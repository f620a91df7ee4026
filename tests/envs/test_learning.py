"""The environments of Gymnasium: their contracts, seeds, ends, pickles and processes."""

from __future__ import annotations

import functools
import math
import pickle
import subprocess
import sys
import warnings
from typing import Any

import numpy as np
import pytest
from learning_tasks import ALL_KNOWN, HOUSE, few, follow_the_way

from hthor.errors import HthorError, UnknownName
from hthor.tasks.suite import Suite

gymnasium = pytest.importorskip("gymnasium", reason="needs the extra learn")

from hthor.envs import AssistEnv, ObjectNavEnv  # noqa: E402
from hthor.episode import play  # noqa: E402

ACTIONS = 10_000
SEARCH = "navigation"


def rollout(env: Any, decisions: int = 40, seed: int = 1) -> list[Any]:
    """Everything that an environment returns for a seed and random actions."""
    random = np.random.default_rng(seed)
    seen, info = env.reset(seed=seed)
    found: list[Any] = [(seen, info)]
    for _ in range(decisions):
        step = env.step(int(random.integers(env.action_space.n)))
        found.append(step)
        if step[2] or step[3]:
            found.append(env.reset())
    return found


def same(some: Any, others: Any) -> bool:
    """Whether two results are the same, bit by bit."""
    if isinstance(some, dict):
        return some.keys() == others.keys() and all(same(some[key], others[key]) for key in some)
    if isinstance(some, (list, tuple)):
        return len(some) == len(others) and all(map(same, some, others))
    if isinstance(some, np.ndarray):
        return some.dtype == others.dtype and some.shape == others.shape and some.tobytes() == others.tobytes()
    return bool(some == others)


@pytest.mark.parametrize("made", [AssistEnv, ObjectNavEnv])
@pytest.mark.parametrize("observation", ["state", "rgbd"])
def test_gymnasium_accepts_them(made: Any, observation: str) -> None:
    from gymnasium.utils.env_checker import check_env

    env = made(few(SEARCH), observation=observation)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # an environment that was not made by its id has no spec
        check_env(env, skip_render_check=True)


@pytest.mark.parametrize("observation", ["state", "rgbd"])
def test_stable_baselines_accepts_them(observation: str) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="needs the extra sb3")
    checker.check_env(AssistEnv(few(), observation=observation))
    checker.check_env(ObjectNavEnv(few(SEARCH), observation=observation))


@pytest.mark.parametrize("id", ["hthor/Assist-v0", "hthor.envs:hthor/ObjectNav-v0"])
def test_they_are_made_by_their_ids(id: str) -> None:
    env = gymnasium.make(id, suite=few(SEARCH), render_mode="rgb_array")
    rollout(env, 5)
    picture = env.render()
    assert (picture.ndim, picture.dtype) == (3, np.uint8)
    env.close()


@pytest.mark.parametrize(
    "make",
    [
        functools.partial(AssistEnv, few()),
        functools.partial(AssistEnv, few(), robot="tender", privileges=ALL_KNOWN, time_cost=1.0, approach=0.1),
        functools.partial(ObjectNavEnv, few(SEARCH)),
    ],
)
def test_random_legal_and_illegal_actions_do_no_harm(make: Any) -> None:
    env, random = make(), np.random.default_rng(0)
    wrong = (math.nan, -1, 10_000, None, "forward", 0.5, np.array([math.inf]))
    _, info = env.reset(seed=0)
    counts = dict.fromkeys(("legal", "illegal", "wrong", "refused", "terminated", "truncated"), 0)
    for count in range(ACTIONS // 3 + 1):
        number: Any = int(random.integers(env.action_space.n))
        if count % 10 == 0:
            number, sort = wrong[count // 10 % len(wrong)], "wrong"
        else:
            sort = "legal" if info["action_mask"][number] else "illegal"
        seen, reward, terminated, truncated, info = env.step(number)
        counts[sort] += 1
        counts["refused"] += bool(info["refused"])
        assert sort != "wrong" or info["refused"]
        assert env.observation_space.contains(seen)
        assert math.isfinite(reward)
        assert reward == math.fsum(info["reward_terms"].values())
        assert not (terminated and truncated)
        assert (env.action_masks() == info["action_mask"]).all()
        if terminated or truncated:
            counts["terminated" if terminated else "truncated"] += 1
            _, info = env.reset()
    assert min(counts["legal"], counts["wrong"], counts["refused"], counts["truncated"]) > 0, counts


@pytest.mark.parametrize("observation", ["state", "rgbd"])
def test_the_same_seed_and_actions_give_the_same_bytes(observation: str) -> None:
    first = rollout(AssistEnv(few(), observation=observation), 60)
    env = AssistEnv(few(), observation=observation)
    rollout(env, 10, seed=2)
    assert same(rollout(env, 60), first)
    assert not same(rollout(env, 60, seed=3), first)


def test_a_seed_is_a_study_and_every_episode_has_its_next_participant() -> None:
    env = AssistEnv(few())
    env.reset(seed=7)
    first = [env.trial]
    for _ in range(2):
        env.reset()
        first.append(env.trial)
    assert [(trial.seed, trial.session, trial.humans[0].participant) for trial in first] == [
        (7, number, number) for number in range(3)
    ]
    _, info = env.reset(seed=7)
    assert env.trial == first[0]
    assert (info["study"], info["participant"], info["task"]) == (7, 0, first[0].task.id)


def test_a_reset_without_a_seed_draws_a_study() -> None:
    env, other = AssistEnv(few()), AssistEnv(few())
    assert env.reset()[1]["study"] != other.reset()[1]["study"]


def test_a_reset_may_choose_the_task() -> None:
    suite = few()
    env = AssistEnv(suite)
    for task in suite.tasks:
        _, info = env.reset(seed=0, options={"task": task.id})
        assert (info["task"], info["instruction"]) == (task.id, task.instruction)
    for wrong in ("smoke/none", 3, {}):
        with pytest.raises(UnknownName, match="unknown task"):
            env.reset(options={"task": wrong})
    with pytest.raises(HthorError, match="options must be a dict"):
        env.reset(options="task")


def test_several_people_and_a_detector_that_errs() -> None:
    env = AssistEnv(few(), humans="proxy,proxy", detector="miss=0.3,false_alarm=0.3")
    rollout(env, 60)
    assert [seat.participant for seat in env.trial.humans] == [2 * env.trial.session, 2 * env.trial.session + 1]
    rollout(ObjectNavEnv(few(SEARCH), detector="miss=0.3,false_alarm=0.3"), 60)


def test_a_trial_is_that_of_the_batch() -> None:
    """Its log is the one of `play` with an agent of the same policy."""
    from test_decision_trial import Policy

    env = AssistEnv(few(seconds=30.0), privileges=ALL_KNOWN)
    seen, info = env.reset(seed=4)
    over = False
    while not over:
        action = follow_the_way(seen, info["action_mask"], env.actions)
        seen, _, terminated, truncated, info = env.step(action)
        over = terminated or truncated
    log, source, trial = env.log(), env._source, env.trial
    assert (log.met, log.ticks) == (info["success"], info["tick"])
    assert play(trial, source._runner.world(trial), source._runner.make_people(trial), {"robot": Policy()}) == log


def test_a_goal_that_is_met_terminates_and_time_truncates() -> None:
    env = ObjectNavEnv(few(SEARCH, 60.0), privileges=ALL_KNOWN, time_cost=0.5)
    seen, info = env.reset(seed=0)
    rewards, over = [], False
    while not over:
        action = follow_the_way(seen, info["action_mask"], env.actions)
        seen, reward, terminated, truncated, info = env.step(action)
        rewards.append(reward)
        over = terminated or truncated
    assert (terminated, truncated, info["success"]) == (True, False, True)
    assert info["reward_terms"]["goal"] == 1.0
    assert math.fsum(rewards) == pytest.approx(1.0 - 0.5 * info["tick"] / 600.0)
    env.reset(seed=0)
    steps = [env.step(0) for _ in range(60)]
    assert [step[2:4] for step in steps] == [*[(False, False)] * 59, (False, True)]
    with pytest.raises(gymnasium.error.ResetNeeded, match="the episode is over"):
        env.step(0)


def test_a_step_needs_a_reset() -> None:
    for call in (lambda env: env.step(0), lambda env: env.action_masks(), lambda env: env.log()):
        with pytest.raises(gymnasium.error.ResetNeeded):
            call(AssistEnv(few()))
    env = AssistEnv(few())
    env.reset(seed=0)
    env.close()
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(0)
    env.reset(seed=0)


def test_objects_behind_doors_are_left_out_for_robots_that_open_nothing() -> None:
    from hthor import tasks

    own = tuple(task for task in tasks.load_suite(SEARCH).tasks if task.house == HOUSE)
    counts = [len(ObjectNavEnv(houses=[HOUSE], robot=robot)._source.tasks) for robot in ("scout", "tender")]
    assert 0 < counts[0] < counts[1] == len(own)


def test_the_person_of_a_search_stands_aside() -> None:
    env = ObjectNavEnv(few(SEARCH))
    env.reset(seed=0)
    episode = env._running().episode
    before = episode.world.pose("human")
    for number in range(20):
        env.step(number % env.action_space.n)
    assert episode.world.pose("human") == before
    assert env.trial.humans[0].model == "bystander"


def test_pictures_are_those_of_the_robots_camera() -> None:
    env = AssistEnv(few(), observation="rgbd")
    seen, _ = env.reset(seed=0)
    now = env._running().episode.observe("robot")
    assert (seen["rgbd"][..., :3] == now.rgb).all()
    assert np.abs(seen["rgbd"][..., 3] / 25.5 - np.minimum(now.depth, 10.0)).max() <= 0.5 / 25.5 + 1e-6
    assert seen["rgbd"].shape == (64, 64, 4)


def test_environments_are_pickled_as_they_were_made() -> None:
    cloudpickle = pytest.importorskip("cloudpickle")
    env = AssistEnv(few(), robot="tender", time_cost=0.3)
    first = rollout(env, 20)
    for copy in (pickle.loads(pickle.dumps(env)), cloudpickle.loads(cloudpickle.dumps(lambda: env))()):
        assert copy.actions == env.actions
        with pytest.raises(gymnasium.error.ResetNeeded):
            copy.step(0)
        assert same(rollout(copy, 20), first)


def test_processes_that_are_spawned_play_the_same() -> None:
    suite = few()
    make = functools.partial(gymnasium.make, "hthor.envs:hthor/Assist-v0", suite=suite)
    alone = AssistEnv(suite)
    expected = [alone.reset(seed=3)[0], alone.step(1)[0], alone.step(3)[0]]
    envs = gymnasium.vector.AsyncVectorEnv([make, make], context="spawn")
    try:
        seen, info = envs.reset(seed=[3, 4])
        assert info["study"].tolist() == [3, 4]
        found = [seen[0].copy(), *(envs.step(np.array([number, 0]))[0][0].copy() for number in (1, 3))]
    finally:
        envs.close()
    assert same(found, expected)


def test_wrong_names_are_errors() -> None:
    for wrong, message in (
        ({"observation": "rgb"}, "unknown observation 'rgb'"),
        ({"robot": "scoot"}, "unknown robot 'scoot'"),
        ({"humans": "nobody"}, "nobody"),
        ({"houses": ["moon"]}, "unknown house 'moon'"),
        ({"houses": HOUSE}, "name each house in a list"),
        ({"kinds": ["object_goal"]}, "unknown task kind 'object_goal'"),
        ({"privileges": ["all"]}, "unknown privilege 'all'"),
        ({"suite": Suite(name="none", version=1, sha256="", tasks=())}, "has no such task"),
        ({"time_cost": math.nan}, "time_cost must be a finite number of units of reward, got nan"),
        ({"time_cost": -1.0}, "time_cost must be at least 0 units of reward, got -1.0"),
        ({"approach": "1"}, "approach must be a finite number of units of reward per metre, got '1'"),
    ):
        with pytest.raises(HthorError, match=message):
            AssistEnv(**{"suite": few(), **wrong})


def test_a_trial_in_decisions_needs_neither_pettingzoo_nor_torch() -> None:
    code = (
        "import sys, hthor.envs, hthor.envs.decision_trial, hthor.envs.trial_source\n"
        "print([name for name in ('pettingzoo', 'torch') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("imports", ["gymnasium, hthor.envs", "hthor.envs, gymnasium", "gymnasium"])
def test_gymnasium_knows_them_whatever_was_imported_first(imports: str) -> None:
    code = f"import {imports}; import gymnasium as g; print(g.make('hthor.envs:hthor/Assist-v0').spec.id)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "hthor/Assist-v0"


@pytest.mark.parametrize("module", ["gymnasium", "pettingzoo"])
def test_without_the_extra_one_sentence_names_it(module: str) -> None:
    code = (
        "import importlib.util as u; find = u.find_spec\n"
        f"u.find_spec = lambda name, *a: None if name == '{module}' else find(name, *a)\n"
        "import hthor.envs\nhthor.envs.AssistEnv"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "needs an optional dependency: pip install 'hthor[learn]'." in done.stderr.splitlines()[-1]


def test_tasks_with_several_jobs_have_actions_for_each() -> None:
    env = AssistEnv(few("collect", count=1), robot="tender")
    assert [name for name in env.actions if name[:4] in ("tell", "take")] == [
        *(f"tell {number}" for number in (1, 2, 3)),
        *(f"take {number}" for number in (1, 2, 3)),
    ]
    rollout(env, 30)


def test_a_suite_is_kept_as_it_is() -> None:
    suite = few()
    env = AssistEnv(suite)
    assert env._source.tasks == suite.tasks
    env.reset(seed=0)
    assert env.trial.suite_sha256 == suite.sha256
