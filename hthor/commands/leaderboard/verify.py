"""`hthor leaderboard verify` and `hthor leaderboard record`: playing entries again, and storing the result."""

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
    entry: Annotated[Path, typer.Argument(metavar="ENTRY", help="The file of an entry.")],
    draw: Annotated[
        str,
        typer.Option(
            help="A public random value from after the submission, such as the hash of the commit that merged it."
        ),
    ],
    agent: Annotated[str, typer.Option(help="The agent's file, unless the agent is built in.")] = "",
    agent_args: AgentArgs = None,
    readable: Readable = None,
    suite: Annotated[str, typer.Option(help="The suite's file, unless the suite ships with hthor.")] = "",
    sample: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Number of trials to play again, at most all of them. "
            "[default: 200; for an agent that is not reproducible, all]",
            show_default=False,
        ),
    ] = None,
    fresh: Annotated[int, typer.Option(min=0, help="Number of fresh tasks to play; 0 for none.")] = 200,
    official: Annotated[bool, typer.Option("--official", help="The entry was made by the official workflow.")] = False,
    jobs: Annotated[int | None, typer.Option("--jobs", "-j", min=1, help="Worker processes.")] = None,
    require_isolation: Annotated[str, typer.Option(help="The weakest acceptable isolation level.")] = "",
    by: Annotated[str, typer.Option(help="Name of the verifier, for the record.")] = "",
    date: Annotated[
        str, typer.Option(help="Date of the verification, for the record; hthor does not read the clock.")
    ] = "",
    board: Annotated[Path | None, typer.Option(help="Folder of the leaderboard. [default: the entry's]")] = None,
    out: Annotated[
        Path | None, typer.Option(help="Also write the verification to this file.", show_default=False)
    ] = None,
    write: Annotated[
        bool, typer.Option("--write", help="Put the verification into the board's folder, and build the board.")
    ] = False,
    json: Json = False,
) -> None:
    """Verify an entry: play a random sample of its trials again, and fresh tasks like them.

    The sample is drawn after the submission. Trials are compared byte for byte on the platform of the original run
    (tier V1), by outcome on another platform (V2), and statistically for an agent that is not reproducible (V3). An
    agent that does worse on fresh tasks is flagged.
    """
    from hthor.guest.agent import inputs
    from hthor.leaderboard import publish
    from hthor.leaderboard.entries import files, verification
    from hthor.leaderboard.verify import replay
    from hthor.leaderboard.verify import verify as verifying

    where = board or entry.resolve().parents[1]
    request = replay.Request(
        word=draw,
        agent=agent,
        given=inputs.parse_inputs(agent_args or (), readable or ()),
        suite=suite,
        sample=sample,
        fresh=fresh,
        official=official,
        jobs=jobs,
        require_isolation=require_isolation,
        by=by,
        date=date,
    )
    held, found = verifying.verify_entry(entry, where, request)
    if out is not None:
        files.write_document(out, found)
    if write:
        verification.write_verification(where, held, found)
        publish.build_board(where)
    if json:
        output.put_json(found)
    else:
        _tell_verification(found)
    if found.refuted or found.fell:
        raise typer.Exit(_REFUTED_EXIT)


def record(
    outcome: Annotated[Path, typer.Argument(metavar="VERIFICATION", help="The file written by 'verify --out'.")],
    board: Board = BOARD,
    json: Json = False,
) -> None:
    """For the maintainer of a board: store a verification that was made elsewhere, and build the board."""
    from hthor.leaderboard import publish
    from hthor.leaderboard.entries import files, verification

    found = verification.read_verification(outcome)
    held = files.read_entry(verification.entry_path(board, found))
    written = verification.write_verification(board, held, found)
    publish.build_board(board)
    output.put_files(written, json)


def _tell_verification(found: Verification) -> None:
    """Print one line per verdict."""
    from hthor.leaderboard.entries.verification import MIN_DETECTION

    for what, one in (("agent", found.trials), ("control", found.control)):
        if one is not None:
            verdict = "stands" if one.passed else "REFUTED"
            power = f"Three false outcomes in sixty would have been caught with {100 * one.caught:.0f} %"
            sys.stdout.write(f"{what}: {one.tier}: {verdict}: {one.why} {power}.\n")
            if one.passed and one.caught < MIN_DETECTION:
                sys.stdout.write(f"{what}: that is too little for a rank; draw more trials with --sample\n")
    if found.fresh is not None:
        sys.stdout.write(f"fresh tasks: {'FELL' if found.fell else 'no fall'}: {found.fresh.why}.\n")
