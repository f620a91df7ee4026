"""`hthor leaderboard`; knows what the user types, not how any of it is done."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.eval.agent_inputs import AgentArgs, Readable
from hthor.commands.eval.evaluate import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.leaderboard.entries.verification import Verification

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
    from hthor.leaderboard.submission import submission

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
    from hthor.leaderboard.entries import files
    from hthor.leaderboard.submission import archive as archives
    from hthor.leaderboard.submission import submission

    if not archives.is_one(archive):
        raise HthorError(f"{archive} is no archive; expected a file that ends in {', '.join(archives.SUFFIXES)}.")
    folder = out or Path(archives.stem(archive))
    archives.unpack(archive, folder, most_bytes=submission.MAX_BYTES, most_files=submission.MAX_FILES)
    files.refuse(submission.problems(folder))
    output.put_files([folder], json)


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
    from hthor.leaderboard.submission import submission as submissions

    if submission is None:
        added = enter.add(run, board)
    else:
        with submissions.unpacked(submission) as folder:
            added = enter.add(run, board, submissions.read(folder))
    publish.build(board)
    if json:
        output.put_json({"entries": [str(path) for _, path in added]})
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
    from hthor.leaderboard import board_check, canonical_form
    from hthor.leaderboard.entries import files

    wanted = paths or files.entry_paths(board)
    for path in canonical_form.fix(wanted) if fix else ():
        sys.stderr.write(f"{path}: written in canonical form\n")
    found = board_check.problems(board, paths or (), submissions=submissions)
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
        output.put_json({"files": [str(path) for path in written]})
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
        output.put_json({"entries": [str(path) for path in changed]})
        return
    for path in changed:
        sys.stdout.write(f"{path}\n")
    sys.stderr.write(f"{len(changed)} of {len(list(board.glob('entries/*.json')))} entries came out otherwise\n")


@app.command("open")
def open_(
    season: Annotated[
        Path | None,
        typer.Argument(metavar="[COMMITMENT]", help="The commitment of an official suite that is to be ranked."),
    ] = None,
    board: Board = BOARD,
    json: Json = False,
) -> None:
    """Let a board take this version's people and suites, and rank an official suite: for the board's keeper.

    Writes admission.json, and the commitment to the suite.
    """
    from hthor.leaderboard.entries import files
    from hthor.leaderboard.ranking import admission
    from hthor.tasks.suites import commitment

    made = commitment.load(season) if season is not None else None
    written = [board / admission.NAME]
    files.write(written[0], admission.opened(board, made))
    if made is not None:
        written.append(board / files.SUITES / f"{made.name}.json")
        files.write(written[1], made)
    output.put_files(written, json)


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
    sample: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="How many trials are drawn; more than there are means all. "
            "[default: 200; all of an agent that does not repeat itself]",
            show_default=False,
        ),
    ] = None,
    fresh: Annotated[int, typer.Option(min=0, help="How many fresh tasks the agent plays; 0 for none.")] = 200,
    official: Annotated[bool, typer.Option("--official", help="The official workflow made the entry.")] = False,
    jobs: Annotated[int | None, typer.Option("--jobs", "-j", min=1, help="Worker processes.")] = None,
    require_isolation: Annotated[str, typer.Option(help="The least level that holds the agent.")] = "",
    by: Annotated[str, typer.Option(help="Who verifies, for the record.")] = "",
    date: Annotated[str, typer.Option(help="When, for the record; nothing looks at a clock.")] = "",
    board: Annotated[Path | None, typer.Option(help="The leaderboard's folder. [default: the entry's]")] = None,
    out: Annotated[Path | None, typer.Option(help="Write the outcome to this file.", show_default=False)] = None,
    write: Annotated[
        bool, typer.Option("--write", help="Put the outcome into the board's folder, and build the board.")
    ] = False,
    json: Json = False,
) -> None:
    """Play trials of an entry and of its control again, drawn after it was handed in, and fresh tasks like them.

    Trials are compared byte for byte on the platform that they were played on (tier V1), by outcomes on another (V2),
    statistically for an agent that does not repeat itself (V3). An agent that does worse at tasks which nobody had seen
    is flagged.
    """
    from hthor.guest.agent import inputs
    from hthor.leaderboard import publish
    from hthor.leaderboard.entries import files, verification
    from hthor.leaderboard.verify import verify as verifying

    where = board or entry.resolve().parents[1]
    request = verifying.Request(
        word=draw,
        agent=agent,
        given=inputs.read(agent_args or (), readable or ()),
        suite=suite,
        sample=sample,
        fresh=fresh,
        official=official,
        jobs=jobs,
        require_isolation=require_isolation,
        by=by,
        date=date,
    )
    held, found = verifying.verify(entry, where, request)
    if out is not None:
        files.write(out, found)
    if write:
        verification.keep(where, held, found)
        publish.build(where)
    if json:
        output.put_json(found)
    else:
        _tell_verification(found)
    if found.refuted or found.fell:
        raise typer.Exit(_REFUTED_EXIT)


@app.command("record")
def record(
    outcome: Annotated[Path, typer.Argument(metavar="VERIFICATION", help="What 'verify --out' wrote.")],
    board: Board = BOARD,
    json: Json = False,
) -> None:
    """Put a verification from elsewhere beside the entry that it is of, and build the board: for its keeper."""
    from hthor.leaderboard import publish
    from hthor.leaderboard.entries import files, verification

    found = verification.read(outcome)
    held = files.read(verification.place(board, found))
    written = verification.keep(board, held, found)
    publish.build(board)
    output.put_files(written, json)


def _tell_verification(found: Verification) -> None:
    """The verdicts, a line each."""
    from hthor.leaderboard.entries.verification import ENOUGH

    for what, one in (("agent", found.trials), ("control", found.control)):
        if one is not None:
            verdict = "stands" if one.passed else "REFUTED"
            power = f"Three false outcomes in sixty would have been caught with {100 * one.caught:.0f} %"
            sys.stdout.write(f"{what}: {one.tier}: {verdict}: {one.why} {power}.\n")
            if one.passed and one.caught < ENOUGH:
                sys.stdout.write(f"{what}: that is too little for a rank: draw more trials with --sample\n")
    if found.fresh is not None:
        sys.stdout.write(f"fresh tasks: {'FELL' if found.fell else 'no fall'}: {found.fresh.why}.\n")


def _tell(found: list, json: bool, well: str) -> None:  # type: ignore[type-arg]
    """Every problem on a line of its own; exit code 1 when there are some."""
    if json:
        output.put_json({"problems": found})
    else:
        for one in found:
            sys.stdout.write(f"{one.line}\n")
        sys.stderr.write(f"{len(found)} problem{'' if len(found) == 1 else 's'}\n" if found else f"{well}\n")
    if found:
        raise typer.Exit(_WRONG_EXIT)
