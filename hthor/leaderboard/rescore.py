"""Entries' numbers out of their trials once more, for when the statistics have changed; plays and judges nothing."""

from __future__ import annotations

from pathlib import Path

import msgspec

from hthor import jsonio
from hthor.leaderboard.entries import entry_metrics, files, trial_outcomes
from hthor.leaderboard.entries.entry import Entry


def rescore(board: Path) -> list[Path]:
    """Write every entry anew whose numbers come out otherwise; which ones. What its trials were stays as it is.

    Raises:
        BoardError: when an entry cannot be read.
    """
    held = [(path, files.read(path)) for path in files.entry_paths(files.seen(board))]
    changed = []
    for path, entry in held:
        named = entry.uplift.control if entry.uplift else ""
        control = next((other for _, other in held if other.alone and other.hashes.run == named), None)
        fresh = _fresh(entry, control)
        if jsonio.pretty(fresh) != path.read_bytes():
            files.write(path, fresh)
            changed.append(path)
    return changed


def _fresh(entry: Entry, control: Entry | None) -> Entry:
    columns = trial_outcomes.unpack(entry.trials)
    whose = entry_metrics.people(entry.trials.count, entry.run.participants)
    scores: dict[str, object] = {**entry_metrics.scores(columns, whose, alone=entry.alone)}
    return msgspec.structs.replace(
        entry,
        metrics=msgspec.structs.replace(entry.metrics, **scores),
        splits=entry_metrics.splits(columns, whose),
        uplift=entry_metrics.uplift(entry, columns, control, trial_outcomes.unpack(control.trials))
        if control
        else entry.uplift,
    )
