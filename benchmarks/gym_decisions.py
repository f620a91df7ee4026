"""Decisions per second of the environments of Gymnasium: `python -m benchmarks.gym_decisions`.

Random legal actions on one core, with whole episodes and their resets, after an episode that compiles and builds. The
world of the house is kept, as in a training in one house.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np

import hthor.envs  # noqa: F401 - makes gymnasium.make know the environments
from benchmarks import table
from hthor import code_identity

HOUSES = ("hazel", "elder", "maple")
SIGHTS = ("state", "rgbd")
IDS = ("hthor/Assist-v0", "hthor/ObjectNav-v0")


def rows(decisions: int = 3000) -> Iterator[table.Row]:
    """The median over some houses for each environment and observation."""
    for id in IDS:
        for sight in SIGHTS:
            found = {house: speed(id, sight, house, decisions) for house in HOUSES}
            slowest = min(found, key=lambda house: found[house])
            remark = f"{len(HOUSES)} houses; slowest {slowest}, {found[slowest]:,.0f}"
            what = f"{id}, {'state' if sight == 'state' else 'RGB-D 64x64'}"
            yield table.Row(
                part="learners", what=what, value=statistics.median(found.values()), unit="decisions/s", remark=remark
            )


def speed(id: str, sight: str, house: str, decisions: int) -> float:
    """Decisions per second of CPU time."""
    env = gymnasium.make(id, suite="smoke", houses=[house], observation=sight)
    play(env, 50)
    clock = table.Clock()
    play(env, decisions)
    milliseconds = clock()
    env.close()
    return decisions / milliseconds * 1000.0


def play(env: Any, decisions: int) -> None:
    """Random legal actions."""
    random = np.random.default_rng(0)
    _, info = env.reset(seed=0)
    for _ in range(decisions):
        _, _, terminated, truncated, info = env.step(int(random.choice(np.flatnonzero(info["action_mask"]))))
        if terminated or truncated:
            _, info = env.reset()


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--decisions", type=int, default=3000, help="in each house (%(default)s)")
    parser.add_argument("--json", action="store_true", help="JSON instead of a table")
    given = parser.parse_args()
    code_identity.keep_compiled()
    table.put(list(rows(given.decisions)), as_json=given.json)


if __name__ == "__main__":
    main()
