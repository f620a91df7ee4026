"""Recomputes entries' numbers from their trials, after the statistics have changed."""

from pathlib import Path

import msgspec

from hthor import jsonio
from hthor.leaderboard.entries import entry_metrics, files, trial_outcomes
from hthor.leaderboard.entries.entry import Entry


def rescore(board: Path) -> list[Path]:
    """Rewrite every entry whose numbers change, and return the paths; the outcomes of its trials stay as they are.

    Raises:
        BoardError: when an entry cannot be read.
    """
    held = [(path, files.read_entry(path)) for path in files.entry_paths(files.check_folder(board))]
    changed = []
    for path, entry in held:
        named = entry.uplift.control if entry.uplift else ""
        control = next((other for _, other in held if other.alone and other.hashes.run == named), None)
        rescored = _rescored(entry, control)
        if jsonio.pretty(rescored) != path.read_bytes():
            files.write_document(path, rescored)
            changed.append(path)
    return changed


def _rescored(entry: Entry, control: Entry | None) -> Entry:
    columns = trial_outcomes.unpack(entry.trials)
    participants = entry_metrics.trial_participants(entry.trials.count, entry.run.participants)
    scores: dict[str, object] = {**entry_metrics.entry_scores(columns, participants, alone=entry.alone)}
    return msgspec.structs.replace(
        entry,
        metrics=msgspec.structs.replace(entry.metrics, **scores),
        splits=entry_metrics.split_scores(columns, participants),
        uplift=entry_metrics.entry_uplift(entry, columns, control, trial_outcomes.unpack(control.trials))
        if control
        else entry.uplift,
    )
