"""`hthor leaderboard`; knows what the user types, not how any of it is done."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from hthor.cli import screen
from hthor.cli.giving import AgentArgs, Readable
from hthor.cli.runs import Json

app = typer.Typer(no_args_is_help=True, help="The leaderboard's files.")

Board = Annotated[Path, typer.Option(help="The leaderboard's folder.")]
BOARD = Path("leaderboard")
_WRONG_EXIT, _REFUTED_EXIT = 1, 5


@app.callback()
def _group() -> None:
    """The leaderboard's files."""


@app.command("check")
def check(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="SUBMISSION...", help="Folders such as submissions/mine, or archives of them."),
    ],
    json: Json = False,
) -> None:
    """See that folders are submissions, without running anything of them."""
    from hthor.leaderboard import submission

    found = []
    for place in folders:
        with submission.unpacked(place) as folder:
            found += list(submission.problems(folder))
    _tell(found, json, f"{len(folders)} submission{'' if len(folders) == 1 else 's'} in order")


@app.command("unpack")
def unpack(
    archive: Annotated[Path, typer.Argument(metavar="ARCHIVE", help="A .zip or .tar.gz of a submission.")],
    out: Annotated[
        Path | None, typer.Option(help="The folder to make.", show_default="the archive's name without its ending")
    ] = None,
    json: Json = False,
) -> None:
    """Unpack a submission: plain files alone, none outside its folder, and no more than a submission may hold."""
    from hthor.errors import HthorError
    from hthor.leaderboard import archive as archives
    from hthor.leaderboard import files, submission

    if not archives.is_one(archive):
        raise HthorError(f"{archive} is no archive; expected a file that ends in {', '.join(archives.SUFFIXES)}.")
    folder = out or Path(archives.stem(archive))
    archives.unpack(archive, folder, most_bytes=submission.MAX_BYTES, most_files=submission.MAX_FILES)
    files.refuse(submission.problems(folder))
    screen.put_files([folder], json)


@app.command("add")
def add(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="A run's folder, or a folder of such.")],
    board: Board = BOARD,
    submission: Annotated[
        Path | None,
        typer.Option(help="The folder or archive that the agent was handed in as.", show_default=False),
    ] = None,
    json: Json = False,
) -> None:
    """Put whole runs on the leaderboard, with the runs without a robot that they are measured against.

    Each is scored anew from its log. Adding a run again changes nothing.
    """
    from hthor.leaderboard import enter, publish
    from hthor.leaderboard import submission as submissions

    if submission is None:
        added = enter.add(run, board)
    else:
        with submissions.unpacked(submission) as folder:
            added = enter.add(run, board, submissions.read(folder))
    publish.build(board)
    if json:
        screen.put_json({"entries": [str(path) for _, path in added]})
        return
    for _, path in added:
        sys.stdout.write(f"{path}\n")


@app.command("validate")
def validate(
    paths: Annotated[
        list[Path] | None, typer.Argument(metavar="ENTRY...", help="Entries' files. [default: all]", show_default=False)
    ] = None,
    board: Board = BOARD,
    submissions: Annotated[
        Path | None, typer.Option(help="The folder of submissions, to compare agents' files with their hashes.")
    ] = None,
    fix: Annotated[bool, typer.Option("--fix", help="Write files that are well but for their spelling anew.")] = False,
    json: Json = False,
) -> None:
    """See that entries follow the schema, are in canonical form, and that every number follows from their trials."""
    from hthor.leaderboard import checks, files, form

    wanted = paths or files.entry_paths(board)
    for path in form.fix(wanted) if fix else ():
        sys.stderr.write(f"{path}: written in canonical form\n")
    found = checks.problems(board, paths or (), submissions=submissions)
    _tell(found, json, f"{len(wanted)} entr{'y' if len(wanted) == 1 else 'ies'} in order")


@app.command("build")
def build(
    board: Board = BOARD,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; say what is not as it would be written.")
    ] = False,
    json: Json = False,
) -> None:
    """Make leaderboard.json, schema.json and the page from the entries: the same entries give the same bytes."""
    from hthor.leaderboard import publish

    if check:
        _tell(publish.differences(board), json, f"{board} is as its entries say")
        return
    written = publish.build(board)
    if json:
        screen.put_json({"files": [str(path) for path in written]})
        return
    for path in written:
        sys.stdout.write(f"{path}\n")


@app.command("rescore")
def rescore(board: Board = BOARD, json: Json = False) -> None:
    """Work out entries' numbers anew from their trials, where hthor's statistics have changed; nothing is played."""
    from hthor.leaderboard import publish
    from hthor.leaderboard import rescore as rescoring

    changed = rescoring.rescore(board)
    publish.build(board)
    if json:
        screen.put_json({"entries": [str(path) for path in changed]})
        return
    for path in changed:
        sys.stdout.write(f"{path}\n")
    sys.stderr.write(f"{len(changed)} of {len(list(board.glob('entries/*.json')))} entries came out otherwise\n")


@app.command("verify")
def verify(
    entry: Annotated[Path, typer.Argument(metavar="ENTRY", help="An entry's file.")],
    draw: Annotated[
        str,
        typer.Option(help="Public chance from after the submission, such as the hash of the commit that merged it."),
    ],
    agent: Annotated[str, typer.Option(help="The agent's file, for one that is not hthor's own.")] = "",
    agent_args: AgentArgs = None,
    readable: Readable = None,
    suite: Annotated[str, typer.Option(help="Where the suite lies, when it is not hthor's own.")] = "",
    sample: Annotated[int, typer.Option(min=1, help="How many trials are drawn; more than there are means all.")] = 200,
    jobs: Annotated[int | None, typer.Option("--jobs", "-j", min=1, help="Worker processes.")] = None,
    require_isolation: Annotated[str, typer.Option(help="The least level that holds the agent.")] = "",
    by: Annotated[str, typer.Option(help="Who verifies, for the record.")] = "",
    date: Annotated[str, typer.Option(help="When, for the record; nothing looks at a clock.")] = "",
    board: Annotated[Path | None, typer.Option(help="The leaderboard's folder. [default: the entry's]")] = None,
    write: Annotated[
        bool, typer.Option("--write", help="Put the outcome into the entry, and build the board.")
    ] = False,
    json: Json = False,
) -> None:
    """Play a sample of an entry's trials again, drawn after it was handed in, and compare.

    Byte for byte on the platform that it was played on (tier V1), by outcomes on another (V2), statistically for an
    agent that does not repeat itself (V3).
    """
    from hthor.guest import given
    from hthor.leaderboard import publish
    from hthor.leaderboard import verify as verifying

    where = board or entry.resolve().parents[1]
    request = verifying.Request(
        word=draw,
        agent=agent,
        given=given.read(agent_args or (), readable or ()),
        suite=suite,
        sample=sample,
        jobs=jobs,
        require_isolation=require_isolation,
        by=by,
        date=date,
    )
    _, found = verifying.verify(entry, where, request)
    if write:
        verifying.record(entry, found)
        publish.build(where)
    if json:
        screen.put_json(found)
    else:
        sys.stdout.write(f"{found.tier}: {'stands' if found.passed else 'REFUTED'}: {found.why}\n")
    if not found.passed:
        raise typer.Exit(_REFUTED_EXIT)


def _tell(found: list, json: bool, well: str) -> None:  # type: ignore[type-arg]
    """Every problem on a line of its own; exit code 1 when there are some."""
    if json:
        screen.put_json({"problems": found})
    else:
        for one in found:
            sys.stdout.write(f"{one.line}\n")
        sys.stderr.write(f"{len(found)} problem{'' if len(found) == 1 else 's'}\n" if found else f"{well}\n")
    if found:
        raise typer.Exit(_WRONG_EXIT)
