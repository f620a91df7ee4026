"""`hthor humans validate`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.calibration.validation.plan import ValidationOptions


def validate(
    name: Annotated[
        str,
        typer.Argument(
            metavar="[NAME]",
            help="The people: a population, a kind of people or a human model ('hthor humans list'), or a file "
            "(my_human.py or pop.npz.",
        ),
    ] = "proxy",
    calibration: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the calibration that produced these people.",
            show_default="the evidence that ships with them",
        ),
    ] = None,
    participants: Annotated[int, typer.Option(min=6, help="Participants per condition; each does ten tasks.")] = 60,
    suite: Annotated[
        list[str] | None,
        typer.Option(
            help="Another suite on which to check the order of the robots; repeat the option for several.",
            show_default=False,
        ),
    ] = None,
    kinds: Annotated[bool, typer.Option("--kinds", help="Also play every kind of people.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same people.")] = 0,
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes.", show_default="one per CPU")] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report.", show_default="runs/validation-NAME-HASH")
    ] = None,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick", help="A small trial run with few people and no baseline models; too small for any verdict."
        ),
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print what would be played, and where; write nothing.")
    ] = False,
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")] = False,
) -> None:
    """Compare simulated people with the published study, and write a report on how far to trust them.

    Plays NAME on the suite paper without a robot, with the frontier robot and with the oracle; greedy and random people
    are shown for comparison. Prints the eight published figures with predicted medians and 90 % intervals, and writes
    validation.html, one page that needs nothing else, and validation.json. The same command resumes an interrupted run.
    Exit code 1 when a bar was not cleared.
    """
    from hthor.calibration.validation import run as validation
    from hthor.calibration.validation.plan import ValidationOptions
    from hthor.calibration.validation.report import criteria, terminal
    from hthor.eval.runner import progress

    talk = output.console(talk=True)
    watcher = partial(progress.make_watcher, talk, quiet=quiet, live=output.live())
    options = ValidationOptions(
        name=name,
        calibration=calibration,
        participants=participants,
        out=out,
        jobs=jobs,
        seed=seed,
        quick=quick,
        kinds=kinds,
        suites=tuple(suite or ()),
    )
    if dry_run:
        _foretell(options, json)
        return
    done = validation.run_validation(options, watcher)
    paper = talk if json else output.console()
    paper.print(terminal.figures_table(done.findings))
    paper.print(terminal.gates_table(done.findings))
    if json:
        output.put_json(done.findings)
    for note in done.findings.subject.notes:
        output.say(f"note: {note}", talk)
    output.say(f"report: {done.folder}/validation.html, validation.json", talk)
    if failed := criteria.failed_gates(done.findings.gates):
        output.say(f"not cleared: {', '.join(gate.name for gate in failed)}.", talk)
        raise typer.Exit(1)


def _foretell(options: ValidationOptions, json: bool) -> None:
    from hthor.calibration.validation import plan
    from hthor.commands.eval import results

    found = list(plan.preview_runs(options))
    trials, played = (sum(getattr(run, name) for _, run in found) for name in ("trials", "played"))
    times = [run.seconds for _, run in found]
    seconds = None if None in times else round(sum(filter(None, times)), 1)
    folder = str(plan.report_folder(options))
    if json:
        runs = [{"people": one.word, "suite": one.suite, "role": one.role, "run": run} for one, run in found]
        output.put_json({"folder": folder, "trials": trials, "played": played, "seconds": seconds, "runs": runs})
        return
    output.put_table(
        ("people", "as", "suite", "run", "trials", "played", "time"),
        [
            (one.word, one.role, one.suite, run.name, run.trials, run.played, results.time(run.seconds) or "unknown")
            for one, run in found
        ],
    )
    about = f", {results.time(seconds)}" if seconds is not None else ""
    output.put_line(f"{trials - played} of {trials} trials would be played{about}, in {folder}/; nothing was written.")
