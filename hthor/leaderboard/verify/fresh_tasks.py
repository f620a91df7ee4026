"""Runs an entry's agent on tasks drawn after its submission, by the same recipe as the entry's suite.

The people are those of the entry: the same population, drawn with the same seed.
"""

import functools
import hashlib
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hthor import jsonio, tasks
from hthor.eval.config import task_selection
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.metrics.metric import DIGITS
from hthor.eval.runner.session_runner import make_runner
from hthor.eval.statistics import intervals
from hthor.eval.task_check import solvability
from hthor.leaderboard.entries import entry_metrics, files, trial_outcomes
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import BoardError
from hthor.leaderboard.entries.verification import Fresh
from hthor.leaderboard.verify import performance_drop, replay
from hthor.leaderboard.verify.replay import Request
from hthor.tasks.generation import fresh_tasks, secret_suites
from hthor.tasks.suite import encode_suite
from hthor.tasks.suites.commitment import Salt
from hthor.trials import human_team, sessions
from hthor.types import TaskSpec

_HOUSE_TASKS = 10
"""Tasks in each fresh house of an official suite."""


def verify_fresh_tasks(entry: Entry, board: Path, request: Request) -> Fresh:
    """Draw tasks, let the agent play them, and compare the results with the entry.

    Raises:
        BoardError: if the suite's specification is not known, or a trial could not be played.
    """
    with tempfile.TemporaryDirectory() as folder:
        _draw(entry, board, request, Path(folder))
        chosen = task_selection.select_tasks(folder, "")
        team, humans = replay.robot_team_of(entry, request), human_team.find_team(entry.run.humans.source)
        clock = {name: value for name, value in replay.session_options(entry).items() if name != "participants"}
        whole = sessions.make_sessions(chosen.suite, agent=team, humans=humans, **clock)
        sources = replay.make_sources_of(folder, team, humans, request)
        played = replay.run_sessions(entry, whole, functools.partial(make_runner, sources), request.jobs)
    records = sorted((one for one, _ in played), key=lambda one: (one.spec.session, one.spec.index))
    owners = [one.spec.session for one in records]
    values = {name: trial_metrics.column((one.metrics for one in records), name) for name in ("sr", "twsr")}
    return judge_fresh_tasks(entry, chosen.suite.sha256, values, owners)


def judge_fresh_tasks(entry: Entry, digest: str, values: dict[str, np.ndarray], owners: Sequence[int]) -> Fresh:
    """The verdict on success and time-weighted success at fresh tasks; ``owners`` has the person of each trial."""
    held = trial_outcomes.unpack(entry.trials)
    participants = entry_metrics.trial_participants(entry.trials.count, entry.run.participants)
    claimed = {name: entry_metrics.metric_values(held, name, alone=entry.alone) for name in values}
    falls = {
        name: performance_drop.measure_drop(claimed[name], participants, row, owners) for name, row in values.items()
    }
    seen = performance_drop.detectable_drop(claimed["sr"], participants, len(owners))
    fell = any(one.seen for one in falls.values())
    told = "; ".join(
        f"{title} of {_percent(claimed[name])} was claimed, {_percent(values[name])} came out (p = {falls[name].p:.2g})"
        for name, title in (("sr", "success"), ("twsr", registry.get("twsr").title))
    )
    power = "no fall of success would" if seen is None else f"a fall of success by {100 * seen:.0f} points would"
    return Fresh(
        suite=digest,
        n=len(owners),
        **{name: _estimate(row, owners) for name, row in values.items()},
        claimed_sr=round(float(claimed["sr"].mean()), DIGITS),
        claimed_twsr=round(float(claimed["twsr"].mean()), DIGITS),
        fell=fell,
        detectable=seen,
        why=f"{told}; {power} have shown in four of five such draws",
    )


def _draw(entry: Entry, board: Path, request: Request, folder: Path) -> None:
    """Write a suite of fresh tasks to a folder."""
    name, count = entry.run.suite.name, request.fresh
    lot = hashlib.sha256(f"hthor fresh\n{request.word}\n{entry.digest}\n".encode()).hexdigest()
    if name in tasks.suite_names():
        drawn = fresh_tasks.make_fresh_suite(
            name, int(lot[:30], 16), count, functools.partial(_possible, jobs=request.jobs)
        )
        jsonio.write(folder / secret_suites.SUITE, encode_suite(drawn))
        return
    season = files.read_commitments(board).get(entry.run.suite.sha256)
    if season is None:
        raise BoardError(
            f"{entry.id}: run.suite.sha256: fresh tasks cannot be drawn for this suite, since its specification "
            "is not known."
        )
    from hthor.world.validation.house_soundness import check_soundness

    homes = max(1, min(season.houses, count // _HOUSE_TASKS))
    order = secret_suites.SuiteOrder(name=f"fresh-{lot[:10]}", houses=homes, tasks=count)
    judges = secret_suites.Proof(
        house=check_soundness, task=lambda task, house: not solvability.check_task(task, house).faults
    )
    for path, data in secret_suites.make_files(order, Salt(lot), judges).items():
        jsonio.write(folder / path, data)


def _possible(drafts: Sequence[TaskSpec], jobs: int | None) -> list[bool]:
    """Whether each task can be done, by the same check as 'hthor tasks check'."""
    found = {
        one.task: not one.faults for one in solvability.check_tasks(drafts, jobs=jobs or len(os.sched_getaffinity(0)))
    }
    return [found[task.id] for task in drafts]


def _percent(row: np.ndarray) -> str:
    return f"{100 * float(row.mean()):.1f} %"


def _estimate(row: np.ndarray, owners: Sequence[int]) -> intervals.Estimate:
    values = row.tolist()
    return intervals.estimate(values, [str(place) for place in range(len(values))], owners, within=intervals.SHARE)
