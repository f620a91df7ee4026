"""`hthor score`: a run's metrics from its log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import Json, Run
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from hthor.eval.results.result_file import RunResult


def score(
    run: Run,
    everything: Annotated[
        bool, typer.Option("--all", help="Also show messages, idle time, interference and shares of the work.")
    ] = False,
    trials: Annotated[
        bool, typer.Option("--trials", help="Show the values of every trial instead; write nothing.")
    ] = False,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """Compute the metrics of a run from its log; nothing is simulated."""
    from hthor.eval.results import aggregate as scoring
    from hthor.eval.results import result_file
    from hthor.report.terminal import result_tables

    if trials:
        _put_trials(run, everything, shape, json=formats.asks_json(json, shape))
        return
    plan, result, stored = scoring.rescore(run)
    if formats.asks_json(json, shape):
        output.put_json(result)
    elif shape is Format.CSV:
        output.put_records(list(_rows(result, everything)))
    else:
        output.put_rich(result_tables.result_table(result, everything=everything), shape)
        if everything and len(result.by_kind) > 1:
            output.put_rich(result_tables.kinds_table(result), shape)
    for note in (*result_tables.result_notes([result]), f"{result_tables.scoring_note(result)}."):
        output.say(note)
    if stored is not None and stored.hashes.scoring != result.hashes.scoring:
        before = f"scoring version {stored.hashes.scoring[:10]}" if stored.hashes.scoring else "an older version"
        output.say(f"{run / 'result.json'} was made by {before} of hthor; these values are new.")
    missing = plan.trials - result.over
    if missing:
        output.say(f"{missing} of {plan.trials} trials are missing, so the result is incomplete and was not stored.")
        return
    if stored is None:
        output.say(f"stored as {run / 'result.json'}.")
    elif stored != result:
        output.say(f"differs from {run / 'result.json'} in {_difference(stored, result)}; stored again.")
    else:
        output.say(f"equal to {run / 'result.json'}.")
        return
    result_file.store_result(run, result)


def _put_trials(run: Path, everything: bool, shape: Format, *, json: bool) -> None:
    """Print the values of every trial: all of them to a program, and to people the main metrics unless they ask."""
    from hthor.eval.metrics import registry
    from hthor.eval.results import trial_scores

    found = trial_scores.score_trials(run)
    if json:
        output.put_json(found)
        return
    rows = found.rows()
    if shape is Format.CSV:
        output.put_records(rows)
        return
    shown = ("key", "task", *(metric.name for metric in (registry.SINGLE if everything else registry.MAIN)))
    output.put_table(shown, [["–" if row[name] is None else row[name] for name in shown] for row in rows], shape)


def _rows(result: RunResult, everything: bool) -> Iterator[dict[str, object]]:
    """A result as spreadsheet rows, one per metric, for all tasks and then for each kind; rates are fractions."""
    from hthor.eval.metrics import registry
    from hthor.eval.results import result_file

    metrics = registry.SINGLE if everything else registry.MAIN
    parts = {"": result.metrics, **(result.by_kind if len(result.by_kind) > 1 else {})}
    for kind, scores in parts.items():
        for metric in metrics:
            estimate = formats.flat(scores[metric.name])
            yield {"run": result.name, "people": result.humans.name, "kind": kind, "metric": metric.name, **estimate}
    if result.uplift:
        for name in result_file.UPLIFT_METRICS:
            gain = formats.flat(getattr(result.uplift, name))
            mean = gain.pop("difference")
            known = {key: gain.get(key) for key in ("n", "ci95_low", "ci95_high", "mde80")}
            whose = {"run": result.name, "people": result.humans.name, "kind": ""}
            yield {**whose, "metric": f"uplift_{name}", "mean": mean, **known}


def _difference(stored: object, result: object) -> str:
    import msgspec

    before, now = msgspec.to_builtins(stored), msgspec.to_builtins(result)
    return ", ".join(name for name in now if before.get(name) != now[name])
