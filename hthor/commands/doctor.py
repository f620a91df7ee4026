"""`hthor doctor`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.eval.doctor.check_result import DoctorReport

_FAILED_EXIT = 5
_STYLES = {"ok": "green", "warn": "yellow", "fail": "bold red"}


def doctor(
    out: Annotated[Path, typer.Option(help="The folder where runs will be written.")] = Path("runs"),
    require_isolation: Annotated[
        str, typer.Option(help="The weakest acceptable isolation level: L1, L2 or L3.")
    ] = "L1",
    json: Json = False,
    write_reference: Annotated[bool, typer.Option("--write-reference", hidden=True)] = False,
) -> None:
    """Check that this machine can run evaluations, and say how to fix what does not work.

    Starts a guest on each level of isolation, draws a frame, plays a trial and compares it with the reference that
    ships, and looks at versions, extras, disk, memory, cores, environment, and what sessions with people need. Writes
    nothing and uses no network. Exit code 5 when something that is needed does not work; a warning is not a failure.
    """
    if write_reference:
        _renew(json)
        return
    from hthor.eval.doctor import run_checks
    from hthor.live.session_checks import check_session

    found = run_checks.run_checks(out, require_isolation, check_session())
    if json:
        output.put_json(found)
    else:
        _put(found)
    if not found.well:
        raise typer.Exit(_FAILED_EXIT)


def _renew(json: bool) -> None:
    """Write the reference again, after a deliberate change of behaviour."""
    from hthor import jsonio
    from hthor.errors import HthorError
    from hthor.eval.doctor import reproducibility, run_checks

    with run_checks.start_probe(reproducibility.__name__) as process:
        course = process.answer(reproducibility.TrialFingerprint)
    if isinstance(course, str):
        raise HthorError(f"the trial could not be played: {course}.")
    jsonio.write(reproducibility.REFERENCE, jsonio.pretty(course))
    output.put_files([reproducibility.REFERENCE], json, sha256=course.sha256)


def _put(found: DoctorReport) -> None:
    from rich.text import Text

    paper = output.console()
    width = max(len(one.name) for one in found.findings)
    for one in found.findings:
        line = Text.assemble((f"{one.status:<4}", _STYLES[one.status]), f"  {one.name:<{width}}  {one.says}")
        paper.print(line, soft_wrap=True)
        if one.fix:
            paper.print(Text.assemble(" " * (width + 8), ("fix: ", "bold"), one.fix), soft_wrap=True)
    counts = {status: sum(one.status == status for one in found.findings) for status in _STYLES}
    sys.stdout.write(f"{counts['ok']} ok, {counts['warn']} warnings, {counts['fail']} failed\n")
