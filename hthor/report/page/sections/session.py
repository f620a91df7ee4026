"""A session's course: time spent as in the article's box plots, trust, messages, and being in the way."""

from collections.abc import Iterator, Mapping

from hthor import rules
from hthor.eval.metrics import registry
from hthor.eval.statistics.intervals import NOTHING
from hthor.report.analysis.document import Arm, Findings, TrustCurve
from hthor.report.html import elements
from hthor.report.html.elements import Band, Piece, Value
from hthor.report.html.number_format import plain, signed
from hthor.report.page import sentences, table_cells
from hthor.report.page.figures import session

_TIME_HEAD = ("robot", "trials", "minimum", "lower quartile", "median", "upper quartile", "maximum", "unsolved")
_TRUST_HEAD = ("robot", "sessions", "after the first trial", "after the last trial", "slope [points a trial]")


def time_spent(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section on time spent."""
    rows = [
        [
            one.arm,
            str(one.trials),
            *(f"{value:.1f}" for value in (one.least, one.lower, one.median, one.upper, one.most)),
            f"{one.unsolved} ({100.0 * one.unsolved / one.trials:.0f} %)",
        ]
        for one in found.spent
    ]
    return [
        elements.paragraph(sentences.time_spent(found.spent)),
        elements.drawn(
            drawings,
            "time-spent",
            "Left: minimum, quartiles and maximum of the time spent. Right: share of all trials that were solved by "
            "each second; it ends at the success rate.",
        ),
        elements.table(_TIME_HEAD, rows, "Time spent [s]; an unsolved trial counts with its time limit."),
    ]


def trust(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section on trust."""
    if not found.trust:
        return [elements.paragraph("Nobody rated a robot in these runs.")]
    rows: list[list[Piece]] = [
        [
            one.arm,
            str(max(one.sessions)),
            _with_interval(one, 0),
            _with_interval(one, -1),
            "–" if one.slope is None else f"{signed(one.slope, 3)} ± {plain(one.slope_se, 3)}",
        ]
        for one in found.trust
    ]
    cut = (
        ""
        if session.trust_window(found.trust) == (rules.TRUST_MIN, rules.TRUST_MAX)
        else " The axis shows a part of the scale."
    )
    return [
        elements.paragraph(sentences.trust_trend(found.trust)),
        elements.drawn(
            drawings, "trust", f"Mean rating after each trial of a session; bars and bands are 95 % intervals.{cut}"
        ),
        elements.table(
            _TRUST_HEAD, rows, "Trust from 1 to 7: means over sessions with 95 % intervals; slopes ± standard error."
        ),
    ]


def _with_interval(one: TrustCurve, which: int) -> Value:
    return Value(plain(one.mean[which]), f"[{', '.join(plain(end) for end in one.ci95[which])}]")


def communication(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section on communication."""
    robots = table_cells.robots(found.arms)
    if not robots:
        return [elements.paragraph("There is no robot in these runs.")]
    return [
        elements.paragraph(sentences.messages(robots)),
        elements.drawn(
            drawings,
            "channel",
            "Left: messages a trial by what became of them. Middle: when the first message was sent that was true and "
            "that a person accepted, over the trials that had one. Right: messages that came up before a person's "
            "eyes. Bars: 95 % intervals.",
        ),
        elements.table(
            ("messages", *(arm.label for arm in robots)),
            _rows(robots, "messages"),
            f"The robots' messages as a channel; means over trials. {table_cells.NOTE}",
        ),
        elements.table(
            ("", *(arm.label for arm in found.arms)),
            [*_rows(found.arms, "bodies"), *_rows_by_seat(found.arms)],
            "Idle time of people, and how much people and robots were in each other's way; means over trials, "
            "brackets and second lines as before.",
        ),
    ]


def _rows(arms: tuple[Arm, ...], section: str) -> Iterator[list[Piece]]:
    """A row for each metric of a section for which at least one run has a value."""
    for metric in registry.SINGLE:
        own = metric.section or ("" if metric.main else "bodies")
        if own == section and any(arm.scores[metric.name].n for arm in arms):
            cells = (table_cells.estimate(arm.scores[metric.name], metric.unit, metric.decimals) for arm in arms)
            yield [f"{'… ' if metric.part_of else ''}{metric.heading}", *cells]


def _rows_by_seat(arms: tuple[Arm, ...]) -> Iterator[list[Piece] | Band]:
    """For each metric that has values by seat, its name, and below it a row for each seat or pair of seats."""
    for metric in registry.BY_SEAT:
        estimates = [arm.scores.by_seat(metric.name) for arm in arms]
        seats = dict.fromkeys(seat for by_seat in estimates for seat in by_seat)
        if seats:
            yield Band(metric.heading)
        for seat in seats:
            cells = (by_seat.get(seat, NOTHING) for by_seat in estimates)
            yield [seat, *(table_cells.estimate(one, metric.unit, metric.decimals) for one in cells)]
