"""Time spent, as the article's box plots have it."""

from collections.abc import Mapping

from hthor.report.analysis.document import Findings
from hthor.report.html import elements
from hthor.report.page import sentences

TITLE = "Time spent"
_HEAD = ("robot", "trials", "minimum", "lower quartile", "median", "upper quartile", "maximum", "unsolved")


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
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
        elements.table(_HEAD, rows, "Time spent [s]; an unsolved trial counts with its time limit."),
    ]
