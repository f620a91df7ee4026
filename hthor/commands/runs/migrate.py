"""`hthor migrate`: runs and logs of the last release as log 1.0."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.eval.migration.migrate import Migrated


def migrate(
    runs: Annotated[
        list[Path],
        typer.Argument(metavar="RUN_OR_LOG...", help="Folders of runs, folders of several runs, or logs (.jsonl)."),
    ],
    json: Json = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Convert everything in memory and print what would change; write nothing.")
    ] = False,
) -> None:
    """Convert runs and logs of hthor 0.1 to log 1.0.

    Every converted file replaces the old one in one step, and the old one is kept beside it, as in
    trials.before-1.0.jsonl. Keys and checksums are computed again, and so is result.json. Files that are in the new
    format already are left alone, so the same command finishes an interrupted one.
    """
    from hthor.eval.migration import migrate as migrating

    done = migrating.migrate(runs, dry=dry_run)
    if json:
        output.put_json(done)
        return
    for one in done.done:
        output.put_line(_words(one, dry_run))


def _words(one: Migrated, dry: bool) -> str:
    if not one.converted and not one.kept:
        return f"{one.path}: {one.trials} trials, log 1.0 already."
    if dry:
        return f"{one.path}: {one.converted} of {one.trials} trials would be converted to log 1.0."
    words = f"{one.path}: {one.converted} of {one.trials} trials converted to log 1.0."
    if one.result == "scored":
        words += " result.json was computed again."
    elif one.result == "incomplete":
        words += " Trials are missing, so the run has no result.json any more."
    folder = Path(one.path) if Path(one.path).is_dir() else Path(one.path).parent
    kept = dict.fromkeys(Path(path).relative_to(folder).parts[0] for path in one.kept)
    return f"{words} The old files are kept as {', '.join(kept)}."
