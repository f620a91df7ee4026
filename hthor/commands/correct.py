"""`hthor correct`: corrections of a run's trials."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json, Run
from hthor.console import output

if TYPE_CHECKING:
    from hthor.eval.records.corrections import CorrectedTrial


def correct(
    run: Run,
    trial: Annotated[
        str,
        typer.Argument(
            metavar="[TRIAL]",
            help="The trial, as 'hthor replay' takes it: its key or the start of it, a task id, or a number. Without "
            "it, all corrections are listed.",
            show_default=False,
        ),
    ] = "",
    void: Annotated[bool, typer.Option("--void", help="The trial is broken and does not count.")] = False,
    again: Annotated[
        bool, typer.Option("--again", help="With --void: the next 'hthor eval' of the run repeats the trial.")
    ] = False,
    adoption: Annotated[
        str,
        typer.Option(
            metavar="yes|no|exclude",
            help="Whether the person adopted a suggestion, whatever the log says; exclude leaves the trial out of the "
            "adoption.",
            show_default=False,
        ),
    ] = "",
    seat: Annotated[
        str,
        typer.Option(help="With --adoption, in a trial of several people: whose, such as human2.", show_default=False),
    ] = "",
    withdraw: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Take back correction N.", show_default=False)
    ] = None,
    reason: Annotated[str, typer.Option(help="Why; every correction needs it.", show_default=False)] = "",
    by: Annotated[str, typer.Option(help="Who corrects, as any text.", show_default=False)] = "",
    date: Annotated[
        str, typer.Option(help="When, as any text; no clock is read.", metavar="TEXT", show_default=False)
    ] = "",
    json: Json = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Check the correction and show it; write nothing.")
    ] = False,
) -> None:
    """Mark a trial as broken, or correct whether the person adopted a suggestion; or list the corrections of a run.

    Corrections are added to RUN/corrections.jsonl and never deleted; the log stays as it is. Scores, comparisons,
    reports and calibrations follow them.
    """
    from hthor.eval.records import corrections

    options = corrections.CorrectionOptions(
        trial=trial,
        void=void,
        again=again,
        adoption=adoption,
        seat=seat,
        withdraw=withdraw,
        reason=reason,
        by=by,
        date=date,
    )
    found = corrections.correct(run, options, dry=dry_run)
    if json:
        output.put_json(found)
    elif found.corrections:
        output.put_table(
            ("no.", "trial", "task", "session", "correction", "reason", "by"), map(_row, found.corrections)
        )
    else:
        output.say(f"{run} has no corrections.")
    if found.added is not None and not found.written:
        output.say(f"correction {found.added} would be added; nothing was written.")
    elif found.added is not None:
        output.say(f"correction {found.added} was added.")
        for line in output.following(f"hthor score {shlex.quote(str(run))}"):
            output.say(line)


def _row(one: CorrectedTrial) -> tuple[object, ...]:
    from hthor.report.terminal import corrections

    line = one.correction
    where = line.trial if one.trial_number is None else f"{one.trial_number} ({line.trial})"
    words = corrections.correction_words(line, in_effect=one.in_effect)
    who = ", ".join(part for part in (line.by or "", line.date or "") if part)
    return line.number, where, one.task, one.session, words, line.reason, who
