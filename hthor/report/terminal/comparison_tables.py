"""A comparison of two runs as terminal tables and lines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import SHARE, Unit
from hthor.eval.results.paired_difference import Difference
from hthor.report.terminal.result_tables import format_detectable, format_difference, new_table

if TYPE_CHECKING:
    from rich.table import Table

    from hthor.eval.comparison.compare import Comparison

_HEADINGS = ("difference", "95 % interval", "could have seen", "p", "trials")


def comparison_table(pair: Comparison) -> Table:
    """A row for each metric."""
    title = f"{pair.second} against {pair.first}: {pair.tasks} tasks, {pair.people} people"
    table = new_table(title, pair.first, pair.second, *_HEADINGS)
    for name, difference in pair.differences.items():
        metric, adjusted = registry.get(name), name == "sr" and pair.among > 1
        cells = _cells(pair.success if adjusted else difference, metric.unit)
        table.add_row(metric.heading + ("*" if adjusted else ""), *cells)
    return table


def groups_table(pair: Comparison, by: str) -> Table:
    """Success by kind, split, difficulty or scene."""
    table = new_table(f"{registry.get('sr').heading}, by {by}", pair.first, pair.second, *_HEADINGS)
    for name, difference in pair.groups[by].items():
        table.add_row(name.replace("_", " "), *_cells(difference, SHARE))
    return table


def comparison_lines(pair: Comparison) -> Iterator[str]:
    """The rest in words, the verdict last."""
    mcnemar, tally = pair.mcnemar, pair.tally
    yield (
        f"success in one of the two only: {mcnemar.only_second} times {pair.second}, {mcnemar.only_first} times "
        f"{pair.first}; exact McNemar p {_chance(mcnemar.p)}"
    )
    yield (
        f"{pair.second} was better in time-weighted success in {tally.wins} trials, the same in {tally.ties}, worse in "
        f"{tally.losses}"
    )
    if any(pair.dropped):
        yield f"without a partner: {pair.dropped[0]} trials of {pair.first}, {pair.dropped[1]} of {pair.second}"
    if pair.among > 1:
        yield (
            f"* interval and p are adjusted for {pair.among} comparisons (Holm's method), as the verdict is; the other "
            "rows stand each for itself"
        )
    yield pair.sentence


def _cells(found: Difference, unit: Unit) -> Iterator[str]:
    yield from (f"{unit.scale * value:.1f}" for value in (found.first, found.second))
    yield format_difference(found.difference, unit)
    yield "–" if found.ci95 is None else " … ".join(format_difference(end, unit) for end in found.ci95)
    yield format_detectable(found.mde80, unit)
    yield "–" if found.p is None else ("< 0.001" if found.p < 0.001 else f"{found.p:.3f}")
    yield str(found.n)


def _chance(p: float) -> str:
    return "< 0.001" if p < 0.001 else f"= {p:.3f}"
