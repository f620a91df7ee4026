"""`hthor runs`: lists of runs, and single runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json, Run
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from hthor.eval.browse import RunSummary, TrialLine

app = typer.Typer(no_args_is_help=True, help="Finished and unfinished runs.")


@app.command("list")
def list_runs(
    folder: Annotated[
        Path, typer.Argument(metavar="[FOLDER]", help="The folder to search, with all folders below it.")
    ] = Path("runs"),
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """List the runs below a folder, latest first: agents, people, progress and success.

    A run that cannot be read is listed with the reason.
    """
    from hthor.errors import RunError
    from hthor.eval import browse

    if not folder.is_dir():
        raise RunError(f"{folder} is not a folder. Name the folder of your runs; 'hthor eval' writes to runs/.")
    found = browse.list_runs(folder)
    if formats.asks_json(json, shape):
        output.put_json(found)
        return
    if shape is Format.CSV:
        output.put_records([formats.flat(one) | {"agents": "+".join(one.agents)} for one in found.runs])
        return
    readable = [one for one in found.runs if not one.problem]
    headings = ("folder", "name", "suite", "people", "trials", "success", "faults", "last change (UTC)")
    if readable:
        output.put_table(headings, map(_row, readable), shape)
    for one in found.runs:
        if one.problem:
            output.put_line(f"{one.folder}: cannot be read: {one.problem}", shape)
    if not found.runs:
        output.put_line(f"no run below {folder}; 'hthor eval' makes one.", shape)


def _row(one: RunSummary) -> tuple[object, ...]:
    agents = "+".join(one.agents)
    name = one.name if agents == one.name else f"{one.name} ({agents})"
    done = str(one.done) if one.done == one.total else f"{one.done} of {one.total}"
    success = "–" if one.success is None else f"{100.0 * one.success:.1f} %"
    return one.folder, name, one.suite, one.people, done, success, one.faults, one.when[:16].replace("T", " ")


@app.command("view")
def view_run(
    run: Run,
    trials: Annotated[bool, typer.Option("--trials", help="Also list every trial.")] = False,
    task: Annotated[str, typer.Option(help="Only trials of this task, or with this target object.")] = "",
    kind: Annotated[str, typer.Option(help="Only trials of this kind of task.")] = "",
    house: Annotated[str, typer.Option(help="Only trials in this house.")] = "",
    participant: Annotated[
        int | None, typer.Option(min=0, help="Only trials of this participant, counted from 0.", show_default=False)
    ] = None,
    met: Annotated[
        bool | None, typer.Option("--met/--failed", help="Only trials that succeeded, or only trials that did not.")
    ] = None,
    faulty: Annotated[
        bool | None,
        typer.Option("--faulty/--sound", help="Only trials with, or only trials without, a fault of an agent."),
    ] = None,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """Show a run's result, faults and trials, and the next commands.

    Any option that chooses trials also lists the trials that fit. CSV has only the trials.
    """
    from hthor.eval import browse
    from hthor.log_corrections import CorrectAdoption
    from hthor.report.terminal import corrections, result_tables

    wanted = browse.TrialFilter(
        task=task, kind=_kind(kind), house=house, participant=participant, met=met, faulty=faulty
    )
    found, result = browse.view_run(run, wanted)
    if formats.asks_json(json, shape):
        output.put_json(found)
        return
    if shape is Format.CSV:
        output.put_records([formats.flat(line) for line in found.trials])
        return
    if trials := trials or wanted != browse.TrialFilter():
        headings = ("no.", "task", "house", "session", "outcome", "time [s]", "sent", "accepted", "trust", "fault")
        output.put_table(headings, map(_trial, found.trials), shape)
        output.put_line(f"{len(found.trials)} of {found.done} trials", shape)
    if result is not None and (not trials or shape is Format.TABLE):
        output.put_rich(result_tables.result_table(result), shape)
        for note in result_tables.result_notes([result]):
            output.put_line(note, shape)
    if found.done < found.total:
        output.put_line(f"{found.done} of {found.total} trials are played so far; the numbers are from these.", shape)
    if result is not None and result.counts.faults:
        kinds = ", ".join(f"{count} {kind}" for kind, count in result.counts.faults_by_kind.items())
        output.put_line(f"an agent failed in {result.counts.faults} of {found.done} trials: {kinds}", shape)
    for one in found.voided:
        which = f"session {one.session}, trial {one.index}, {one.task}, attempt {one.attempt}, {one.key}"
        how = f" by correction {one.correction}" if one.correction else ""
        output.put_line(f"voided{how}, does not count: {which}: {one.reason}", shape)
    for each in found.corrections:
        if isinstance(each, CorrectAdoption):
            words = f"{corrections.correction_words(each)}: {each.trial}: {each.reason}"
            output.put_line(f"correction {each.number}, {words}", shape)
    for line in output.following(*found.next):
        output.put_line(line, shape)


def _kind(word: str) -> str:
    """A kind's full name; a user's own kind has only one name."""
    from hthor.errors import UnknownName
    from hthor.eval.config import task_selection

    try:
        return task_selection.find_kind(word).name if word else ""
    except UnknownName:
        return word


def _trial(line: TrialLine) -> tuple[object, ...]:
    trust = "–" if line.trust is None else line.trust
    outcome = "met" if line.met else "not met"
    return (
        line.number, line.task, line.house, line.session, outcome, f"{line.time_s:.1f}", line.sent, line.accepted,
        trust, line.fault,
    )  # fmt: skip
