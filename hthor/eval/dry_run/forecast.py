"""What a command would do, found out without doing it: runs, how far each is, and a time; writes nothing."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from msgspec import Struct

from hthor.eval.config.run_config import RunConfig
from hthor.eval.dry_run import trial_cost
from hthor.eval.records import trial_log
from hthor.eval.runner.run_options import ResolvedRuns, RunJob, RunOptions
from hthor.guest import Isolation

SCHEMA = "hthor.dry-run/2"


class RunForecast(Struct, frozen=True, kw_only=True):
    """A run that would be played: ``played`` of its ``trials`` are there already; ``seconds`` for the rest of them.

    ``pace`` is what a trial takes, and how that is known; ``seconds`` is None where nothing tells.
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
    """An option's value as it would be used, and whether a flag, an environment variable or a default gave it."""

    name: str
    value: Any
    origin: str


class Forecast(Struct, frozen=True, kw_only=True):
    """All that would be done, and on which level agents of the user's own would be held."""

    schema: str = SCHEMA
    settings: tuple[Setting, ...]
    isolation: Isolation | None
    runs: tuple[RunForecast, ...]
    trials: int
    played: int
    seconds: float | None


def make_forecast(
    options: RunOptions, intent: ResolvedRuns, origins: Mapping[str, str], say: Callable[[str], None] | None = None
) -> Forecast:
    """Look ahead.

    Args:
        intent: what the options stand for. origins: where each option's value is from, by its name.
        say: is told what is tried out. Where it is given, a few trials are played for runs like which none was played
            before, to see what one takes; they are kept nowhere.
    """
    workers = options.jobs or len(os.sched_getaffinity(0))
    sampler = trial_cost.CostSampler(options, intent, say) if say is not None else None
    worlds = len({(one.house, tuple((it.id, it.kind) for it in one.objects)) for one in intent.chosen.suite.tasks})
    runs = [
        *(_run_forecast(part, workers, worlds, sampler, control=True) for part in intent.controls),
        *(_run_forecast(part, workers, worlds, sampler, control=False) for part in intent.parts),
    ]
    left = [one.seconds for one in runs]
    return Forecast(
        settings=tuple(_settings(options, intent, workers, origins)),
        isolation=intent.held,
        runs=tuple(runs),
        trials=sum(one.trials for one in runs),
        played=sum(one.played for one in runs),
        seconds=None if None in left else round(sum(filter(None, left)), 1),
    )


def _run_forecast(
    part: RunJob, workers: int, houses: int, sampler: trial_cost.CostSampler | None, *, control: bool
) -> RunForecast:
    plan = part.plan
    trials = plan.shard.trials if plan.shard else plan.trials
    played = len({record.key for _, record in trial_log.read(part.folder / "trials.jsonl")})
    left = trials - played
    known = trial_cost.measured_cost(part)
    if known is None and left and sampler is not None:
        known = sampler.play(part)
    busy = max(1, min(workers, math.ceil(left / 10)))  # a session's ten trials are played by one worker
    seconds = 0.0 if not left else None if known is None else known.seconds(left, workers=busy, houses=houses)
    return RunForecast(
        name=part.title,
        folder=str(part.folder),
        trials=trials,
        played=played,
        control=control,
        seconds=seconds,
        pace=known,
        plan=plan,
    )


def _settings(options: RunOptions, intent: ResolvedRuns, workers: int, origins: Mapping[str, str]) -> Iterator[Setting]:
    """Every option with what its default stands for."""
    plans = [part.plan for part in intent.parts]
    first = plans[0]
    resolved: dict[str, Any] = {
        "agent": sorted({robot.agent.name for plan in plans for robot in plan.robots}),
        "humans": list(dict.fromkeys(plan.humans.name for plan in plans)),
        "suite": first.suite.name,
        "kind": first.kind.name if first.kind else "all of the suite",
        "robot": [robot.robot for robot in first.seats],
        "assets": first.assets.name,
        "participants": first.participants,
        "jobs": workers,
        "out": [str(part.folder) for part in intent.parts],
    }
    for name, origin in origins.items():
        value = resolved.get(name, getattr(options, name, None))
        yield Setting(name=name, value=value, origin=origin)
