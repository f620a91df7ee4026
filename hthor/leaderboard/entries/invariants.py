"""Rules that an entry must satisfy beyond its schema: every number must follow from the outcomes of its trials.

Each rule yields problems as pairs of a field and a description, so that all of them can be listed.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec
import numpy as np

from hthor import code_identity, rules
from hthor.eval.metrics.definitions import success
from hthor.eval.metrics.metric import DIGITS
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import File
from hthor.leaderboard.entries import entry_metrics, overrides, trial_outcomes
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.trial_outcomes import Outcomes, task_labels
from hthor.trials.sessions import sessions_needed
from hthor.types import TaskSpec

Problems = Iterator[tuple[str, str]]
_NEAR = 2e-6
"""Numbers have six decimals; the last decimal may differ from machine to machine."""
_MILLION = 1_000_000


def check_hashes(entry: Entry, held: Outcomes) -> Problems:
    """Check that the hashes agree with the contents."""
    if (now := entry.run.sha256) != entry.hashes.run:
        yield "hashes.run", f"is {entry.hashes.run[:10]}, but the hash of 'run' is {now[:10]}"
    if not entry.id.endswith(f"-{entry.hashes.run[:10]}"):
        yield "id", f"does not end in the first ten digits of hashes.run, '{entry.hashes.run[:10]}'"
    if (now := held.merkle) != entry.hashes.merkle:
        yield "hashes.merkle", f"is {entry.hashes.merkle[:10]}, but the root of what 'trials' holds is {now[:10]}"
    measured, now = entry.trials.metrics_sha256, trial_outcomes.metrics_sha256()
    if entry.scoring_sha256 and not measured:
        yield "scoring_sha256", "is there, but 'trials' does not say by which metrics it was measured"
    if entry.scoring_sha256 == code_identity.scoring_sha256() and measured and measured != now:
        yield "scoring_sha256", f"is the present one, but 'trials' was measured by other metrics, {measured[:10]}"


def check_sizes(entry: Entry, held: Outcomes) -> Problems:
    """Check that the run is complete, with every task once, and that the counts agree with the trials."""
    trials, counts = entry.trials.count, entry.counts
    for field, value in (
        ("run.trials", entry.run.trials),
        ("counts.trials", counts.trials),
        ("metrics.sr.n", entry.metrics.sr.n),
    ):
        if value != trials:
            yield field, f"is {value}, but 'trials' holds {trials}"
    if entry.run.participants != sessions_needed(trials):
        yield (
            "run.participants",
            f"is {entry.run.participants}; {trials} tasks done once take {sessions_needed(trials)}",
        )
    for field, value, there in (
        ("counts.successes", counts.successes, int(held.met.sum())),
        ("counts.messages", counts.messages, int(held.sent.sum())),
        ("counts.faults", counts.faults, int(held.faulty.sum())),
    ):
        if value != there:
            yield field, f"says {value}, but 'trials' has {there}"
    if sum(counts.faults_by_kind.values()) < counts.faults:
        yield "counts.faults_by_kind", f"adds up to {sum(counts.faults_by_kind.values())}, less than {counts.faults}"


def check_outcomes(entry: Entry, held: Outcomes, tasks: Sequence[TaskSpec] = ()) -> Problems:
    """Check that each trial's outcomes are consistent: no time-weighted success without success, and so on.

    Args:
        tasks: the task of each trial, if the suite is known; then time, T* and labels are checked too.
    """
    for field, wrong, problem in (
        ("trials.twsr", ~held.met & (held.twsr > 0), "not met, but time-weighted success above 0"),
        ("trials.twsr", held.met & (held.twsr == 0), "met, but time-weighted success 0"),
        ("trials.adopted", held.adopted != (held.accepted > 0), "'adopted' does not go with how many were accepted"),
        ("trials.accepted", held.accepted > held.sent, "more messages accepted than sent"),
        ("trials.useful", held.useful > held.accepted, "more messages useful than accepted"),
    ):
        yield from _first(field, wrong, problem)
    if entry.alone:
        loud = held.adopted | (held.sent > 0) | (held.trust > 0)
        yield from _first("trials", loud, "messages or trust, but there is no robot")
    if len(tasks) == len(held.met):
        yield from _of_tasks(held, tasks)


def _of_tasks(held: Outcomes, tasks: Sequence[TaskSpec]) -> Problems:
    """Check times, time-weighted success and labels against the tasks."""
    limits = np.array([round(task.time_limit / rules.TICK_S) for task in tasks])
    yield from _first("trials.time", held.time > limits, "longer than the time limit")
    yield from _first("trials.time", ~held.met & (held.time != limits), "not met, but not until the time limit")
    good = np.array([task.t_star for task in tasks])
    spent = np.round(held.time * rules.TICK_S, DIGITS)
    twsr = np.round(_MILLION * np.round(success.time_weighted(held.met, good, spent), DIGITS))
    off = held.met & (np.abs(held.twsr - twsr) > 1)
    yield from _first("trials.twsr", off, "not what T* and the time spent give")
    for name, (names, codes) in task_labels(tasks).items():
        there_names, there = held.labels.get(name, ((), np.zeros(0, dtype=np.int64)))
        said = np.array([*there_names, ""])[there] if len(there) == len(codes) else np.full(len(codes), "")
        yield from _first(
            f"trials.labels.{name}", said != np.array(names)[codes], "not what the suite says of the task"
        )


def _first(field: str, wrong: np.ndarray, problem: str) -> Problems:
    """The index of the first trial with the problem, and how many trials have it."""
    places = np.flatnonzero(wrong)
    if len(places):
        yield field, f"{problem}: in {len(places)} trials, the first is trial {int(places[0])}"


def check_settings(entry: Entry) -> Problems:
    """Check that all settings are the benchmark's, and that references are hthor's own agents."""
    for name, value in overrides.overridden_settings(entry.run).items():
        yield "run", f"{name} is {value}, and such runs are not ranked"
    ours = all(robot.agent.source.startswith("hthor.agents.") for robot in entry.run.robots)
    if entry.reference != ours:
        yield "reference", f"is {entry.reference}, but the agents are {'' if ours else 'not '}hthor's own"
    if not ours and entry.isolation is None:
        yield "isolation", "is absent, but a submitted agent is always held at some level"


def check_agents(entry: Entry) -> Problems:
    """Check that agents consist of the files that the run started with, and that all of these were submitted."""
    for place, (known, listed) in enumerate(zip(entry.run.agents, entry.agents, strict=False)):
        if not set(known.files) <= set(listed.files) or known.sha256 != listed.sha256:
            yield f"agents[{place}]", f"lacks files of run.agents[{place}], or has others"
    if len(entry.agents) != len(entry.run.agents):
        yield "agents", f"has {len(entry.agents)} agents, but 'run' has {len(entry.run.agents)}"
    if entry.submission:
        for place, one in enumerate(entry.agents):
            for words in foreign_files(one.files, entry.files):
                yield f"agents[{place}].files", f"is not what 'files' says was handed in: {words}"


def foreign_files(files: Sequence[File], handed_in: Sequence[File]) -> list[str]:
    """Files of an agent that were not submitted, or that differ from the submitted ones, in words."""
    there = {file.path: file.sha256 for file in handed_in}
    return [
        f"{file.path} is not there" if file.path not in there else f"{file.path} is another file"
        for file in files
        if there.get(file.path) != file.sha256
    ]


def check_metrics(entry: Entry, held: Outcomes) -> Problems:
    """Check that means are within their intervals, and that metrics recomputed from the trials are the same."""
    for field, one in entry_estimates(entry):
        if one.mean is not None and one.ci95 is not None and not one.ci95[0] <= one.mean <= one.ci95[1]:
            yield field, f"the mean {one.mean} is not inside the interval {one.ci95[0]} to {one.ci95[1]}"
        if one.n > entry.trials.count:
            yield f"{field}.n", f"is {one.n}, more than the {entry.trials.count} trials"
    if entry.run.participants != sessions_needed(entry.trials.count):
        return  # the participant of each trial is not known
    participants = entry_metrics.trial_participants(entry.trials.count, entry.run.participants)
    for metric, fresh in entry_metrics.entry_scores(held, participants, alone=entry.alone).items():
        yield from differences(f"metrics.{metric}", getattr(entry.metrics, metric), fresh)
    yield from differences("splits", entry.splits, entry_metrics.split_scores(held, participants))


def check_uplift(entry: Entry, held: Outcomes, control: Entry | None, without: Outcomes | None) -> Problems:
    """Check that the uplift is over people without a robot at the same tasks, and is the same when recomputed."""
    if entry.alone or entry.uplift is None:
        if entry.alone != (entry.uplift is None):
            yield "uplift", "is absent" if entry.uplift is None else "is there, but there is no robot"
        return
    if control is None or without is None:
        named = entry.uplift.control[:10]
        yield "uplift.control", f"is {named}, and no entry without a robot on the same suite and people has that run"
        return
    if control.trials.count == entry.trials.count:
        yield from differences("uplift", entry.uplift, entry_metrics.entry_uplift(entry, held, control, without))


def entry_estimates(entry: Entry) -> Iterator[tuple[str, Estimate]]:
    """Every estimate in an entry, with its field."""
    for name in entry.metrics.__struct_fields__:
        yield f"metrics.{name}", getattr(entry.metrics, name)


def differences(field: str, there: Any, here: Any) -> Problems:
    """Where two documents differ by more than rounding."""
    yield from _unlike(field, msgspec.to_builtins(there), msgspec.to_builtins(here))


def _unlike(field: str, there: Any, here: Any) -> Problems:
    if isinstance(there, dict) and isinstance(here, dict):
        for name in sorted({*there, *here}):
            if name in there and name in here:
                yield from _unlike(f"{field}.{name}", there[name], here[name])
            else:
                yield f"{field}.{name}", "is missing" if name in here else "has no trial"
    elif isinstance(there, (list, tuple)) and isinstance(here, (list, tuple)) and len(there) == len(here):
        for place, (one, other) in enumerate(zip(there, here, strict=True)):
            yield from _unlike(f"{field}[{place}]", one, other)
    elif not _near(there, here):
        yield field, f"is {there}, but the trials give {here}"


def _near(there: Any, here: Any) -> bool:
    if isinstance(there, float) or isinstance(here, float):
        if there is None or here is None:
            return False
        return math.isclose(there, here, rel_tol=1e-4, abs_tol=_NEAR)
    return bool(there == here)
