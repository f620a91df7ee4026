"""Trust over the trials of a session."""

from collections.abc import Mapping

from hthor import rules
from hthor.report.analysis.document import Findings, TrustCurve
from hthor.report.html import elements
from hthor.report.html.elements import Piece, Value
from hthor.report.html.number_format import plain, signed
from hthor.report.page import sentences
from hthor.report.page.figures import trust

TITLE = "Trust"
_HEAD = ("robot", "people", "after the first trial", "after the last trial", "slope [points a trial]")


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    if not found.trust:
        return [elements.paragraph("Nobody rated a robot in these runs.")]
    rows: list[list[Piece]] = [
        [
            one.arm,
            str(max(one.people)),
            _with_interval(one, 0),
            _with_interval(one, -1),
            "–" if one.slope is None else f"{signed(one.slope, 3)} ± {plain(one.slope_se, 3)}",
        ]
        for one in found.trust
    ]
    cut = (
        ""
        if trust.window(found.trust) == (rules.TRUST_MIN, rules.TRUST_MAX)
        else " The axis shows a part of the scale."
    )
    return [
        elements.paragraph(sentences.trust_trend(found.trust)),
        elements.drawn(
            drawings, "trust", f"Mean rating after each trial of a session; bars and bands are 95 % intervals.{cut}"
        ),
        elements.table(
            _HEAD, rows, "Trust from 1 to 7: means over people with 95 % intervals; slopes ± standard error."
        ),
    ]


def _with_interval(one: TrustCurve, which: int) -> Value:
    return Value(plain(one.mean[which]), f"[{', '.join(plain(end) for end in one.ci95[which])}]")
