"""What one whole trial costs in CPU time: frontier robot and proxy over `smoke`, nothing rendered.

Run as ``python -m benchmarks.trial``. The bare ``mj_step`` floor is taken in the same run and the same houses, so that
the two can be compared on a noisy machine: 900 ticks of physics with nothing awake, in one call a tick.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Iterator

import mujoco
from tqdm import tqdm

from hthor import plugins, rules, tasks
from hthor.episode import EpisodeLog, play
from hthor.eval import cast
from hthor.eval.session import sessions
from hthor.world import World


def main() -> None:
    """Play, time and print."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--agent", default="frontier", choices=plugins.names("agent"))
    options.add_argument("--suite", default="smoke")
    options.add_argument("--trials", type=int, default=60)
    given = options.parse_args()
    costs = list(tqdm(_trials(given.agent, given.suite, given.trials), total=given.trials, disable=None, leave=False))
    print(f"{given.agent} and proxy, suite {given.suite}, {len(costs)} trials, CPU time of this process")
    print(f"{'':24}{'median':>10}{'p90':>10}{'max':>10}")
    _row("whole trial as played", [cpu for cpu, _, _ in costs], "ms")
    _row("scaled to 90 s", [cpu * 900 / log.ticks for cpu, log, _ in costs], "ms")
    _row("times real time", [log.ticks * rules.TICK_S * 1000 / cpu for cpu, log, _ in costs], "x")
    worlds = {world.house.id: world for _, _, world in costs}
    for house, world in sorted(worlds.items()):
        print(f"bare mj_step floor, 90 s in {house}: {floor(world):.1f} ms")


def _trials(agent: str, suite: str, count: int) -> Iterator[tuple[float, EpisodeLog, World]]:
    """Play the first ``count`` trials of the suite; the very first twice, so that compiling is not counted."""
    stage = cast.Stage()
    hands = sessions(tasks.suite(suite), agent=agent)
    trials = [(session, trial) for session in hands for trial in session.trials][:count]
    with stage.enter(hands[0]) as company:
        first = trials[0][1]
        play(first, stage.world(first), company.human, company.robots())
    for session in hands:
        with stage.enter(session) as company:
            for _, trial in (pair for pair in trials if pair[0] is session):
                world = stage.world(trial)
                begin = time.process_time()
                log = play(trial, world, company.human, company.robots())
                yield (time.process_time() - begin) * 1000, log, world


def floor(world: World, ticks: int = 900, repeats: int = 5) -> float:
    """CPU time [ms] of bare physics over ``ticks`` ticks, everything asleep; median of ``repeats``."""
    model, data = world.model, mujoco.MjData(world.model)
    steps = round(rules.TICK_S / model.opt.timestep)
    costs = []
    for _ in range(repeats):
        mujoco.mj_resetData(model, data)
        begin = time.process_time()
        for _ in range(ticks):
            mujoco.mj_step(model, data, steps)
        costs.append((time.process_time() - begin) * 1000)
    return statistics.median(costs)


def _row(name: str, values: list[float], unit: str) -> None:
    tenths = statistics.quantiles(values, n=10)
    print(f"{name:24}{statistics.median(values):>8.0f} {unit}{tenths[8]:>7.0f} {unit}{max(values):>7.0f} {unit}")


if __name__ == "__main__":
    main()
