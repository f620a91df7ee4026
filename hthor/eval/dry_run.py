"""`hthor eval --dry-run`: the runs of a command, how far each one is, and how long they would take.

The time of a trial is taken from a similar finished run, or measured on a few trials.
"""

import math
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import jsonio, rules
from hthor.errors import RunError
from hthor.eval.comparison import sample_size
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import result_file
from hthor.eval.runner import engines
from hthor.eval.runner.messages import Failed, SessionAbandoned, SessionRestarted, TrialDone
from hthor.eval.runner.run_job import RUNS, ResolvedRuns, ScheduledRun
from hthor.guest import Isolation

SCHEMA = "hthor.dry-run/2"
_TRIALS = 3
"""Trials that are measured: one that also loads libraries, one that also builds a house, and the latter again."""
_BUDGET_S, _LIMIT_S = 30.0, 120.0
"""Time [s] after which no third trial is begun, and the longest time [s] of a trial. Our choice.

A second trial is always run: compiling may have taken most of the first one, which happens once per run.
"""


class TrialCost(Struct, frozen=True, kw_only=True):
    """Time [s] that a worker takes for a trial and, unless it is an average over a run, for its start and a house.

    ``folder`` is the finished run that the cost is from; if empty, it was measured on ``played`` trials.
    """

    trial_s: float
    start_s: float = 0.0
    house_s: float = 0.0
    folder: str = ""
    played: int = 0

    def seconds(self, trials: int, *, workers: int, houses: int) -> float:
        """Time [s] of ``trials`` trials in so many houses, each of which every worker builds for itself."""
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
    """Measures the time of a few trials, once for equal robots, and announces it; writes nothing."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._costs: dict[object, TrialCost | None] = {}

    def measure(self, run: ScheduledRun) -> TrialCost | None:
        """The cost of a trial of this run; None when no trial ended in time, or an agent could not be loaded."""
        same = (tuple(_robots_of(run.config)), run.people.models)
        if same not in self._costs:
            self._say(f"{run.title}: {_TRIALS} trials are played to see what they take")
            with tempfile.TemporaryDirectory() as folder:
                self._costs[same] = _cost_of(self._end_times(run, Path(folder)))
        return self._costs[same]

    def _end_times(self, run: ScheduledRun, folder: Path) -> list[float]:
        """The time [s] from the start to the end of each trial."""
        if run.sources.houses:
            for name, data in run.files.items():
                jsonio.write(folder / name, data)
            sources = msgspec.structs.replace(run.sources, houses=str(folder / "houses"))
            run = msgspec.structs.replace(run, sources=sources)
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
    """The cost from the times at which trials ended; a single trial cannot be separated from the start."""
    if not ends:
        return None
    durations = [end - begin for begin, end in pairwise([0.0, *ends])]
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
    """Finished runs in this folder, next to it, and in the usual folder of runs."""
    roots = (folder, folder.parent, RUNS)
    paths = [path for root in roots for path in (root, *sorted(root.glob("*")), *sorted(root.glob("*/control")))]
    yield from (run for run in map(RunFolder, dict.fromkeys(paths)) if run.result_file.is_file())


class RunForecast(Struct, frozen=True, kw_only=True):
    """A run that a command would play.

    Attributes:
        played: how many of its ``trials`` exist already.
        control: whether it would be played only as another run's baseline.
        seconds: how long the missing trials would take; None if unknown.
        pace: the time of a trial, and its origin.
    """

    name: str
    folder: str
    trials: int
    played: int
    control: bool
    seconds: float | None
    pace: TrialCost | None
    plan: RunConfig


class Setting(Struct, frozen=True, kw_only=True):
    """An option's value as it would be used, and its origin: a flag, an environment variable or the default."""

    name: str
    value: Any
    origin: str


class DesignForecast(Struct, frozen=True, kw_only=True):
    """The groups of a between-subjects study, and what that design costs.

    ``wider`` is about how many times as wide the intervals of differences are as if all conditions had the people of
    one group, for outcomes with the correlation that `hthor power` assumes when none was measured.
    """

    participants: int
    groups: dict[str, int]
    wider: float
    sentence: str


class Forecast(Struct, frozen=True, kw_only=True):
    """All runs that would be played, and how submitted agents would be isolated."""

    schema: str = SCHEMA
    settings: tuple[Setting, ...]
    isolation: Isolation | None
    runs: tuple[RunForecast, ...]
    trials: int
    played: int
    seconds: float | None
    design: DesignForecast | msgspec.UnsetType = msgspec.UNSET


def make_forecast(
    resolved: ResolvedRuns, origins: Mapping[str, str], say: Callable[[str], None] | None = None
) -> Forecast:
    """Forecast the runs that some options stand for.

    Args:
        origins: the origin of each option's value, by the option's name.
        say: prints a line. If given, a few trials are run for robots without a finished run, to measure the time of a
            trial; they are not kept.
    """
    workers = resolved.workers
    sampler = CostSampler(say) if say is not None else None
    worlds = len({(one.house, tuple((it.id, it.kind) for it in one.objects)) for one in resolved.tasks.suite.tasks})
    runs = [
        *(_run_forecast(run, workers, worlds, sampler, control=True) for run in resolved.baselines),
        *(_run_forecast(run, workers, worlds, sampler, control=False) for run in resolved.runs),
    ]
    seconds = [run.seconds for run in runs]
    return Forecast(
        settings=tuple(_settings(resolved, origins)),
        isolation=resolved.isolation,
        runs=tuple(runs),
        trials=sum(run.trials for run in runs),
        played=sum(run.played for run in runs),
        seconds=None if None in seconds else round(sum(filter(None, seconds)), 1),
        design=_design_forecast([run.config for run in resolved.runs]),
    )


def _design_forecast(configs: Sequence[RunConfig]) -> DesignForecast | msgspec.UnsetType:
    design, first = configs[0].design, configs[0].humans.name
    if not design:
        return msgspec.UNSET
    groups = {config.label: config.participants for config in configs if config.humans.name == first}
    wider = round(1.0 / math.sqrt(1.0 - sample_size.USUAL), 2)
    sizes = ", ".join(f"{label} {people}" for label, people in groups.items())
    return DesignForecast(
        participants=design.participants,
        groups=groups,
        wider=wider,
        sentence=(
            f"between subjects: {design.participants} people in groups ({sizes}). Intervals of differences are "
            f"about {wider:.1f} times as wide as if all robots met the people of one group (outcomes that correlate by "
            f"{sample_size.USUAL:g}; 'hthor power' tells how many people that takes)."
        ),
    )


def _run_forecast(
    run: ScheduledRun, workers: int, houses: int, sampler: CostSampler | None, *, control: bool
) -> RunForecast:
    trials = run.config.expected_trials
    given_up = run.folder.corrections.given_up
    played = sum(not one.log.voided or one.key in given_up for one in run.folder.played())
    left = trials - played
    cost = measured_cost(run)
    if cost is None and left and sampler is not None:
        cost = sampler.measure(run)
    busy = max(1, min(workers, math.ceil(left / rules.SESSION_TASKS)))  # one worker runs all trials of a session
    seconds = 0.0 if not left else None if cost is None else cost.seconds(left, workers=busy, houses=houses)
    return RunForecast(
        name=run.title,
        folder=str(run.folder),
        trials=trials,
        played=played,
        control=control,
        seconds=seconds,
        pace=cost,
        plan=run.config,
    )


def _settings(resolved: ResolvedRuns, origins: Mapping[str, str]) -> Iterator[Setting]:
    """Every option, with defaults resolved."""
    configs = [run.config for run in resolved.runs]
    first = configs[0]
    values: dict[str, Any] = {
        "agent": sorted({robot.agent.name for config in configs for robot in config.robots}),
        "humans": list(dict.fromkeys(config.humans.name for config in configs)),
        "suite": first.suite.name,
        "kind": first.kind.name if first.kind else "all of the suite",
        "robot": [robot.robot for robot in first.seats],
        "assets": first.assets.name,
        "participants": first.participants,
        "jobs": resolved.workers,
        "out": [str(run.folder) for run in resolved.runs],
    }
    for name, origin in origins.items():
        value = values.get(name, getattr(resolved.options, name))
        yield Setting(name=name, value=value, origin=origin)
