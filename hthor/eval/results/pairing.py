"""Pairs the trials of two runs that are the same except for the robots."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import trial_record
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.types import TrialSpec

_SAME = {
    "suite.sha256": "other tasks",
    "kind.sha256": "another file of the kind of task",
    "humans.sha256": "other human models",
    "design.study": "other groups of people",
    "seed": "other participants and tasks",
    "rules_sha256": "other rules of the benchmark",
    "code_sha256": "another version of hthor",
}


class Pair(Struct, frozen=True, kw_only=True):
    """The records of one trial in two runs with different robots."""

    one: ScoredTrial
    other: ScoredTrial


class PairedTrials(Struct, frozen=True, kw_only=True):
    """Two runs' trials in pairs, ordered by participant and trial, and how many trials have no partner."""

    pairs: tuple[Pair, ...]
    only_one: int
    only_other: int


def pairing_key(spec: TrialSpec) -> str:
    """The key that a trial shares with its counterparts with other robots: the same people, day and task.

    It is the key of the trial without a robot; trials with equal keys meet equal random draws. Settings that only
    robots notice are left out: the furniture pack (only they see its pictures), the decision clock, and an action's
    deadline. So is the attempt.
    """
    left_out = {"clock": msgspec.UNSET, "step_limit_s": msgspec.UNSET, "attempt": msgspec.UNSET}
    return trial_record.key(msgspec.structs.replace(spec, robots=(), assets_sha256="", **left_out))


def differing_field(one: RunConfig, other: RunConfig) -> str:
    """The first field whose difference keeps two runs' trials from being paired; empty when they can be paired."""
    return next((field for field in _SAME if _value(one, field) != _value(other, field)), "")


def check_comparable(one: tuple[Path, RunConfig], other: tuple[Path, RunConfig]) -> None:
    """Raise a RunError that names the field in which two runs differ, unless they can be compared."""
    field = differing_field(one[1], other[1])
    if not field:
        return
    here, there = (_short(_value(plan, field)) for _, plan in (one, other))
    raise RunError(
        f"{one[0]} and {other[0]} cannot be compared: {field} is {here} in the one and {there} in the other, so they "
        f"had {_SAME[field]}. Evaluate both with the same version, suite, people and seed."
    )


def pair_trials(one: Sequence[ScoredTrial], other: Sequence[ScoredTrial]) -> PairedTrials:
    """The trials that both runs have, in pairs."""
    first, second = ({pairing_key(found.spec): found for found in some} for some in (one, other))
    return PairedTrials(
        pairs=tuple(Pair(one=found, other=second[name]) for name, found in first.items() if name in second),
        only_one=sum(name not in second for name in first),
        only_other=sum(name not in first for name in second),
    )


def _value(plan: RunConfig, field: str) -> object:
    value: object = plan
    for name in field.split("."):
        value = getattr(value, name, "") if value is not None else ""
    return value


def _short(value: object) -> str:
    text = str(value)
    return text[:10] if len(text) == 64 else text or "absent"
