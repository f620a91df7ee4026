"""Results as tables for people; computes nothing but differences of what is already known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hthor.eval.score import Result
from hthor.eval.stats import Estimate

if TYPE_CHECKING:
    from rich.table import Table

_ROWS = (
    ("sr", "success rate", "%"),
    ("twsr", "time-weighted success", "%"),
    ("adoption", "adoption", "%"),
    ("time_s", "time spent", "s"),
    ("trust", "trust (1 to 7)", ""),
)


def result_table(result: Result) -> Table:
    """One run: a row a metric."""
    table = _table(f"{result.agent.name}: {result.suite.name}, {result.counts.trials} trials, {result.human} people")
    for heading in ("mean", "95 % interval", "trials"):
        table.add_column(heading, justify="right")
    for name, title, unit in _ROWS:
        estimate: Estimate = getattr(result.metrics, name)
        table.add_row(title, number(estimate, unit), interval(estimate, unit), str(estimate.n))
    return table


def comparison_table(results: Sequence[Result]) -> Table:
    """Several runs: a column a run, the mean with its interval below."""
    first = results[0]
    table = _table(f"{first.suite.name}, {first.counts.trials} trials, {first.human} people (95 % interval)")
    for result in results:
        table.add_column(result.agent.name, justify="right")
    for name, title, unit in _ROWS:
        table.add_row(title, *(_cell(getattr(result.metrics, name), unit) for result in results))
    if any(result.counts.faults for result in results):
        table.add_row("trials with a fault", *(str(result.counts.faults) for result in results))
    return table


def number(estimate: Estimate, unit: str) -> str:
    """The mean with its unit; a dash where there is none."""
    return "–" if estimate.mean is None else f"{_scaled(estimate.mean, unit)}{' ' if unit else ''}{unit}"


def interval(estimate: Estimate, unit: str) -> str:
    """The interval without its unit; a dash where there is none."""
    if estimate.ci95 is None:
        return "–"
    low, high = estimate.ci95
    return f"{_scaled(low, unit)} … {_scaled(high, unit)}"


def _cell(estimate: Estimate, unit: str) -> str:
    return "–" if estimate.mean is None else f"{number(estimate, unit)}\n{interval(estimate, unit)}"


def _scaled(value: float, unit: str) -> str:
    return f"{value * 100.0:.1f}" if unit == "%" else f"{value:.1f}"


def _table(title: str) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    return table
