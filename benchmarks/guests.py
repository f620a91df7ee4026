"""What it costs that an agent runs in another process: a step, a start, and whole trials beside the same agent inside.

Wall time, since two processes take turns.
"""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.scenes import hands
from benchmarks.table import Row
from hthor.episode import play
from hthor.guest import Guest
from hthor.guest.process_tools import resource_usage
from hthor.trials import Sources, TrialRunner, robot_team
from hthor.trials.sessions import Session
from hthor.types import BodySpec, Briefing, Observation, Pose

STATE_BAR_US, PICTURE_BAR_US, SHARE_BAR = 60.0, 100.0, 15.0
_STATE = """
from hthor.types import Action

class Agent:
    def begin(self, briefing):
        pass

    def act(self, observation):
        return Action()
"""
_PICTURES = _STATE.replace("return", "observation.rgb[0, 0], observation.depth[0, 0]\n        return")
_SAME = "from hthor.agents.frontier import Agent as Frontier\n\n\nclass Agent(Frontier):\n    persistent = {}\n"
_BRIEFING = Briefing(
    seat="robot",
    instruction="Find an apple.",
    target="apple",
    destination="",
    relation="find",
    body=BodySpec(
        name="disc",
        title="disc",
        radius=0.2,
        height=1.0,
        eye=0.9,
        fov=(1.2, 1.2),
        speed=1.0,
        turn_rate=1.8,
        sight_range=1.5,
        scan_range=5.0,
        scan_beams=61,
        pitch_limit=0.5,
        capabilities=frozenset({"navigate"}),
    ),
    tick_s=0.1,
    time_limit=90.0,
)


class Prepared:
    """Pictures that cost nothing to take, so that only their way to the agent counts."""

    def __init__(self) -> None:
        noise = np.random.default_rng(0)
        self._rgb = noise.integers(0, 256, (128, 128, 3), dtype=np.uint8)
        self._depth = noise.random((128, 128), dtype=np.float32)

    def rgb(self) -> Any:
        return self._rgb

    def depth(self) -> Any:
        return self._depth


def rows(suite: str, steps: int, sessions: int) -> Iterator[Row]:
    """Steps, starts and trials.

    Args:
        steps: how many are timed. sessions: people whose trials are played twice, in turn with the agent inside.
    """
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        yield from _steps(home, steps)
        for persistent in (False, True):
            yield from _trials(home, suite, sessions, persistent)


def _steps(home: Path, steps: int) -> Iterator[Row]:
    for name, body, what, bar in (
        ("state", _STATE, "a guest's step, state alone", STATE_BAR_US),
        ("pictures", _PICTURES, "a guest's step with colours and depth, 128 x 128", PICTURE_BAR_US),
    ):
        path = home / f"{name}.py"
        path.write_text(body)
        begin = time.perf_counter()
        with Guest(path) as mind:
            level = mind.load().isolation.level
            start = time.perf_counter() - begin
            mind.begin(_BRIEFING)
            took = _timed(mind, steps)
            again = []
            for _ in range(10):
                begin = time.perf_counter()
                mind.begin(_BRIEFING)
                again.append(time.perf_counter() - begin)
                mind.act(_look(0))
        spread = np.quantile(took, (0.25, 0.75)) * 1e6
        remark = f"at {level}; {steps} steps, quartiles {spread[0]:.0f} and {spread[1]:.0f}"
        yield Row(part="guests", what=what, value=statistics.median(took) * 1e6, unit="us", bar=bar, remark=remark)
        if name == "state":
            yield Row(part="guests", what="a guest's start", value=start * 1e3, unit="ms", remark=f"at {level}")
            value = statistics.median(again) * 1e3
            yield Row(part="guests", what="a guest's next trial", value=value, unit="ms", remark="median of 10")


def _look(tick: int, senses: Any = None) -> Observation:
    return Observation(tick=tick, pose=Pose(x=0.1, y=0.2, yaw=0.3), idle=True, senses=senses or Prepared())


def _timed(mind: Guest, steps: int) -> list[float]:
    senses, took = Prepared(), []
    for tick in range(steps):
        look = _look(tick, senses)
        begin = time.perf_counter()
        mind.act(look)
        took.append(time.perf_counter() - begin)
    return took[steps // 10 :]


def _trials(home: Path, suite: str, count: int, persistent: bool) -> Iterator[Row]:
    """The frontier robot as a file of somebody's, beside the built-in one: the same trials, each of them in turn.

    Args:
        persistent: whether it keeps its process from trial to trial.
    """
    path = home / f"frontier_{'kept' if persistent else 'anew'}.py"
    path.write_text(_SAME.format(persistent))
    guest = robot_team.load_agent_info(str(path))
    inside, outside = (
        TrialRunner(),
        TrialRunner(Sources(agent_paths={"robot": guest.path})),
    )
    ours, theirs = hands(suite, "frontier"), hands(suite, robot_team.form_team(["scout"], [guest]))
    took: list[tuple[Spent, Spent]] = []
    for number in range(count + 1):  # the first session compiles
        pair = list(_together((inside, ours[number]), (outside, theirs[number])))
        took += pair if number else []
    kept = " that keeps its process" if persistent else ""
    what = f"a trial of the frontier robot as a guest{kept}: more than inside"
    for kind, name, bar in ((0, "wall", None if persistent else SHARE_BAR), (1, "CPU of all processes", None)):
        before = 1000.0 * sum(one[kind] for one, _ in took) / len(took)
        after = 1000.0 * sum(other[kind] for _, other in took) / len(took)
        remark = f"{name}; {len(took)} trials: {before:.0f} ms inside, {after:.0f} ms as a guest"
        yield Row(part="guests", what=what, value=(after / before - 1.0) * 100.0, unit="%", bar=bar, remark=remark)


Spent = tuple[float, float]
"""Wall time and CPU time [s]."""


def _together(one: tuple[TrialRunner, Session], other: tuple[TrialRunner, Session]) -> Iterator[tuple[Spent, Spent]]:
    """What two sessions' trials take, each trial of one followed by the same of the other."""
    with one[0].enter(one[1]) as mine, other[0].enter(other[1]) as yours:
        for first, second in zip(one[1].trials, other[1].trials, strict=True):
            took: list[Spent] = []
            ticks = set()
            for stage, company, trial in ((one[0], mine, first), (other[0], yours, second)):
                world, robots = stage.world(trial), company.ready_agents()
                spent, begin = resource_usage.cpu_s(os.getpid()), time.perf_counter()
                ticks.add(play(trial, world, company.humans, robots).ticks)
                company.finish_trial()
                wall = time.perf_counter() - begin
                time.sleep(0.05)  # so that a guest's end is counted too
                took.append((wall, resource_usage.cpu_s(os.getpid()) - spent))
            if len(ticks) > 1:
                raise AssertionError(f"the guest did not play the same trial: {sorted(ticks)} ticks")
            yield took[0], took[1]
