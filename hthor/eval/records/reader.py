"""A run's records from its log, each seen to be one of this run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec

from hthor.errors import RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import trial_log
from hthor.eval.records.trial_log import Place
from hthor.eval.records.trial_record import TrialRecord


def records(folder: Path, plan: RunConfig) -> tuple[list[bytes], list[TrialRecord]]:
    """Every line of a run's log and its record, in the order of people and their trials.

    Raises:
        RunError: when a line is damaged, or is a trial of another run.
    """
    found = sorted(
        trial_log.read(folder / "trials.jsonl"), key=lambda pair: (pair[1].spec.participant, pair[1].spec.index)
    )
    for _, record in found:
        check_origin(folder, record, plan)
    _check_once(folder, [record.key for _, record in found])
    return [line for line, _ in found], [record for _, record in found]


def digest(folder: Path, plan: RunConfig) -> tuple[list[Place], list[TrialRecord]]:
    """As `records`, for runs of any length: lines stay on the disk, and records come without paths and journal.

    Raises:
        RunError: as `records`.
    """
    found: list[tuple[Place, TrialRecord]] = []
    for place, _, record in trial_log.places(folder / "trials.jsonl"):
        check_origin(folder, record, plan)
        found.append((place, msgspec.structs.replace(record, paths={}, journal=())))
    found.sort(key=lambda pair: (pair[1].spec.participant, pair[1].spec.index))
    _check_once(folder, [record.key for _, record in found])
    return [place for place, _ in found], [record for _, record in found]


def _check_once(folder: Path, keys: Sequence[str]) -> None:
    twice = next((key for key in keys if keys.count(key) > 1), "") if len(set(keys)) < len(keys) else ""
    if twice:
        raise RunError(f"{folder / 'trials.jsonl'}: trial {twice} is there twice. Delete one of the two lines.")


def check_origin(folder: Path, record: TrialRecord, plan: RunConfig) -> None:
    """See that a record is one of this run's."""
    spec = record.spec
    pairs = {
        "seed": (spec.seed, plan.seed),
        "human_sha256": (spec.human_sha256, plan.humans.sha256),
        "suite_sha256": (spec.suite_sha256, plan.suite.sha256),
        "rules_sha256": (spec.rules_sha256, plan.rules_sha256),
        "code_sha256": (spec.code_sha256, plan.code_sha256),
        "robots": (spec.robots, plan.seats),
        "kind_sha256": (spec.kind_sha256, plan.kind.sha256 if plan.kind else ""),
        "assets_sha256": (spec.assets_sha256, plan.assets.sha256),
        "realtime": (bool(spec.realtime), bool(plan.realtime)),
        "step_limit_s": (spec.step_limit_s, plan.step_limit_s),
    }
    for field, (here, there) in pairs.items():
        if here != there:
            raise RunError(
                f"{folder / 'trials.jsonl'}: trial {record.key}: spec.{field} is not the one in run.json. "
                "The line belongs to another run; delete it."
            )
