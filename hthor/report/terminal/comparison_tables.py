"""A comparison of two runs as tables and lines for people; computes nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from hthor.eval.results.paired_difference import UNITS, Difference
from hthor.report.terminal import result_tables

if TYPE_CHECKING:
    from rich.table import Table

    from hthor.eval.comparison.compare import Comparison

_TITLES = {
    "sr": "success rate [%]",
    "twsr": "time-weighted success [%]",
    "adoption": "adoption [%]",
    "progress": "progress [%]",
    "time_s": "time spent [s]",
    "trust": "trust (1 to 7)",
}


def table(pair: Comparison) -> Table:
    """A row a metric."""
    made = _table(f"{pair.second} against {pair.first}: {pair.tasks} tasks, {pair.people} people")
    for heading in (pair.first, pair.second, "difference", "95 % interval", "could have seen", "p", "trials"):
        made.add_column(heading, justify="right", overflow="fold")
    for metric, found in pair.differences.items():
        adjusted = metric == "sr" and pair.among > 1
        title = _TITLES[metric] + ("*" if adjusted else "")
        made.add_row(title, *_cells(pair.success if adjusted else found, UNITS[metric]))
    return made


def groups_table(pair: Comparison, by: str) -> Table:
    """Success by kind, split, difficulty or scene."""
    made = _table(f"success rate [%], by {by}")
    for heading in (pair.first, pair.second, "difference", "95 % interval", "could have seen", "p", "trials"):
        made.add_column(heading, justify="right", overflow="fold")
    for name, found in pair.groups[by].items():
        made.add_row(name.replace("_", " "), *_cells(found, "points"))
    return made


def lines(pair: Comparison) -> Iterator[str]:
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


def difference(found: Difference, unit: str) -> str:
    """A difference with its interval, in one line."""
    if found.ci95 is None:
        return f"{_signed(found.difference, unit)} {unit}".rstrip()
    low, high = (_signed(end, unit) for end in found.ci95)
    return f"{_signed(found.difference, unit)} {unit} (95 % interval {low} to {high}, {found.n} trials)"


def _cells(found: Difference, unit: str) -> Iterator[str]:
    yield from (_plain(found.first, unit), _plain(found.second, unit), _signed(found.difference, unit))
    yield "–" if found.ci95 is None else " … ".join(_signed(end, unit) for end in found.ci95)
    yield result_tables.least(found.mde80, 100.0 if unit == "points" else 1.0, room=unit == "points")
    yield "–" if found.p is None else ("< 0.001" if found.p < 0.001 else f"{found.p:.3f}")
    yield str(found.n)


def _chance(p: float) -> str:
    return "< 0.001" if p < 0.001 else f"= {p:.3f}"


def _plain(value: float, unit: str) -> str:
    return f"{100.0 * value:.1f}" if unit == "points" else f"{value:.1f}"


def _signed(value: float, unit: str) -> str:
    return f"{100.0 * value:+z.1f}" if unit == "points" else f"{value:+z.1f}"


def _table(title: str) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("", overflow="fold")
    return table
