"""`hthor leaderboard`."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from hthor.commands.options import Json
from hthor.console import output

app = typer.Typer(no_args_is_help=True, help="The files of the leaderboard.")

Board = Annotated[Path, typer.Option(help="The leaderboard's folder.")]
BOARD = Path("leaderboard")
_WRONG_EXIT = 1


@app.command("check")
def check(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="SUBMISSION...", help="Folders such as submissions/mine, or archives of them."),
    ],
    json: Json = False,
) -> None:
    """Check that folders are valid submissions, without running their code."""
    from hthor.leaderboard.submission import submission

    found = []
    for place in folders:
        with submission.submission_folder(place) as folder:
            found += list(submission.submission_problems(folder))
    _tell(found, json, f"{len(folders)} submission{'' if len(folders) == 1 else 's'} in order")


@app.command("unpack")
def unpack(
    archive: Annotated[Path, typer.Argument(metavar="ARCHIVE", help="A .zip or .tar.gz of a submission.")],
    out: Annotated[
        Path | None, typer.Option(help="The folder to create.", show_default="the archive's name without its suffix")
    ] = None,
    json: Json = False,
) -> None:
    """Unpack a submission: only plain files inside its folder, within the limits of a submission."""
    from hthor.errors import HthorError
    from hthor.leaderboard.entries import files
    from hthor.leaderboard.submission import archive as archives
    from hthor.leaderboard.submission import submission

    if not archives.is_archive(archive):
        raise HthorError(f"{archive} is not an archive; expected a file that ends in {', '.join(archives.SUFFIXES)}.")
    folder = out or Path(archives.stem(archive))
    archives.unpack(archive, folder, most_bytes=submission.MAX_BYTES, most_files=submission.MAX_FILES)
    files.raise_problems(submission.submission_problems(folder))
    output.put_files([folder], json)


@app.command("add")
def add(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run, or a folder of runs.")],
    board: Board = BOARD,
    submission: Annotated[
        Path | None, typer.Option(help="The submitted folder or archive of the agent.", show_default=False)
    ] = None,
    json: Json = False,
) -> None:
    """Add complete runs to the leaderboard, together with their runs without a robot.

    Each run is scored again from its log. Adding a run again changes nothing.
    """
    from hthor.leaderboard import enter, publish
    from hthor.leaderboard.submission import submission as submissions

    if submission is None:
        added = enter.add_runs(run, board)
    else:
        with submissions.submission_folder(submission) as folder:
            added = enter.add_runs(run, board, submissions.read_submission(folder))
    publish.build_board(board)
    _put_entries([path for _, path in added], json)


@app.command("validate")
def validate(
    paths: Annotated[
        list[Path] | None,
        typer.Argument(metavar="ENTRY...", help="Files of entries. [default: all]", show_default=False),
    ] = None,
    board: Board = BOARD,
    submissions: Annotated[
        Path | None, typer.Option(help="The folder of submissions, to compare the agents' files with their hashes.")
    ] = None,
    fix: Annotated[bool, typer.Option("--fix", help="Rewrite valid files that are not in canonical form.")] = False,
    json: Json = False,
) -> None:
    """Check that entries follow the schema, are in canonical form, and that every number follows from their trials."""
    from hthor.leaderboard import board_check
    from hthor.leaderboard.entries import files

    wanted = paths or files.entry_paths(board)
    for path in board_check.fix_forms(wanted) if fix else ():
        sys.stderr.write(f"{path}: written in canonical form\n")
    found = board_check.check_board(board, paths or (), submissions=submissions)
    _tell(found, json, f"{len(wanted)} entr{'y' if len(wanted) == 1 else 'ies'} in order")


@app.command("build")
def build(
    board: Board = BOARD,
    check: Annotated[bool, typer.Option("--check", help="Write nothing; report what differs from the files.")] = False,
    json: Json = False,
) -> None:
    """Build leaderboard.json, schema.json and the page from the entries. The same entries give the same bytes."""
    from hthor.leaderboard import publish

    if check:
        _tell(publish.differences(board), json, f"{board} agrees with its entries")
        return
    output.put_files(publish.build_board(board), json)


@app.command("rescore")
def rescore(board: Board = BOARD, json: Json = False) -> None:
    """Recompute the numbers of entries from their trials, after a change of scoring; nothing is played.

    An entry whose trials were measured by other metrics needs its run: 'hthor leaderboard add RUN' measures it again.
    """
    from hthor.leaderboard import publish

    changed = publish.rescore(board)
    publish.build_board(board)
    _put_entries(changed, json)
    if not json:
        sys.stderr.write(f"{len(changed)} of {len(list(board.glob('entries/*.json')))} entries have changed\n")
    for path in publish.measured_otherwise(board):
        output.say(
            f"{path}: its trials were not measured by the present metrics, or it does not say by which. With the run's "
            f"folder, 'hthor leaderboard add RUN --board {board}' measures them again."
        )


@app.command("open")
def open_(
    season: Annotated[
        Path | None, typer.Argument(metavar="[COMMITMENT]", help="The commitment of an official suite to be ranked.")
    ] = None,
    board: Board = BOARD,
    json: Json = False,
) -> None:
    """For the maintainer of a board: admit the people and suites of this version, and rank an official suite.

    Writes admission.json, and the commitment to the suite.
    """
    from hthor.leaderboard.entries import files
    from hthor.leaderboard.ranking import admission
    from hthor.tasks.suites import commitment

    made = commitment.load_commitment(season) if season is not None else None
    written = [board / admission.NAME]
    files.write_document(written[0], admission.extended_admission(board, made))
    if made is not None:
        written.append(board / files.SUITES / f"{made.name}.json")
        files.write_document(written[1], made)
    output.put_files(written, json)


def _put_entries(paths: Sequence[Path], json: bool) -> None:
    if json:
        output.put_json({"entries": [str(path) for path in paths]})
    else:
        output.put_files(paths, json)


def _tell(found: list, json: bool, well: str) -> None:  # type: ignore[type-arg]
    """Print one problem per line; exit with code 1 if there are any."""
    if json:
        output.put_json({"problems": found})
    else:
        for one in found:
            sys.stdout.write(f"{one.line}\n")
        sys.stderr.write(f"{len(found)} problem{'' if len(found) == 1 else 's'}\n" if found else f"{well}\n")
    if found:
        raise typer.Exit(_WRONG_EXIT)
