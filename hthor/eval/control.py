"""The control of a run: the same people at the same tasks without a robot, found beside it; plays nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from hthor.errors import RunError
from hthor.eval import log, metrics, pairing, setup, uplift
from hthor.eval.record import Record
from hthor.eval.setup import Setup
from hthor.eval.uplift import Uplift

FOLDER = "control"
"""Where a run keeps a control of its own."""


def beside(folder: Path, plan: Setup, records: Sequence[Record]) -> Uplift | None:
    """What the run in a folder adds over its control; None where it has no robot or no whole control lies there."""
    found = find(folder, plan)
    if found is None:
        return None
    run, kept = found
    return uplift.over(kept, records, run=run.sha256)


def find(folder: Path, plan: Setup) -> tuple[Setup, list[Record]] | None:
    """The control of a run and its records: in the run's own folder, or the first in order of names that lies beside.

    It counts only when it is whole; its metrics are worked out anew from its events.
    """
    return next(((there, kept) for _, there, kept in _whole(folder, plan)), None)


def place(folder: Path, plan: Setup) -> Path | None:
    """Where the control of a run lies, as `find` finds it."""
    return next((candidate for candidate, _, _ in _whole(folder, plan)), None)


def _whole(folder: Path, plan: Setup) -> Iterator[tuple[Path, Setup, list[Record]]]:
    """Every whole control of a run, and where it lies."""
    if not plan.seats:
        return
    for candidate in _candidates(folder):
        try:
            there = setup.load(candidate)
        except RunError:  # of another version, or damaged
            continue
        if there.seats or pairing.difference(plan, there) or there.participants < plan.participants:
            continue
        kept = _records(candidate)
        if len({record.key for record in kept}) >= there.trials:
            yield candidate, there, kept


def _candidates(folder: Path) -> Iterator[Path]:
    """Folders of runs that may be the control."""
    yield from (path for path in (folder / FOLDER,) if (path / "run.json").is_file())
    beside = folder.resolve().parent
    yield from sorted(path.parent for path in beside.glob("*/run.json") if path.parent != folder.resolve())


def _records(folder: Path) -> list[Record]:
    try:
        kept = [_slim(record) for _, record in log.read(folder / "trials.jsonl")]
    except RunError:
        return []
    return sorted(kept, key=lambda record: (record.spec.participant, record.spec.index))


def _slim(record: Record) -> Record:
    """The record with its metrics worked out anew, and without what only drawing needs."""
    fresh = metrics.measure(record.spec, record.log)
    return msgspec.structs.replace(record, metrics=fresh, paths={}, journal=())
