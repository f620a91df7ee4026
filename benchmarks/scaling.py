"""One process and two: how many trials a second, and what a trial costs in each."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from benchmarks.scenes import hands
from benchmarks.table import Clock, Row
from hthor.episode import play
from hthor.trials import TrialRunner

AGENT = "frontier"


def rows(suite: str, trials: int) -> Iterator[Row]:
    """Trials a second of wall time, and CPU time a trial: one worker, and two that play as many trials each."""
    rates, costs = {}, {}
    for workers in (1, 2):
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            list(pool.map(_play, [(suite, 1)] * workers))
            begin = time.perf_counter()
            spent = list(pool.map(_play, [(suite, trials)] * workers))
            rates[workers] = workers * trials / (time.perf_counter() - begin)
            costs[workers] = sum(spent) / (workers * trials)
    cores = f"wall time on {os.cpu_count()} cores, worlds built before"
    yield Row(part="processes", what="one process", value=rates[1], unit="trials/s", remark=cores)
    yield Row(part="processes", what="two processes", value=rates[2], unit="trials/s", remark=cores)
    yield Row(part="processes", what="two / one, trials a second", value=rates[2] / rates[1], unit="x")
    yield Row(part="processes", what="two / one, CPU time a trial", value=costs[2] / costs[1], unit="x")


_STAGES: dict[str, TrialRunner] = {}


def _play(order: tuple[str, int]) -> float:
    """Play the first trials of the suite; CPU time [ms] without building worlds."""
    suite, count = order
    stage, spent = _STAGES.setdefault(suite, TrialRunner()), 0.0
    trials = [(session, trial) for session in hands(suite, AGENT) for trial in session.trials]
    for session in dict.fromkeys(id(session) for session, _ in trials):
        mine = [pair for pair in trials[: max(count, 1)] if id(pair[0]) == session]
        if not mine:
            break
        with stage.enter(mine[0][0]) as company:
            for _, trial in mine:
                world = stage.world(trial)
                clock = Clock()
                play(trial, world, company.humans, company.ready_agents())
                spent += clock()
    return spent
