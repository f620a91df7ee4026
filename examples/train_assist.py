"""Trains a robot that helps a person, with MaskablePPO of sb3-contrib, and compares it with random actions.

    pip install 'hthor[learn,sb3]'
    python examples/train_assist.py

The robot knows the house and where objects are, as the agent `oracle` does; what it has to learn is to go there and to
tell the person. It learns on the suite `navigation` and is tested with other people on the searches of the suite
`smoke`. Both policies meet the same people with the same tasks. docs/gymnasium.md shows what this prints.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from statistics import NormalDist
from typing import Any

import gymnasium
import numpy as np
from sb3_contrib import MaskablePPO

import hthor.envs  # noqa: F401 - makes gymnasium.make know the environments

Policy = Callable[[Any, Any], int]
"""Chooses an action from an observation and the mask of legal actions."""
SETTING: dict[str, Any] = {
    "kinds": ["object_goal_navigation"],
    "privileges": ["ideal_detector", "object_poses", "house_map"],
    "time_cost": 1.0,
    "approach": 0.1,
}
TEST_STUDY = 1_000_000
"""The seed of the first study of the test; the training has the one of ``--seed``."""


def main() -> None:
    """Train, test and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--decisions", type=int, default=200_000, help="of the training (%(default)s)")
    parser.add_argument("--episodes", type=int, default=200, help="of each test (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the training (%(default)s)")
    parser.add_argument("--save", default="", help="where to write the policy")
    given = parser.parse_args()
    model = train(given.decisions, given.seed)
    if given.save:
        model.save(given.save)
    random = np.random.default_rng(given.seed)
    learned = play(lambda seen, mask: int(model.predict(seen, action_masks=mask)[0]), given.episodes)
    chance = play(lambda _, mask: int(random.choice(np.flatnonzero(mask))), given.episodes)
    for name, found in (("learned", learned), ("random", chance)):
        print(f"{name}: {success(found)}; return {mean(found[:, 1])}; seconds {mean(found[:, 2])}")
    more = learned - chance
    print(f"learned - random: success {mean(more[:, 0])}; return {mean(more[:, 1])}; seconds {mean(more[:, 2])}")


def train(decisions: int, seed: int) -> MaskablePPO:
    """A policy that was trained for so many decisions."""
    env = gymnasium.make("hthor/Assist-v0", suite="navigation", **SETTING)
    model = MaskablePPO(
        "MlpPolicy", env, n_steps=4096, batch_size=256, gamma=0.995, ent_coef=0.01, seed=seed, device="cpu", verbose=1
    )
    model.learn(decisions)
    env.close()
    return model


def play(policy: Policy, episodes: int) -> np.ndarray:
    """Success, return and time [s] of each episode, (N, 3); the same tasks and people for every policy."""
    env = gymnasium.make("hthor/Assist-v0", suite="smoke", **SETTING)
    rows = []
    for episode in range(episodes):
        seen, info = env.reset(seed=TEST_STUDY + episode)
        total, over = 0.0, False
        while not over:
            seen, reward, terminated, truncated, info = env.step(policy(seen, info["action_mask"]))
            total, over = total + float(reward), terminated or truncated
        rows.append((float(info["success"]), total, info["tick"] / 10.0))
    env.close()
    return np.array(rows)


def mean(values: np.ndarray) -> str:
    """The mean with its 95 % interval, by the normal approximation."""
    half = NormalDist().inv_cdf(0.975) * values.std(ddof=1) / math.sqrt(len(values))
    return f"{values.mean():.2f} ({values.mean() - half:.2f} to {values.mean() + half:.2f})"


def success(found: np.ndarray) -> str:
    """The share of episodes that succeeded, with its 95 % interval by Wilson's method."""
    share, count, z = found[:, 0].mean(), len(found), NormalDist().inv_cdf(0.975)
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count)) / (1 + z * z / count)
    return f"success {100 * share:.0f} % ({100 * (middle - half):.0f} to {100 * (middle + half):.0f}) of {count}"


if __name__ == "__main__":
    main()
