"""Builds the list, the schema and the page from the entries, and recomputes entries after changes of scoring."""

from collections.abc import Iterable
from pathlib import Path

import msgspec
from msgspec import UNSET

from hthor import code_identity, jsonio
from hthor.errors import HthorError
from hthor.leaderboard import board_check, schema
from hthor.leaderboard.entries import entry_metrics, files, trial_outcomes, verification
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import Problem
from hthor.leaderboard.page import page
from hthor.leaderboard.ranking import admission, listing


def build_board(board: Path) -> list[Path]:
    """Write the list, the schema and the page of a board; return their paths.

    Raises:
        BoardError: if entries are not valid; lists all problems.
    """
    written = []
    for name, data in board_files(board).items():
        path = board / name
        if not path.is_file() or path.read_bytes() != data:
            jsonio.write(path, data)
        written.append(path)
    return written


def board_files(board: Path) -> dict[str, bytes]:
    """The contents of a board's list, schema and page, by file name."""
    files.raise_problems(board_check.check_board(board))
    entries = [files.read_entry(path) for path in files.entry_paths(board)]
    found = listing.make_board(entries, verification.load_records(board), admission.load_admission(board))
    return {
        files.LIST: jsonio.pretty(found),
        files.SCHEMA: jsonio.pretty(schema.json_schema()),
        files.PAGE: page.render(found, watch_pages(board, entries)).encode(),
    }


def watch_pages(board: Path, entries: Iterable[Entry]) -> dict[str, str]:
    """The addresses of the pages that `hthor watch` wrote for entries, by their ids, relative to the board's page."""
    named = {entry.id: f"watch/{entry.id}/index.html" for entry in entries}
    return {name: page for name, page in named.items() if (board / page).is_file()}


def differences(board: Path) -> list[Problem]:
    """Files of a board that do not agree with its entries."""
    try:
        wanted = board_files(board)
    except HthorError:
        return board_check.check_board(board)
    hint = "does not agree with the entries; 'hthor leaderboard build' writes it"
    return [
        Problem(file=str(board / name), field="$", problem=hint)
        for name, data in wanted.items()
        if not (board / name).is_file() or (board / name).read_bytes() != data
    ]


def rescore(board: Path) -> list[Path]:
    """Rewrite every entry whose numbers or scoring version change, and return the paths.

    The outcomes of trials do not change. An entry whose outcomes were measured by other metrics than the present ones
    gets no scoring version; see `measured_otherwise`.

    Raises:
        BoardError: if an entry cannot be read.
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


def measured_otherwise(board: Path) -> list[Path]:
    """Entries whose outcomes were not measured by the present metrics; their runs' logs are needed to do that."""
    here = trial_outcomes.metrics_sha256()
    return [path for path in files.entry_paths(board) if files.read_entry(path).trials.metrics_sha256 != here]


def _rescored(entry: Entry, control: Entry | None) -> Entry:
    columns = trial_outcomes.unpack(entry.trials)
    participants = entry_metrics.trial_participants(entry.trials.count, entry.run.participants)
    current = entry.trials.metrics_sha256 == trial_outcomes.metrics_sha256()
    scores: dict[str, object] = {**entry_metrics.entry_scores(columns, participants, alone=entry.alone)}
    return msgspec.structs.replace(
        entry,
        scoring_sha256=code_identity.scoring_sha256() if current else UNSET,
        metrics=msgspec.structs.replace(entry.metrics, **scores),
        splits=entry_metrics.split_scores(columns, participants),
        uplift=entry_metrics.entry_uplift(entry, columns, control, trial_outcomes.unpack(control.trials))
        if control
        else entry.uplift,
    )
