"""Results as tables for people; computes nothing but differences of what is already known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from hthor.eval.config.robot_team import NO_ROBOT, NO_ROBOT_AGENT
from hthor.eval.config.run_config import REALTIME
from hthor.eval.results.paired_difference import Difference
from hthor.eval.results.result_file import RunResult, Scores
from hthor.eval.statistics.intervals import Estimate

if TYPE_CHECKING:
    from rich.table import Table

    from hthor.eval.comparison.population_matrix import PopulationMatrix

Row = tuple[str, str, Estimate]
"""Title, unit and value."""

_MAIN = (
    ("sr", "success rate", "%"),
    ("twsr", "time-weighted success", "%"),
    ("progress", "progress", "%"),
    ("adoption", "adoption", "%"),
    ("time_s", "time spent", "s"),
    ("trust", "trust (1 to 7)", ""),
)
_MORE = (
    ("idle_s", "person idle", "s"),
    ("in_way", "bodies in the way, a trial", ""),
    ("hindered_s", "person hindered", "s"),
    ("sent", "messages sent, a trial", ""),
    ("accepted", "  accepted", ""),
    ("declined", "  declined", ""),
    ("covered", "  covered by a newer one", ""),
    ("unanswered", "  unanswered", ""),
    ("false_claims", "messages that were false", ""),
    ("precision", "true among its claims", "%"),
    ("first_useful_s", "first useful message after", "s"),
    ("interruptions_per_min", "messages shown, a minute", ""),
    ("useful", "messages confirmed that were true and new, a trial", ""),
    ("usefulness", "true and new among the confirmed", "%"),
)
_UPLIFT = (
    ("sr", "success rate", "points"),
    ("twsr", "time-weighted success", "points"),
    ("time_s", "time spent", "s"),
)
_ONLY_WHERE_KNOWN = ("progress",)
MAIN = tuple(name for name, _, _ in _MAIN)
"""The metrics that every table of results has."""


def result_table(result: RunResult, *, everything: bool = False) -> Table:
    """One run: a row a metric.

    Args:
        everything: with all that is counted, not only the main metrics.
    """
    title = f"{result.label}: {result.suite.name}, {result.counts.trials} trials, {result.humans.name} people"
    table = _table(title + (", in real time" if result.mode == REALTIME else ""))
    for heading in ("mean", "95 % interval", "could have seen", "trials"):
        table.add_column(heading, justify="right", overflow="fold")
    later = enumerate(result.trust_by_trial if everything else (), 1)
    rated = ((f"trust after a person's trial {number}", "", estimate) for number, estimate in later)
    for title, unit, estimate in (*_rows(result.metrics, everything), *rated):
        seen = detectable(estimate, unit)
        table.add_row(title, number(estimate, unit), interval(estimate, unit), seen, str(estimate.n))
    for name, title, unit in _UPLIFT if result.uplift else ():
        gain: Difference = getattr(result.uplift, name)
        ends = "–" if gain.ci95 is None else " … ".join(_gain(end, unit) for end in gain.ci95)
        seen = least(gain.mde80, 100.0 if unit == "points" else 1.0, room=unit == "points")
        table.add_row(f"uplift: {title}", f"{_gain(gain.difference, unit)} {unit}", ends, seen, str(gain.n))
    return table


def notes(results: Iterable[RunResult]) -> Iterator[str]:
    """What a reader of these results' tables has to know beside their numbers, each thing once."""
    held = list(results)
    outside = dict.fromkeys(note for result in held for note in result.humans.notes)
    if outside:
        yield (
            f"note: {'; '.join(outside)}. Robots can be compared with each other; absolute figures are less certain "
            "than their intervals."
        )
    for result in held:
        if result.uplift is not None and result.uplift.note:
            yield f"note: uplift of {result.label}: {result.uplift.note}."


def kinds_table(result: RunResult) -> Table:
    """One run of several kinds of task: a column a kind, the main metrics with their intervals below."""
    table = _table(f"{result.label}: by kind of task (95 % interval)")
    for kind in result.by_kind:
        table.add_column(kind.replace("_", " "), justify="right", overflow="fold")
    for name, title, unit in _MAIN:
        estimates = [getattr(scores, name) for scores in result.by_kind.values()]
        if any(estimate.n for estimate in estimates) or name not in _ONLY_WHERE_KNOWN:
            table.add_row(title, *(_cell(estimate, unit) for estimate in estimates))
    return table


def comparison_table(results: Sequence[RunResult]) -> Table:
    """Several runs: a column a run, the mean with its interval below."""
    first = results[0]
    title = f"{first.suite.name}, {first.counts.trials} trials, {first.humans.name} people (95 % interval)"
    table = _table(title)
    for result in results:
        table.add_column(result.label, justify="right", overflow="fold")
    for name, title, unit in _MAIN:
        estimates = [getattr(result.metrics, name) for result in results]
        if any(estimate.n for estimate in estimates) or name not in _ONLY_WHERE_KNOWN:
            table.add_row(title, *(_cell(estimate, unit) for estimate in estimates))
    if any(result.uplift for result in results):
        table.add_row("uplift of success", *(_uplift_cell(result) for result in results))
    if any(result.counts.faults for result in results):
        table.add_row("trials with a fault", *(str(result.counts.faults) for result in results))
    return table


def peoples_table(matrix: PopulationMatrix) -> Table:
    """Agents with several peoples: a row a people, three columns an agent, the worst of each agent marked."""
    table = _table(f"{matrix.suite.name}, {matrix.trials} trials with each people")
    for agent in map(_called, matrix.agents):
        for heading in (f"{agent}\nsuccess %", "\nTWSR %", "\nadoption %"):
            table.add_column(heading, justify="right", overflow="fold")
    for people in matrix.peoples:
        cells: list[str] = []
        for agent, cell in matrix.cells[people.name].items():
            worst = matrix.worst.get(agent)
            mark = "*" if worst is not None and people.name in worst.peoples else ""
            cells += [mark + _bare(cell.sr), _bare(cell.twsr), _bare(cell.adoption)]
        table.add_row(people.name, *cells)
    return table


def worst_lines(matrix: PopulationMatrix) -> Iterator[str]:
    """With whom each agent fares worst, a line an agent."""
    for name, worst in matrix.worst.items():
        agent = _called(name)
        rate, behind = f"{worst.sr * 100.0:.1f} %", f"{worst.behind * 100.0:.1f} points"
        if worst.base in worst.peoples:
            yield f"{agent}: no people are worse off than {worst.base}, success {rate}"
        else:
            yield f"{agent}: * worst with {', '.join(worst.peoples)}: success {rate}, {behind} below {worst.base}"


def _called(agent: str) -> str:
    return NO_ROBOT if agent == NO_ROBOT_AGENT else agent


def _bare(estimate: Estimate) -> str:
    return "–" if estimate.mean is None else _scaled(estimate.mean, "%")


def _rows(scores: Scores, everything: bool) -> Iterator[Row]:
    for name, title, unit in _MAIN + (_MORE if everything else ()):
        estimate: Estimate = getattr(scores, name)
        if estimate.n or name not in _ONLY_WHERE_KNOWN:
            yield title, unit, estimate
    if everything:
        yield from ((f"share of the work: {seat}", "%", estimate) for seat, estimate in scores.work.items())
        yield from ((f"hindered: {pair}", "s", estimate) for pair, estimate in scores.hindered_by.items())


def number(estimate: Estimate, unit: str) -> str:
    """The mean with its unit; a dash where there is none."""
    return "–" if estimate.mean is None else f"{_scaled(estimate.mean, unit)}{' ' if unit else ''}{unit}"


def interval(estimate: Estimate, unit: str) -> str:
    """The interval without its unit; a dash where there is none."""
    if estimate.ci95 is None:
        return "–"
    low, high = estimate.ci95
    return f"{_scaled(low, unit)} … {_scaled(high, unit)}"


def detectable(estimate: Estimate, unit: str) -> str:
    """The smallest difference from a given number that these trials could have seen."""
    return least(estimate.mde80, 100.0 if unit in ("%", "points") else 1.0, room=unit in ("%", "points"))


def least(mde80: float | None, scale: float, *, room: bool) -> str:
    """A smallest difference as a number.

    A dash where the trials are too few to tell, or all alike and no measure of chance.

    Args:
        room: whether it is a share, of which no two are further apart than 100 points.
    """
    if not mde80:
        return "–"
    return "> 100" if room and mde80 > 1.0 else f"{scale * mde80:.1f}"


def _gain(value: float, unit: str) -> str:
    return f"{100.0 * value:+z.1f}" if unit == "points" else f"{value:+z.1f}"


def _cell(estimate: Estimate, unit: str) -> str:
    return "–" if estimate.mean is None else f"{number(estimate, unit)}\n{interval(estimate, unit)}"


def _uplift_cell(result: RunResult) -> str:
    if result.uplift is None or result.uplift.sr.ci95 is None:
        return "–"
    gain = result.uplift.sr
    return f"{_gain(gain.difference, 'points')} points\n" + " … ".join(_gain(end, "points") for end in gain.ci95 or ())


def _scaled(value: float, unit: str) -> str:
    return f"{value * 100.0:.1f}" if unit == "%" else f"{value:.1f}"


def _table(title: str) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("", overflow="fold")
    return table
