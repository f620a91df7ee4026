"""`hthor eval`."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.eval import results
from hthor.commands.options import Json, takes_options
from hthor.console import output
from hthor.eval.config.option import make_record
from hthor.eval.config.options import EvalOptions

if TYPE_CHECKING:
    from hthor.eval.runner.experiment import FinishedRun

_FAULTS_EXIT = 3


@takes_options(EvalOptions)
def evaluate(
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")] = False,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Print what would be played, where, and how long it would take; write nothing."),
    ] = False,
    context: typer.Context = None,  # type: ignore[assignment]
    **given: object,
) -> None:
    """Evaluate robots that help people with a suite of tasks.

    Running the same command again resumes an interrupted run, and only scores a finished one. The same seed gives the
    same records, byte for byte, with any number of jobs.
    """
    from hthor.eval.comparison import population_matrix
    from hthor.eval.planning.resolve import resolve
    from hthor.eval.runner import experiment, progress
    from hthor.report.terminal import result_tables

    talk = output.console(talk=True)
    resolved = resolve(make_record(EvalOptions, given), lambda words: None if quiet else output.say(words, talk))
    if dry_run:
        results.show_forecast(resolved, context, json)
        return
    watcher = partial(progress.make_watcher, talk, quiet=quiet, live=output.live())
    paper = talk if json else output.console()
    done: list[FinishedRun] = []
    single = len(resolved.runs) == 1
    for one in experiment.run_experiment(resolved, watcher):
        done.append(one)
        if single or not quiet:
            results.show_run(paper if single else talk, one)
    whole = population_matrix.make_evaluation((str(one.folder), one.result) for one in done)
    run_results = [one.result for one in done]
    if whole.peoples is not None:
        results.show_populations(paper, whole.peoples)
    elif len(done) > 1:
        paper.print(result_tables.comparison_table(run_results))
    if len(done) > 1:
        for one in done:
            whose = f", {one.config.humans.name} people" if whole.peoples is not None else ""
            output.say(f"{one.config.label}{whose}: {one.folder}/", paper)
    for note in result_tables.result_notes(run_results):
        output.say(note, paper)
    if json:
        output.put_json(whole)
    if any(one.result.counts.faults > resolved.allowed_faults(one.result.counts.trials) for one in done):
        raise typer.Exit(_FAULTS_EXIT)
