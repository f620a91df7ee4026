"""Estimates and differences as table cells: number, interval, and below them n and the detectable difference."""

from hthor.eval.metrics.metric import SHARE, Metric, Unit
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import Estimate
from hthor.report.analysis.document import Arm, Share
from hthor.report.html.elements import Piece, Value
from hthor.report.html.number_format import plain, signed

NOTE = (
    "In brackets: 95 % interval, for new tasks and new people of the same populations. Below: n, the number of trials "
    "that have the value, and mde, the smallest difference from a given number that so many trials would have seen in "
    "four of five cases."
)
"""Explains the cells of `estimate`."""


def estimate(one: Estimate, unit: Unit = SHARE, decimals: int = 1) -> Piece:
    """A mean: "66.7 [45.1, 85.0]", and below "n 60 · mde 9.1"."""
    if one.mean is None:
        return "–"
    interval = "" if one.ci95 is None else f"[{', '.join(plain(unit.scale * end, decimals) for end in one.ci95)}]"
    return Value(plain(unit.scale * one.mean, decimals), interval, _note(one.n, one.mde80, unit, decimals))


def difference(one: Difference | None, metric: Metric) -> Piece:
    """An improvement with its sign; for a metric where lower is better, it is positive if the value became lower."""
    if one is None:
        return "–"
    scale = metric.sign * metric.unit.scale
    ends = None if one.ci95 is None else sorted(scale * end for end in one.ci95)
    interval = "" if ends is None else f"[{', '.join(map(signed, ends))}]"
    return Value(signed(scale * one.difference), interval, _note(one.n, one.mde80, metric.unit, 1))


def share(value: float | None, of: Share | None) -> Piece:
    """A published figure, with an interval if its counts were published."""
    if value is None:
        return ""
    if of is None:
        return plain(100.0 * value, 1)
    interval = ", ".join(plain(100.0 * end, 1) for end in of.ci95)
    return Value(plain(100.0 * value, 1), f"[{interval}]", f"n {of.n}{', inferred' if of.inferred else ''}")


def p_value(p: float | None) -> str:
    """A probability, as scientific papers print it."""
    return "–" if p is None else "< 0.001" if p < 0.001 else f"{p:.3f}"


def robots(arms: tuple[Arm, ...]) -> tuple[Arm, ...]:
    """The runs that have robots."""
    return tuple(arm for arm in arms if arm.scores["sent"].n)


def _note(n: int, mde80: float | None, unit: Unit, decimals: int) -> str:
    if not mde80:  # too few trials, or all alike: chance cannot be measured
        return f"n {n}"
    if unit == SHARE and mde80 >= 1.0:
        return f"n {n} · mde > 100"
    return f"n {n} · mde {plain(unit.scale * mde80, decimals)}"
