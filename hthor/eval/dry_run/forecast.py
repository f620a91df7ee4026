"""What a command would do, found out without doing it: its runs, how far each is, and how long they would take."""

import math
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from msgspec import Struct

from hthor import rules
from hthor.eval.config.run_config import RunConfig
from hthor.eval.dry_run import trial_cost
from hthor.eval.records import trial_log
from hthor.eval.runner.run_job import ScheduledRun
from hthor.eval.runner.run_options import ResolvedRuns, RunOptions
from hthor.guest import Isolation

SCHEMA = "hthor.dry-run/2"


class RunForecast(Struct, frozen=True, kw_only=True):
    """A run that would be run.

    Attributes:
        played: how many of its ``trials`` are there already.
        control: whether nobody asked for it: it would be another run's baseline.
        seconds: how long the others would take; None where that is unknown.
        pace: what a trial takes, and how that is known.
    """

    name: str
    folder: str
    trials: int
    played: int
    control: bool
    seconds: float | None
    pace: trial_cost.TrialCost | None
    plan: RunConfig


class Setting(Struct, frozen=True, kw_only=True):
    """An option's value as it would be used, and its origin: a flag, an environment variable or the default."""

    name: str
    value: Any
    origin: str


class Forecast(Struct, frozen=True, kw_only=True):
    """All that would be done, and how submitted agents would be isolated."""

    schema: str = SCHEMA
    settings: tuple[Setting, ...]
    isolation: Isolation | None
    runs: tuple[RunForecast, ...]
    trials: int
    played: int
    seconds: float | None


def make_forecast(
    options: RunOptions, resolved: ResolvedRuns, origins: Mapping[str, str], say: Callable[[str], None] | None = None
) -> Forecast:
    """Forecast what some options would do.

    Args:
        resolved: what the options stand for.
        origins: the origin of each option's value, by the option's name.
        say: prints a line. If given, a few trials are run for robots without a finished run, to measure what one
            takes; they are not kept.
    """
    workers = options.jobs or len(os.sched_getaffinity(0))
    sampler = trial_cost.CostSampler(options, say) if say is not None else None
    worlds = len({(one.house, tuple((it.id, it.kind) for it in one.objects)) for one in resolved.tasks.suite.tasks})
    runs = [
        *(_run_forecast(run, workers, worlds, sampler, control=True) for run in resolved.baselines),
        *(_run_forecast(run, workers, worlds, sampler, control=False) for run in resolved.runs),
    ]
    seconds = [run.seconds for run in runs]
    return Forecast(
        settings=tuple(_settings(options, resolved, workers, origins)),
        isolation=resolved.isolation,
        runs=tuple(runs),
        trials=sum(run.trials for run in runs),
        played=sum(run.played for run in runs),
        seconds=None if None in seconds else round(sum(filter(None, seconds)), 1),
    )


def _run_forecast(
    run: ScheduledRun, workers: int, houses: int, sampler: trial_cost.CostSampler | None, *, control: bool
) -> RunForecast:
    trials = run.config.expected_trials
    played = len({record.key for _, record in trial_log.read(run.folder.log_file)})
    left = trials - played
    cost = trial_cost.measured_cost(run)
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


def _settings(
    options: RunOptions, resolved: ResolvedRuns, workers: int, origins: Mapping[str, str]
) -> Iterator[Setting]:
    """Every option with what its default stands for."""
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
        "jobs": workers,
        "out": [str(run.folder) for run in resolved.runs],
    }
    for name, origin in origins.items():
        value = values.get(name, getattr(options, name, None))
        yield Setting(name=name, value=value, origin=origin)
