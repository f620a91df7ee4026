"""What a trial takes on this machine: from a finished run like it, or from a few trials that are run to measure it."""

import math
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import result_file
from hthor.eval.runner import engines, run_options
from hthor.eval.runner.messages import Failed, SessionAbandoned, SessionRestarted, TrialDone
from hthor.eval.runner.run_job import ScheduledRun
from hthor.eval.runner.run_options import RUNS, RunOptions

_TRIALS = 3
"""Trials that are run: one that also loads libraries, one that also builds a house, and that one again."""
_BUDGET_S, _LIMIT_S = 30.0, 120.0
"""After so long no third trial is begun, and no trial may take longer [s]. Our choice.

A second trial is always run: compiling may have taken most of the first one, which happens once per run.
"""


class TrialCost(Struct, frozen=True, kw_only=True):
    """What a trial takes one worker [s]; where that is no average over a run, also what a start and a house take.

    ``folder`` is the finished run that this is from; where it is empty, it was measured on ``played`` trials.
    """

    trial_s: float
    start_s: float = 0.0
    house_s: float = 0.0
    folder: str = ""
    played: int = 0

    def seconds(self, trials: int, *, workers: int, houses: int) -> float:
        """How long so many trials take, in so many houses, which every worker builds for itself."""
        own = math.ceil(trials / workers)
        return round(self.start_s + own * self.trial_s + min(own, houses) * self.house_s, 1)


def measured_cost(run: ScheduledRun) -> TrialCost | None:
    """The cost in a finished run with the same robots and humans, preferably on the same suite; None without one."""
    costs = []
    for folder in _run_folders_near(run.folder.path):
        try:
            config, result = folder.config, result_file.load_result(folder.path)
        except RunError:
            continue
        if result is None or result.effort is None or not result.effort.trials:
            continue
        if _robots_of(config) == _robots_of(run.config) and config.humans.name == run.config.humans.name:
            cost = TrialCost(trial_s=round(result.effort.cpu_s / result.effort.trials, 4), folder=str(folder))
            costs.append((config.suite != run.config.suite, cost))
    return min(costs, key=lambda pair: pair[0])[1] if costs else None


class CostSampler:
    """Runs a few trials to measure what they take, once for equal robots; writes nothing.

    Args:
        say: prints a line about what is run.
    """

    def __init__(self, options: RunOptions, say: Callable[[str], None]) -> None:
        self._options, self._say = options, say
        self._costs: dict[object, TrialCost | None] = {}

    def measure(self, run: ScheduledRun) -> TrialCost | None:
        """What a trial of this run takes; None when none was over in time, or an agent could not be loaded."""
        same = (tuple(_robots_of(run.config)), run.population.model)
        if same not in self._costs:
            self._say(f"{run.title}: {_TRIALS} trials are played to see what they take")
            with tempfile.TemporaryDirectory() as folder:
                self._costs[same] = _cost_of(self._end_times(run, Path(folder)))
        return self._costs[same]

    def _end_times(self, run: ScheduledRun, folder: Path) -> list[float]:
        """When each trial was over, in seconds after the start."""
        houses = run_options.own_houses(self._options)
        for name, data in houses.items():
            (folder / name).write_bytes(data)
        if houses:
            run = msgspec.structs.replace(run, sources=msgspec.structs.replace(run.sources, houses=str(folder)))
        first = run.sessions[0]
        session = msgspec.structs.replace(first, trials=(*first.trials[:2], *first.trials[1:2]))
        engine = engines.find_engine(engines.LOCAL, jobs=1, limit_s=_LIMIT_S)
        started, ends = time.monotonic(), []
        with closing(engine.run_sessions([session], run.make_runner)) as messages:
            for message in messages:
                now = time.monotonic() - started
                if isinstance(message, TrialDone):
                    ends.append(now)
                if isinstance(message, (SessionRestarted, SessionAbandoned, Failed)) or _enough(ends):
                    break
        return ends


def _enough(ends: list[float]) -> bool:
    return len(ends) > 1 and ends[-1] > _BUDGET_S


def _cost_of(ends: list[float]) -> TrialCost | None:
    """The cost from when trials were over; a single trial does not tell the start from the rest."""
    if not ends:
        return None
    durations = [end - begin for begin, end in zip([0.0, *ends], ends, strict=False)]
    start, both, trial = durations[0], durations[min(1, len(durations) - 1)], durations[-1]
    return TrialCost(
        trial_s=round(trial, 4),
        start_s=round(max(0.0, start - both), 4),
        house_s=round(max(0.0, both - trial), 4),
        played=len(ends),
    )


def _robots_of(config: RunConfig) -> list[tuple[str, str]]:
    return [(robot.robot, robot.agent.name) for robot in config.seats]


def _run_folders_near(folder: Path) -> Iterator[RunFolder]:
    """Finished runs here, beside, and where runs usually are."""
    roots = (folder, folder.parent, RUNS)
    paths = [path for root in roots for path in (root, *sorted(root.glob("*")), *sorted(root.glob("*/control")))]
    yield from (run for run in map(RunFolder, dict.fromkeys(paths)) if run.result_file.is_file())
