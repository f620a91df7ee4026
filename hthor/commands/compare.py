"""`hthor compare` and `hthor power`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hthor.eval.comparison.comparison import Comparison

_WORSE_EXIT = 6


def compare(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN RUN...", help="Folders of runs with the same suite, people and seed; the baseline first."
        ),
    ],
    fail_if_worse: Annotated[
        bool, typer.Option("--fail-if-worse", help="Exit with code 6 if a run has a lower success rate than the first.")
    ] = False,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """Compare runs trial by trial: which is better, by how much, or that the data cannot tell."""
    from hthor.eval.comparison import compare as comparing
    from hthor.report.terminal import corrections, result_tables

    found = comparing.compare_runs(runs)
    if json := formats.asks_json(json, shape):
        output.put_json(found)
    elif shape is Format.CSV:
        output.put_records([row for pair in found.pairs for row in _rows(pair)])
    else:
        for pair in found.pairs:
            output.put_rich(result_tables.pair_table(pair), shape)
            if len(found.pairs) == 1:
                for by in pair.groups:
                    output.put_rich(result_tables.groups_table(pair, by), shape)
            for line in result_tables.comparison_lines(pair):
                output.put_line(line, shape)
    if len(found.pairs) > 1 and not json:
        output.say("compare two runs, or use --json, to see kinds, splits, difficulties and scenes")
    for party in found.runs:
        if party.trials < party.planned:
            output.say(f"{party.name}: {party.planned - party.trials} of {party.planned} trials are not played yet.")
        if party.voided:
            output.say(f"{result_tables.voided_words(party.name, party.voided)}.")
        if party.corrections:
            output.say(f"{corrections.corrections_note(party.name, party.corrections)}.")
    if fail_if_worse and found.worse:
        raise typer.Exit(_WORSE_EXIT)


def _rows(pair: Comparison) -> Iterator[dict[str, object]]:
    """A comparison for a spreadsheet: one row per metric, then success by kind, split, difficulty and scene."""
    names = {"run": pair.second, "baseline": pair.first}
    for metric, found in pair.differences.items():
        yield {**names, "by": "", "group": "", "metric": metric, **formats.flat(found)}
    for by, groups in pair.groups.items():
        for group, found in groups.items():
            yield {**names, "by": by, "group": group, "metric": "sr", **formats.flat(found)}


def power(
    runs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[RUN RUN]", help="Two runs from which to take success rates and correlation.", show_default=False
        ),
    ] = None,
    rates: Annotated[
        str, typer.Option(help="Two success rates instead of runs: 0.73,0.76.", metavar="RATE,RATE", show_default=False)
    ] = "",
    correlation: Annotated[
        float | None,
        typer.Option(
            help="Correlation between the outcomes of the same trial with the two robots.",
            show_default="as measured, or 0.5",
        ),
    ] = None,
    difference: Annotated[
        float | None, typer.Option(help="Another difference than that of the two runs: 0.03.", show_default=False)
    ] = None,
    wanted: Annotated[
        float, typer.Option("--power", min=0.5, max=0.99, help="Probability of detecting the difference.")
    ] = 0.8,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """Compute how many tasks and sessions it takes to detect a difference in success, paired and unpaired."""
    from hthor.eval.comparison import sample_size

    found = sample_size.plan_study(tuple(runs or ()), rates, correlation, difference, wanted)
    if formats.asks_json(json, shape):
        output.put_json(found)
        return
    rows = [
        (name, need.trials, need.sessions) for name, need in (("paired", found.paired), ("not paired", found.unpaired))
    ]
    output.put_table(("", "tasks, once each, for either robot", "sessions, ten tasks each"), rows, shape)
    output.put_line(found.sentence, shape)
