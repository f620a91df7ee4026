"""Whole trials: minds, senses and physics, nothing rendered."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Iterator

from benchmarks.scenes import TICKS, hands
from benchmarks.table import Clock, Row
from hthor.episode import play
from hthor.eval import cast

AGENTS = {"silent": "no robot that does anything", "frontier": "frontier robot", "oracle": "oracle robot"}
BAR_MS = 90.0


def rows(suite: str, each: int) -> Iterator[Row]:
    """For each robot the CPU time of 90 s with the proxy: the median over scenes of the median over trials.

    Trials end early when the goal is met, so costs are scaled by the share of 90 s that was played.

    Args:
        each: trials a scene, at least; sessions are played whole, since people learn.
    """
    for agent, title in AGENTS.items():
        costs = cost(suite, agent, each)
        medians = {scene: statistics.median(values) for scene, values in sorted(costs.items())}
        middle = statistics.median(medians.values())
        worst = max(medians, key=lambda scene: medians[scene])
        count = sum(len(values) for values in costs.values())
        bar = BAR_MS if agent == "frontier" else None
        remark = f"{count} trials in {len(costs)} scenes; dearest {worst}, {medians[worst]:.0f} ms"
        yield Row(part="trials", what=f"{title} and proxy, 90 s", value=middle, unit="ms", bar=bar, remark=remark)
        if bar is not None:
            faster = 90000.0 / middle
            yield Row(part="trials", what="the same, times real time", value=faster, unit="x", bar=1000, at_least=True)


def cost(suite: str, agent: str, each: int) -> dict[str, list[float]]:
    """Scene -> CPU times [ms] of its trials, scaled to 90 s; the very first trial is played twice, to compile."""
    stage, costs = cast.Stage(), defaultdict(list)
    sessions = hands(suite, agent)
    with stage.enter(sessions[0]) as company:
        first = sessions[0].trials[0]
        play(first, stage.world(first), company.human, company.robots())
    wanted = {trial.task.house for session in sessions for trial in session.trials}
    for session in sessions:
        with stage.enter(session) as company:
            for trial in session.trials:
                world = stage.world(trial)
                robots = company.robots()
                clock = Clock()
                log = play(trial, world, company.human, robots)
                costs[trial.task.house].append(clock() * TICKS / log.ticks)
        if all(len(costs[scene]) >= each for scene in wanted):
            break
    return dict(costs)
