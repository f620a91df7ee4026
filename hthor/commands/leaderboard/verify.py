"""`hthor leaderboard verify` and `hthor leaderboard record`: playing entries again, and keeping what came of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.leaderboard.board import BOARD, Board
from hthor.commands.options import AgentArgs, Json, Readable
from hthor.console import output

if TYPE_CHECKING:
    from hthor.leaderboard.entries.verification import Verification

_REFUTED_EXIT = 5


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
