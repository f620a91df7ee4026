"""The robots' messages as a channel, and what it costs to have robots around."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hthor.eval.statistics.intervals import NOTHING
from hthor.report.analysis.document import Arm, Findings
from hthor.report.html import html
from hthor.report.html.html import Band, Piece
from hthor.report.page import sentences, table_cells

TITLE = "Communication, and being in the way"
_SAID = (
    ("adoption", "adoption: trials with a confirmed message [%]", 100.0, 1),
    ("usefulness", "true and new among the confirmed [%]", 100.0, 1),
    ("precision", "precision of claims [%]", 100.0, 1),
    ("false_claims", "false claims a trial", 1.0, 2),
    ("first_useful_s", "first useful message [s]", 1.0, 1),
    ("interruptions_per_min", "interruptions a minute", 1.0, 2),
    ("sent", "messages a trial", 1.0, 2),
    ("accepted", "… confirmed", 1.0, 2),
    ("declined", "… declined", 1.0, 2),
    ("covered", "… covered by a newer one", 1.0, 2),
    ("unanswered", "… unanswered", 1.0, 2),
)
_AROUND = (
    ("idle_s", "person idle [s a trial]", 1.0, 1),
    ("hindered_s", "person hindered, by all robots [s a trial]", 1.0, 2),
    ("in_way", "bodies met in each other's way, times a trial", 1.0, 2),
)


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    robots = table_cells.robots(found.arms)
    if not robots:
        return [html.paragraph("There is no robot in these runs.")]
    return [
        html.paragraph(sentences.channel(robots)),
        html.drawn(
            drawings,
            "channel",
            "Left: messages a trial by what became of them. Middle: when the first message was sent that was true and "
            "that the person confirmed, over the trials that had one. Right: messages that came up before the person's "
            "eyes. Bars: 95 % intervals.",
        ),
        html.table(
            ("messages", *(arm.label for arm in robots)),
            _metrics(robots, _SAID),
            f"The robots' messages as a channel; means over trials. {table_cells.NOTE}",
        ),
        html.table(
            ("", *(arm.label for arm in found.arms)),
            _around(found.arms),
            "Idle time of the person, and how much people and robots were in each other's way; means over trials, "
            "brackets and second lines as before.",
        ),
    ]


def _around(arms: tuple[Arm, ...]) -> Iterator[list[Piece] | Band]:
    yield from _metrics(arms, _AROUND)
    for pair in dict.fromkeys(name for arm in arms for name in arm.scores.hindered_by):
        values = (arm.scores.hindered_by.get(pair, NOTHING) for arm in arms)
        title = f"{pair.replace(' by ', ' hindered by ')} [s a trial]"
        yield [title, *(table_cells.estimate(one, 1.0, 2) for one in values)]
    seats = dict.fromkeys(name for arm in arms for name in arm.scores.work)
    if seats:
        yield Band("share of the work that was done")
    for seat in seats:
        yield [f"by {seat} [%]", *(table_cells.estimate(arm.scores.work.get(seat, NOTHING)) for arm in arms)]


def _metrics(arms: tuple[Arm, ...], metrics: tuple[tuple[str, str, float, int], ...]) -> Iterator[list[Piece]]:
    for name, title, scale, digits in metrics:
        if any(getattr(arm.scores, name).n for arm in arms):
            yield [title, *(table_cells.estimate(getattr(arm.scores, name), scale, digits) for arm in arms)]
