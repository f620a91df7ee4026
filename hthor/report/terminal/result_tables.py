"""Results and comparisons of two runs as terminal tables and lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import NUMBER, SHARE, Unit
from hthor.eval.results import result_file
from hthor.eval.results.paired_difference import Difference
from hthor.eval.results.result_file import RunResult
from hthor.eval.results.scores import Scores
from hthor.eval.statistics.intervals import Estimate
from hthor.report.terminal import corrections
from hthor.trials.robot_team import NO_ROBOT, NO_ROBOT_AGENT
from hthor.types.specs import LOCKSTEP

if TYPE_CHECKING:
    from rich.table import Table

    from hthor.eval.comparison.comparison import Comparison
    from hthor.eval.comparison.population_matrix import PopulationMatrix

BETWEEN_WORDS = "between subjects: the two had different people at the same tasks, so no trial has a partner"
Row = tuple[str, Unit, Estimate]
"""Title, unit and value of a metric."""
_HEADINGS = ("difference", "95 % interval", "could have seen", "p", "trials")


def result_table(result: RunResult, *, everything: bool = False) -> Table:
    """One run: one row per metric.

    Args:
        everything: whether to show all metrics, not only the main ones.
    """
    title = f"{result.label}: {result.suite.name}, {result.counts.trials} trials, {result.humans.name} people"
    title += ", between subjects" if result.design else ""
    title += "" if result.mode == LOCKSTEP else f", {result.mode} clock"
    table = new_table(title, "mean", "95 % interval", "could have seen", "trials")
    later = enumerate(result.trust_by_trial if everything else (), 1)
    rated = ((f"trust after a participant's trial {number}", NUMBER, estimate) for number, estimate in later)
    for title, unit, estimate in (*_rows(result.metrics, everything), *rated):
        seen = format_detectable(estimate.mde80, unit)
        table.add_row(title, format_mean(estimate, unit), format_interval(estimate, unit), seen, str(estimate.n))
    for metric in map(registry.get, result_file.UPLIFT_METRICS if result.uplift else ()):
        gain: Difference = getattr(result.uplift, metric.name)
        ends = "–" if gain.ci95 is None else " … ".join(format_difference(end, metric.unit) for end in gain.ci95)
        mean = f"{format_difference(gain.difference, metric.unit)} {metric.unit.difference}"
        table.add_row(f"uplift: {metric.title}", mean, ends, format_detectable(gain.mde80, metric.unit), str(gain.n))
    return table


def result_notes(results: Iterable[RunResult]) -> Iterator[str]:
    """The notes that a reader of these results' tables needs besides the numbers, each note once."""
    held = list(results)
    outside = dict.fromkeys(note for result in held for note in result.humans.notes)
    if outside:
        yield (
            f"note: {'; '.join(outside)}. Robots can be compared with each other; absolute figures are less certain "
            "than their intervals."
        )
    for result in held:
        if result.counts.voided:
            yield f"note: {voided_words(result.label, result.counts.voided)}."
        if result.corrections:
            yield f"note: {corrections.corrections_note(result.label, result.corrections.count)}."
        yield from _unmeasured_notes(result)
        if result.uplift is not None and result.uplift.note:
            yield f"note: uplift of {result.label}: {result.uplift.note}."


def scoring_note(result: RunResult) -> str:
    """Which code played the trials of a result, and which scoring version judged them."""
    return f"trials of code {result.hashes.code[:10]}, judged by scoring version {result.hashes.scoring[:10]}"


def _unmeasured_notes(result: RunResult) -> Iterator[str]:
    """The metrics that every trial of the run should have, and that some have not."""
    alone, trials = not any(robot.seat for robot in result.robots), result.counts.trials
    for metric in registry.MAIN:
        found = result.metrics[metric.name].n
        if found < trials and not metric.optional and not (metric.needs_robot and alone):
            yield (
                f"note: {result.label}: {metric.title} is measured in {found} of {trials} trials; the others do not "
                "have what it needs."
            )


def voided_words(name: str, count: int) -> str:
    """How many attempts at a run's trials were voided."""
    what = "1 attempt was voided and does" if count == 1 else f"{count} attempts were voided and do"
    return f"{name}: {what} not count; 'hthor runs view' lists the reasons"


def kinds_table(result: RunResult) -> Table:
    """One run of several kinds of task: one column per kind, and the main metrics with intervals below the means."""
    kinds = [kind.replace("_", " ") for kind in result.by_kind]
    table = new_table(f"{result.label}: by kind of task (95 % interval)", *kinds)
    _add_main_rows(table, list(result.by_kind.values()))
    return table


def comparison_table(results: Sequence[RunResult]) -> Table:
    """Several runs: one column per run, with intervals below the means."""
    first = results[0]
    title = f"{first.suite.name}, {first.counts.trials} trials, {first.humans.name} people (95 % interval)"
    table = new_table(title, *(result.label for result in results))
    _add_main_rows(table, [result.metrics for result in results])
    if any(result.uplift for result in results):
        table.add_row("uplift of success", *(_uplift_cell(result) for result in results))
    if any(result.counts.faults for result in results):
        table.add_row("trials with a fault", *(str(result.counts.faults) for result in results))
    return table


def population_table(matrix: PopulationMatrix) -> Table:
    """One row per human population, three columns per agent; each agent's worst population is marked."""
    headings = [
        heading
        for agent in map(_called, matrix.agents)
        for heading in (f"{agent}\nsuccess %", "\nTWSR %", "\nadoption %")
    ]
    table = new_table(f"{matrix.suite.name}, {matrix.trials} trials with each people", *headings)
    for people in matrix.peoples:
        cells: list[str] = []
        for agent, cell in matrix.cells[people.name].items():
            worst = matrix.worst.get(agent)
            mark = "*" if worst is not None and people.name in worst.peoples else ""
            cells += [mark + _bare(cell.sr), _bare(cell.twsr), _bare(cell.adoption)]
        table.add_row(people.name, *cells)
    return table


def worst_population_lines(matrix: PopulationMatrix) -> Iterator[str]:
    """The worst population of each agent, one line per agent."""
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
    return "–" if estimate.mean is None else f"{SHARE.scale * estimate.mean:.1f}"


def _add_main_rows(table: Table, columns: Sequence[Scores]) -> None:
    """Add one row per main metric."""
    for metric in registry.MAIN:
        estimates = [scores[metric.name] for scores in columns]
        if any(estimate.n for estimate in estimates) or not metric.optional:
            table.add_row(metric.title, *(_cell(estimate, metric.unit) for estimate in estimates))


def _rows(scores: Scores, everything: bool) -> Iterator[Row]:
    for metric in registry.SINGLE if everything else registry.MAIN:
        estimate = scores[metric.name]
        if estimate.n or not metric.optional:
            yield ("  " if metric.part_of else "") + metric.title, metric.unit, estimate
    for metric in registry.BY_SEAT if everything else ():
        for seat, estimate in scores.by_seat(metric.name).items():
            yield f"{metric.title}: {seat}", metric.unit, estimate


def format_mean(estimate: Estimate, unit: Unit) -> str:
    """The mean with its unit; a dash if there is no mean."""
    return "–" if estimate.mean is None else f"{unit.scale * estimate.mean:.1f} {unit.name}".rstrip()


def format_interval(estimate: Estimate, unit: Unit) -> str:
    """The interval without its unit; a dash if there is no interval."""
    if estimate.ci95 is None:
        return "–"
    low, high = estimate.ci95
    return f"{unit.scale * low:.1f} … {unit.scale * high:.1f}"


def format_detectable(mde80: float | None, unit: Unit) -> str:
    """The smallest true difference that this many trials would probably detect, as a number.

    A dash if the trials are too few, or all alike, so that chance cannot be measured. Two shares differ by
    100 points at most.
    """
    if not mde80:
        return "–"
    return "> 100" if unit == SHARE and mde80 > 1.0 else f"{unit.scale * mde80:.1f}"


def format_difference(value: float, unit: Unit) -> str:
    """A difference with its sign."""
    return f"{unit.scale * value:+z.1f}"


def new_table(title: str, *headings: str) -> Table:
    """An empty table: a column of titles, then one of numbers for each heading."""
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("", overflow="fold")
    for heading in headings:
        table.add_column(heading, justify="right", overflow="fold")
    return table


def _cell(estimate: Estimate, unit: Unit) -> str:
    return "–" if estimate.mean is None else f"{format_mean(estimate, unit)}\n{format_interval(estimate, unit)}"


def _uplift_cell(result: RunResult) -> str:
    if result.uplift is None or result.uplift.sr.ci95 is None:
        return "–"
    gain = result.uplift.sr
    ends = " … ".join(format_difference(end, SHARE) for end in gain.ci95 or ())
    return f"{format_difference(gain.difference, SHARE)} {SHARE.difference}\n{ends}"


def pair_table(pair: Comparison) -> Table:
    """One row per metric."""
    title = f"{pair.second} against {pair.first}: {pair.tasks} tasks, {pair.people} people"
    table = new_table(title, pair.first, pair.second, *_HEADINGS)
    for name, difference in pair.differences.items():
        metric, adjusted = registry.get(name), name == "sr" and pair.among > 1
        cells = _pair_cells(pair.success if adjusted else difference, metric.unit)
        table.add_row(metric.heading + ("*" if adjusted else ""), *cells)
    return table


def groups_table(pair: Comparison, by: str) -> Table:
    """Success by kind, split, difficulty or scene."""
    table = new_table(f"{registry.get('sr').heading}, by {by}", pair.first, pair.second, *_HEADINGS)
    for name, difference in pair.groups[by].items():
        table.add_row(name.replace("_", " "), *_pair_cells(difference, SHARE))
    return table


def comparison_lines(pair: Comparison) -> Iterator[str]:
    """The rest of a comparison in words, the verdict last."""
    mcnemar, tally = pair.mcnemar, pair.tally
    if pair.groups_of:
        yield BETWEEN_WORDS
    if mcnemar:
        yield (
            f"success in one of the two only: {mcnemar.only_second} times {pair.second}, {mcnemar.only_first} times "
            f"{pair.first}; exact McNemar p {_chance(mcnemar.p)}"
        )
    if tally:
        yield (
            f"{pair.second} was better in time-weighted success in {tally.wins} trials, the same in {tally.ties}, "
            f"worse in {tally.losses}"
        )
    if any(pair.dropped):
        yield f"without a partner: {pair.dropped[0]} trials of {pair.first}, {pair.dropped[1]} of {pair.second}"
    if pair.among > 1:
        yield (
            f"* interval and p are adjusted for {pair.among} comparisons (Holm's method), as the verdict is; the other "
            "rows stand each for itself"
        )
    yield pair.sentence


def _pair_cells(found: Difference, unit: Unit) -> Iterator[str]:
    yield from (f"{unit.scale * value:.1f}" for value in (found.first, found.second))
    yield format_difference(found.difference, unit)
    yield "–" if found.ci95 is None else " … ".join(format_difference(end, unit) for end in found.ci95)
    yield format_detectable(found.mde80, unit)
    yield "–" if found.p is None else ("< 0.001" if found.p < 0.001 else f"{found.p:.3f}")
    yield str(found.n)


def _chance(p: float) -> str:
    return "< 0.001" if p < 0.001 else f"= {p:.3f}"
