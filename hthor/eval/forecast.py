"""What a command would do, found out without doing it: runs, how far each is, and a time; writes nothing."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor.errors import RunError
from hthor.eval import log, result_file, setup
from hthor.eval.intent import RUNS, Intent, Options, Part
from hthor.eval.setup import Setup
from hthor.guest import Isolation

SCHEMA = "hthor.dry-run/1"


class Pace(Struct, frozen=True, kw_only=True):
    """What a trial took in a finished run like this one: CPU time [s], and that run's folder."""

    cpu_s: float
    folder: str


class Ahead(Struct, frozen=True, kw_only=True):
    """A run that would be played: ``played`` of its ``trials`` are there already; ``seconds`` for the rest of them.

    ``seconds`` is None where no finished run tells what a trial takes.
    """

    name: str
    folder: str
    trials: int
    played: int
    control: bool
    seconds: float | None
    pace: Pace | None
    plan: Setup


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
    runs: tuple[Ahead, ...]
    trials: int
    played: int
    seconds: float | None


def of(options: Options, intent: Intent, origins: Mapping[str, str]) -> Forecast:
    """Look ahead.

    Args:
        intent: what the options stand for. origins: where each option's value is from, by its name.
    """
    workers = options.jobs or len(os.sched_getaffinity(0))
    runs = [
        *(_ahead(part, workers, control=True) for part in intent.controls),
        *(_ahead(part, workers, control=False) for part in intent.parts),
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


def _ahead(part: Part, workers: int, *, control: bool) -> Ahead:
    plan = part.plan
    trials = plan.shard.trials if plan.shard else plan.trials
    played = len({record.key for _, record in log.read(part.folder / "trials.jsonl")})
    pace = _pace(part)
    busy = max(1, min(workers, math.ceil((trials - played) / 10)))  # a session's ten trials are played by one worker
    seconds = 0.0 if played >= trials else None if pace is None else round((trials - played) * pace.cpu_s / busy, 1)
    return Ahead(
        name=part.title,
        folder=str(part.folder),
        trials=trials,
        played=played,
        control=control,
        seconds=seconds,
        pace=pace,
        plan=plan,
    )


def _pace(part: Part) -> Pace | None:
    """Of the first finished run with the same robots and people that lies about, of the same suite if there is one."""
    found = []
    for folder in _candidates(part.folder):
        try:
            plan, result = setup.load(folder), result_file.load(folder)
        except RunError:
            continue
        if result is None or result.effort is None or not result.effort.trials:
            continue
        if _minds(plan) == _minds(part.plan) and plan.humans.name == part.plan.humans.name:
            pace = Pace(cpu_s=round(result.effort.cpu_s / result.effort.trials, 4), folder=str(folder))
            found.append((plan.suite != part.plan.suite, pace))
    return min(found, key=lambda one: one[0])[1] if found else None


def _minds(plan: Setup) -> list[tuple[str, str]]:
    return [(robot.robot, robot.agent.name) for robot in plan.seats]


def _candidates(folder: Path) -> Iterator[Path]:
    """Folders of runs here and beside, and where runs usually are."""
    roots = (folder, folder.parent, RUNS)
    found = [path for root in roots for path in (root, *sorted(root.glob("*")), *sorted(root.glob("*/control")))]
    yield from (path for path in dict.fromkeys(found) if (path / "result.json").is_file())


def _settings(options: Options, intent: Intent, workers: int, origins: Mapping[str, str]) -> Iterator[Setting]:
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
