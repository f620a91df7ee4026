"""Runs against each other and against no robot, trial by trial."""

from __future__ import annotations

from collections.abc import Mapping

from hthor.eval.compare import Comparison
from hthor.eval.pages import cells, html, verdict, words
from hthor.eval.pages.findings import Findings
from hthor.eval.pages.html import Piece, Value

TITLE = "Paired comparisons"
_SHORT = 24
"""Names up to so long stand in one line."""
_HEAD = ("", "success [points]", "time-weighted [points]", "time saved [s]", "won : lost", "tied", "p (Holm)")


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    said = [html.paragraph(words.alone())] if not found.baseline else []
    apart = [html.bullets([words.apart(one) for one in found.apart])] if found.apart else []
    if not found.comparisons:
        return [*said, *apart]
    return [
        *said,
        html.bullets([words.sentence(pair) for pair in verdict.worth_telling(found)]),
        html.drawn(
            drawings,
            "compared",
            "Differences trial by trial: the same person, on the same day, at the same task. Right of the line the "
            "robot that is named first is better. Bars: 95 % intervals.",
        ),
        html.table(
            _HEAD,
            [_row(pair) for pair in found.comparisons],
            f"The same in numbers. {cells.PAIRED_NOTE} Won: only the robot that is named first succeeded; lost: only "
            "the other; with the exact McNemar test of that. Tied: both succeeded, or neither did. p (Holm): "
            "two-sided, of no difference in success, adjusted for all comparisons here.",
        ),
        *apart,
    ]


def _row(pair: Comparison) -> list[Piece]:
    only = pair.mcnemar
    told = f"p {'' if only.p < 0.001 else '= '}{cells.p_value(only.p)}"
    name = f"{pair.second} − {pair.first}"
    return [
        name.replace(" ", "\u00a0") if len(name) <= _SHORT else name,
        cells.difference(pair.differences.get("sr")),
        cells.difference(pair.differences.get("twsr")),
        cells.difference(pair.differences.get("time_s"), -1.0),
        Value(f"{only.only_second} : {only.only_first}", "", told),
        str(pair.n - only.only_first - only.only_second),
        cells.p_value(pair.p_holm),
    ]
