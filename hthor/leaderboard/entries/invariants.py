"""What must hold in an entry beyond its schema: every number follows from what it carries; reads no files.

Each law gives its problems as pairs of a field and what is wrong there, so that all of them can be listed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec
import numpy as np

from hthor import rules
from hthor.eval.config.sessions import participants_needed
from hthor.eval.metrics.definitions import success
from hthor.eval.metrics.metric import DIGITS
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import File
from hthor.leaderboard.entries import entry_metrics, overrides
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.trial_outcomes import Outcomes, labels
from hthor.types import TaskSpec

Found = Iterator[tuple[str, str]]
_NEAR = 2e-6
"""Numbers have six decimals; the last may differ from machine to machine."""
_MILLION = 1_000_000


def hashes(entry: Entry, held: Outcomes) -> Found:
    """The hashes are those of what they are of."""
    if (now := entry.run.sha256) != entry.hashes.run:
        yield "hashes.run", f"is {entry.hashes.run[:10]}, but the hash of 'run' is {now[:10]}"
    if not entry.id.endswith(f"-{entry.hashes.run[:10]}"):
        yield "id", f"does not end in the first ten digits of hashes.run, '{entry.hashes.run[:10]}'"
    if (now := held.merkle) != entry.hashes.merkle:
        yield "hashes.merkle", f"is {entry.hashes.merkle[:10]}, but the root of what 'trials' holds is {now[:10]}"


def sizes(entry: Entry, held: Outcomes) -> Found:
    """The run is whole, with every task once, and what failed is counted."""
    trials, counts = entry.trials.count, entry.counts
    for field, value in (
        ("run.trials", entry.run.trials),
        ("counts.trials", counts.trials),
        ("metrics.sr.n", entry.metrics.sr.n),
    ):
        if value != trials:
            yield field, f"is {value}, but 'trials' holds {trials}"
    if entry.run.participants != participants_needed(trials):
        yield (
            "run.participants",
            f"is {entry.run.participants}; {trials} tasks done once take {participants_needed(trials)}",
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


def outcomes(entry: Entry, held: Outcomes, tasks: Sequence[TaskSpec] = ()) -> Found:
    """What became of a trial can have become of it: no time-weighted success without success, and so on.

    Args:
        tasks: of each trial, where the suite is at hand; then time, T* and what sort of task it is are compared too.
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


def _of_tasks(held: Outcomes, tasks: Sequence[TaskSpec]) -> Found:
    """Times, time-weighted success and labels against the tasks themselves."""
    limits = np.array([round(task.time_limit / rules.TICK_S) for task in tasks])
    yield from _first("trials.time", held.time > limits, "longer than the time limit")
    yield from _first("trials.time", ~held.met & (held.time != limits), "not met, but not until the time limit")
    good = np.array([task.t_star for task in tasks])
    spent = np.round(held.time * rules.TICK_S, DIGITS)
    worth = np.round(_MILLION * np.round(success.time_weighted(held.met, good, spent), DIGITS))
    off = held.met & (np.abs(held.twsr - worth) > 1)
    yield from _first("trials.twsr", off, "not what T* and the time spent give")
    for name, (names, codes) in labels(tasks).items():
        there_names, there = held.labels.get(name, ((), np.zeros(0, dtype=np.int64)))
        said = np.array([*there_names, ""])[there] if len(there) == len(codes) else np.full(len(codes), "")
        yield from _first(
            f"trials.labels.{name}", said != np.array(names)[codes], "not what the suite says of the task"
        )


def _first(field: str, wrong: np.ndarray, problem: str) -> Found:
    """The first trial of which something wrong is so, and how many there are."""
    places = np.flatnonzero(wrong)
    if len(places):
        yield field, f"{problem}: in {len(places)} trials, the first is trial {int(places[0])}"


def settings(entry: Entry) -> Found:
    """Nothing departs from the benchmark's settings, and references are hthor's own."""
    for name, value in overrides.of(entry.run).items():
        yield "run", f"{name} is {value}, and such runs are not ranked"
    ours = all(robot.agent.source.startswith("hthor.agents.") for robot in entry.run.robots)
    if entry.reference != ours:
        yield "reference", f"is {entry.reference}, but the agents are {'' if ours else 'not '}hthor's own"
    if not ours and entry.isolation is None:
        yield "isolation", "is absent, but a submitted agent is always held at some level"


def consists(entry: Entry) -> Found:
    """Agents consist of what the run began with, and of nothing that was not handed in."""
    for place, (known, told) in enumerate(zip(entry.run.agents, entry.agents, strict=False)):
        if not set(known.files) <= set(told.files) or known.sha256 != told.sha256:
            yield f"agents[{place}]", f"lacks files of run.agents[{place}], or has others"
    if len(entry.agents) != len(entry.run.agents):
        yield "agents", f"has {len(entry.agents)} agents, but 'run' has {len(entry.run.agents)}"
    if entry.submission:
        for place, one in enumerate(entry.agents):
            for words in strangers(one.files, entry.files):
                yield f"agents[{place}].files", f"is not what 'files' says was handed in: {words}"


def strangers(files: Sequence[File], handed_in: Sequence[File]) -> list[str]:
    """Files of an agent that were not handed in, or not as they are, in words."""
    there = {file.path: file.sha256 for file in handed_in}
    return [
        f"{file.path} is not there" if file.path not in there else f"{file.path} is another file"
        for file in files
        if there.get(file.path) != file.sha256
    ]


def numbers(entry: Entry, held: Outcomes) -> Found:
    """Means lie in their intervals, and what can be worked out from the trials comes out the same."""
    for field, one in estimates(entry):
        if one.mean is not None and one.ci95 is not None and not one.ci95[0] <= one.mean <= one.ci95[1]:
            yield field, f"the mean {one.mean} is not inside the interval {one.ci95[0]} to {one.ci95[1]}"
        if one.n > entry.trials.count:
            yield f"{field}.n", f"is {one.n}, more than the {entry.trials.count} trials"
    if entry.run.participants != participants_needed(entry.trials.count):
        return  # whose trials these are is not known
    whose = entry_metrics.people(entry.trials.count, entry.run.participants)
    for metric, fresh in entry_metrics.scores(held, whose, alone=entry.alone).items():
        yield from unlike(f"metrics.{metric}", getattr(entry.metrics, metric), fresh)
    yield from unlike("splits", entry.splits, entry_metrics.splits(held, whose))


def uplift(entry: Entry, held: Outcomes, control: Entry | None, without: Outcomes | None) -> Found:
    """The uplift is over people without a robot on the same tasks, and comes out the same."""
    if entry.alone or entry.uplift is None:
        if entry.alone != (entry.uplift is None):
            yield "uplift", "is absent" if entry.uplift is None else "is there, but there is no robot"
        return
    if control is None or without is None:
        named = entry.uplift.control[:10]
        yield "uplift.control", f"is {named}, and no entry without a robot on the same suite and people has that run"
        return
    if control.trials.count == entry.trials.count:
        yield from unlike("uplift", entry.uplift, entry_metrics.uplift(entry, held, control, without))


def estimates(entry: Entry) -> Iterator[tuple[str, Estimate]]:
    """Every estimate of an entry and the field it stands in."""
    for name in entry.metrics.__struct_fields__:
        yield f"metrics.{name}", getattr(entry.metrics, name)


def unlike(field: str, there: Any, here: Any) -> Found:
    """Where two documents differ by more than a last decimal."""
    yield from _unlike(field, msgspec.to_builtins(there), msgspec.to_builtins(here))


def _unlike(field: str, there: Any, here: Any) -> Found:
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
