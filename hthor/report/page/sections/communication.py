"""The robots' messages, and how much bodies are in each other's way."""

from collections.abc import Iterator, Mapping

from hthor.eval.metrics import registry
from hthor.eval.statistics.intervals import NOTHING
from hthor.report.analysis.document import Arm, Findings
from hthor.report.html import elements
from hthor.report.html.elements import Band, Piece
from hthor.report.page import sentences, table_cells

TITLE = "Communication, and being in the way"


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    robots = table_cells.robots(found.arms)
    if not robots:
        return [elements.paragraph("There is no robot in these runs.")]
    return [
        elements.paragraph(sentences.messages(robots)),
        elements.drawn(
            drawings,
            "channel",
            "Left: messages a trial by what became of them. Middle: when the first message was sent that was true and "
            "that the person confirmed, over the trials that had one. Right: messages that came up before the person's "
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
            "Idle time of the person, and how much people and robots were in each other's way; means over trials, "
            "brackets and second lines as before.",
        ),
    ]


def _rows(arms: tuple[Arm, ...], section: str) -> Iterator[list[Piece]]:
    """A row for each metric of a section that some run has a value of."""
    for metric in registry.SINGLE:
        own = metric.section or ("" if metric.main else "bodies")
        if own == section and any(arm.scores[metric.name].n for arm in arms):
            cells = (table_cells.estimate(arm.scores[metric.name], metric.unit, metric.decimals) for arm in arms)
            yield [f"{'… ' if metric.part_of else ''}{metric.heading}", *cells]


def _rows_by_seat(arms: tuple[Arm, ...]) -> Iterator[list[Piece] | Band]:
    """Below the name of each metric that has values by seat, a row for each seat or pair of seats."""
    for metric in registry.BY_SEAT:
        estimates = [arm.scores.by_seat(metric.name) for arm in arms]
        seats = dict.fromkeys(seat for by_seat in estimates for seat in by_seat)
        if seats:
            yield Band(metric.heading)
        for seat in seats:
            cells = (by_seat.get(seat, NOTHING) for by_seat in estimates)
            yield [seat, *(table_cells.estimate(one, metric.unit, metric.decimals) for one in cells)]
