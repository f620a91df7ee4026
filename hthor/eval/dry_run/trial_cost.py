"""What a trial of a run takes on this machine: of a finished run like it, or of a few trials that are played for it."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import RunError
from hthor.eval.config import run_config
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import run_isolation
from hthor.eval.results import result_file
from hthor.eval.runner import engines, experiment
from hthor.eval.runner.messages import Failed, SessionAbandoned, SessionRestarted, TrialDone
from hthor.eval.runner.run_options import RUNS, ResolvedRuns, RunJob, RunOptions

_TRIALS = 3
"""Trials that are played: one that also loads what is heavy, one that also builds a house, and that one again."""
_BUDGET_S, _LIMIT_S = 30.0, 120.0
"""After so long no third trial is begun, and no trial may take longer [s].

A second always is: the first may have compiled for most of its time, which the others of a run do not.
"""


class TrialCost(Struct, frozen=True, kw_only=True):
    """What a trial takes one worker [s]; where that was not averaged over a run, what a start and a house take, too.

    ``folder`` is the finished run that tells; where it is empty, ``played`` trials were played to see.
    """

    trial_s: float
    start_s: float = 0.0
    house_s: float = 0.0
    folder: str = ""
    played: int = 0

    def seconds(self, trials: int, *, workers: int, houses: int) -> float:
        """How long so many trials take, in so many houses that every worker builds for itself."""
        mine = math.ceil(trials / workers)
        return round(self.start_s + mine * self.trial_s + min(mine, houses) * self.house_s, 1)


def measured_cost(part: RunJob) -> TrialCost | None:
    """Of the first finished run with the same robots and people that lies about, of the same suite if there is one."""
    found = []
    for folder in _run_folders_near(part.folder):
        try:
            plan, result = run_config.load_config(folder), result_file.load_result(folder)
        except RunError:
            continue
        if result is None or result.effort is None or not result.effort.trials:
            continue
        if _robots_of(plan) == _robots_of(part.plan) and plan.humans.name == part.plan.humans.name:
            known = TrialCost(trial_s=round(result.effort.cpu_s / result.effort.trials, 4), folder=str(folder))
            found.append((plan.suite != part.plan.suite, known))
    return min(found, key=lambda one: one[0])[1] if found else None


class CostSampler:
    """Plays a few trials to see what they take, once for equal robots; writes nothing.

    Args:
        say: is told what is played.
    """

    def __init__(self, options: RunOptions, intent: ResolvedRuns, say: Callable[[str], None]) -> None:
        self._options, self._intent, self._say = options, intent, say
        self._known: dict[object, TrialCost | None] = {}

    def play(self, part: RunJob) -> TrialCost | None:
        """What a trial of this run takes; None when none was over in time, or an agent could not be loaded."""
        same = (tuple(_robots_of(part.plan)), part.people.model)
        if same not in self._known:
            self._say(f"{part.title}: {_TRIALS} trials are played to see what they take")
            with tempfile.TemporaryDirectory() as folder:
                self._known[same] = _cost_of(self._played(part, Path(folder)))
        return self._known[same]

    def _played(self, part: RunJob, folder: Path) -> list[float]:
        """When each trial was over, in seconds after the start."""
        options, chosen = self._options, self._intent.chosen
        own = experiment.own_houses(options)
        for name, data in own.items():
            (folder / name).write_bytes(data)
        held = run_isolation.isolation_of(self._intent.held, part.crew.minds.values())
        make = experiment.runner_factory(options, chosen, part, held, houses=folder if own else None)
        first = experiment.run_sessions_of(options, chosen, part)[0]
        some = msgspec.structs.replace(first, trials=(*first.trials[:2], *first.trials[1:2]))
        engine = engines.find_engine(engines.LOCAL, jobs=1, limit_s=_LIMIT_S)
        began, over = time.monotonic(), []
        with closing(engine.perform([some], make)) as stream:
            for news in stream:
                now = time.monotonic() - began
                if isinstance(news, TrialDone):
                    over.append(now)
                if isinstance(news, (SessionRestarted, SessionAbandoned, Failed)) or _enough(over):
                    break
        return over


def _enough(over: list[float]) -> bool:
    return len(over) > 1 and over[-1] > _BUDGET_S


def _cost_of(over: list[float]) -> TrialCost | None:
    """From when trials were over; of a single one it cannot be told what of it was only the start."""
    if not over:
        return None
    takes = [end - begin for begin, end in zip([0.0, *over], over, strict=False)]
    start, both, trial = takes[0], takes[min(1, len(takes) - 1)], takes[-1]
    return TrialCost(
        trial_s=round(trial, 4),
        start_s=round(max(0.0, start - both), 4),
        house_s=round(max(0.0, both - trial), 4),
        played=len(over),
    )


def _robots_of(plan: RunConfig) -> list[tuple[str, str]]:
    return [(robot.robot, robot.agent.name) for robot in plan.seats]


def _run_folders_near(folder: Path) -> Iterator[Path]:
    """Folders of runs here and beside, and where runs usually are."""
    roots = (folder, folder.parent, RUNS)
    found = [path for root in roots for path in (root, *sorted(root.glob("*")), *sorted(root.glob("*/control")))]
    yield from (path for path in dict.fromkeys(found) if (path / "result.json").is_file())
