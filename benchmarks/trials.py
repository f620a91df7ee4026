"""Whole trials: minds, senses and physics, nothing rendered."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Iterator

from benchmarks.scenes import TICKS, hands
from benchmarks.table import Clock, Row
from hthor.episode import play
from hthor.trials import TrialRunner, robot_team
from hthor.trials.robot_team import RobotTeam

AGENTS = {"none": "no robot that does anything", "frontier": "frontier robot", "oracle": "oracle robot"}
BAR_MS = 90.0
CREWS = {
    "collect": "tall:oracle,small:oracle",
    "rearrange-record": "tender:oracle",
    "tidy": "tender:oracle",
    "carry": "porter:oracle",
}
"""The suites of the kinds with several jobs, and who works in them."""
CREW_BAR_MS = 180.0


def rows(suite: str, each: int) -> Iterator[Row]:
    """For each robot the CPU time of 90 s with the proxy: the median over scenes of the median over trials.

    Trials end early when the goal is met, so costs are scaled by the share of 90 s that was played.

    Args:
        each: trials a scene, at least; sessions are played whole, since people learn.
    """
    for agent, title in AGENTS.items():
        bar = BAR_MS if agent == "frontier" else None
        row = _row(f"{title} and proxy, 90 s", suite, agent, each, bar)
        yield row
        if bar is not None:
            faster = 90000.0 / row.value
            yield Row(part="trials", what="the same, times real time", value=faster, unit="x", bar=1000, at_least=True)
    for name, robots in CREWS.items():
        (crew,) = robot_team.parse_teams(robots, ())
        yield _row(f"{name}: {robots} and proxy, 90 s", name, crew, each, CREW_BAR_MS)


def _row(what: str, suite: str, agent: str | RobotTeam, each: int, bar: float | None) -> Row:
    costs = cost(suite, agent, each)
    medians = {scene: statistics.median(values) for scene, values in sorted(costs.items())}
    worst = max(medians, key=lambda scene: medians[scene])
    count = sum(len(values) for values in costs.values())
    remark = f"{count} trials in {len(costs)} scenes; dearest {worst}, {medians[worst]:.0f} ms"
    return Row(part="trials", what=what, value=statistics.median(medians.values()), unit="ms", bar=bar, remark=remark)


def cost(suite: str, agent: str | RobotTeam, each: int) -> dict[str, list[float]]:
    """Scene -> CPU times [ms] of its trials, scaled to 90 s; the very first trial is played twice, to compile."""
    stage, costs = TrialRunner(), defaultdict(list)
    sessions = hands(suite, agent)
    with stage.enter(sessions[0]) as company:
        first = sessions[0].trials[0]
        play(first, stage.world(first), company.humans, company.ready_agents())
    wanted = {trial.task.house for session in sessions for trial in session.trials}
    for session in sessions:
        with stage.enter(session) as company:
            for trial in session.trials:
                world = stage.world(trial)
                robots = company.ready_agents()
                clock = Clock()
                log = play(trial, world, company.humans, robots)
                costs[trial.task.house].append(clock() * TICKS / log.ticks)
        if all(len(costs[scene]) >= each for scene in wanted):
            break
    return dict(costs)
