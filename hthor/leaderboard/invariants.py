"""What must hold in an entry beyond its schema: every number follows from what it carries; reads no files.

Each law gives its problems as pairs of a field and what is wrong there, so that all of them can be listed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec

from hthor.eval.session import people_for
from hthor.eval.stats import Estimate
from hthor.guest import File
from hthor.leaderboard import overrides, worth
from hthor.leaderboard.entry import REALTIME, Entry
from hthor.leaderboard.outcomes import Outcomes

Found = Iterator[tuple[str, str]]
_NEAR = 2e-6
"""Numbers have six decimals; the last may differ from machine to machine."""


def hashes(entry: Entry, held: Outcomes) -> Found:
    """The hashes are those of what they are of."""
    if (now := entry.run.sha256) != entry.hashes.run:
        yield "hashes.run", f"is {entry.hashes.run[:10]}, but the hash of 'run' is {now[:10]}"
    if not entry.id.endswith(f"-{entry.hashes.run[:10]}"):
        yield "id", f"does not end in the first ten digits of hashes.run, '{entry.hashes.run[:10]}'"
    if (now := held.merkle) != entry.hashes.merkle:
        yield "hashes.merkle", f"is {entry.hashes.merkle[:10]}, but the root of what 'trials' holds is {now[:10]}"
    found = entry.verification
    if found is not None and found.entry != entry.digest:
        yield "verification.entry", f"is of {found.entry[:10]}, but this entry is {entry.digest[:10]}: verify it again"


def verification(entry: Entry) -> Found:
    """What a verifier wrote holds together."""
    found = entry.verification
    if found is None:
        return
    if not found.same_bytes <= found.equal <= found.compared <= entry.trials.count:
        told = f"{found.same_bytes} the same, {found.equal} equal, {found.compared} compared"
        yield "verification", f"cannot be of {entry.trials.count} trials: {told}"
    if not 1 <= found.drawn <= found.compared:
        yield "verification.drawn", f"is {found.drawn}, but {found.compared} were compared"
    if found.tier == "V1" and found.passed != (found.same_bytes == found.compared):
        yield "verification.passed", f"is {found.passed} with {found.same_bytes} of {found.compared} records the same"
    if found.tier != "V3" and (not entry.agent.deterministic or entry.mode == REALTIME):
        yield "verification.tier", f"is {found.tier}, but the agent does not repeat itself: V3 is all that there can be"


def sizes(entry: Entry, held: Outcomes) -> Found:
    """The run is whole, with every task once, and what failed is counted."""
    trials, counts = entry.trials.count, entry.counts
    for field, value in (
        ("run.trials", entry.run.trials),
        ("counts.trials", counts.trials),
        ("counts.tasks", counts.tasks),
        ("metrics.sr.n", entry.metrics.sr.n),
    ):
        if value != trials:
            yield field, f"is {value}, but 'trials' holds {trials}"
    if entry.run.participants != people_for(trials):
        yield "run.participants", f"is {entry.run.participants}; {trials} tasks done once take {people_for(trials)}"
    for field, value, there in (
        ("counts.successes", counts.successes, int(held.met.sum())),
        ("counts.faults", counts.faults, int(held.faulty.sum())),
    ):
        if value != there:
            yield field, f"says {value}, but 'trials' has {there}"
    if counts.faults_by_seat and not max(counts.faults_by_seat.values()) <= counts.faults <= sum(
        counts.faults_by_seat.values()
    ):
        yield "counts.faults_by_seat", f"cannot add up to {counts.faults} trials with a fault"
    if sum(counts.faults_by_kind.values()) != sum(counts.faults_by_seat.values()):
        yield "counts.faults_by_kind", f"adds up to {sum(counts.faults_by_kind.values())} faults, 'faults_by_seat' not"


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
    if entry.run.participants != people_for(entry.trials.count):
        return  # whose trials these are is not known
    whose = worth.people(entry.trials.count, entry.run.participants)
    for metric, fresh in worth.scores(held, whose, alone=entry.alone).items():
        yield from unlike(f"metrics.{metric}", getattr(entry.metrics, metric), fresh)
    yield from unlike("splits", entry.splits, worth.splits(held, whose))


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
        yield from unlike("uplift", entry.uplift, worth.uplift(entry, held, control, without))


def estimates(entry: Entry) -> Iterator[tuple[str, Estimate]]:
    """Every estimate of an entry and the field it stands in."""
    for name in entry.metrics.__struct_fields__:
        found = getattr(entry.metrics, name)
        if isinstance(found, Estimate):
            yield f"metrics.{name}", found
        else:
            yield from ((f"metrics.{name}.{key}", one) for key, one in found.items())


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
