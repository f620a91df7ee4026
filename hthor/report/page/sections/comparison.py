"""Runs against each other and against no robot, trial by trial."""

from collections.abc import Mapping

from hthor.eval.comparison.compare import Comparison
from hthor.eval.metrics import registry
from hthor.eval.results import result_file
from hthor.report.analysis.document import Findings
from hthor.report.html import elements
from hthor.report.html.elements import Piece, Value
from hthor.report.page import headline, sentences, table_cells

TITLE = "Paired comparisons"
_SHORT = 24
"""Names up to so long stand in one line."""
_COLUMNS = (
    "Below: n, the trials that both runs share, and mde, the smallest true difference that these would have seen in "
    "four of five cases. Won: only the robot that is named first succeeded; lost: only the other; with the exact "
    "McNemar test of that. Tied: both succeeded, or neither did. p (Holm): two-sided, of no difference in success, "
    "adjusted for all comparisons here."
)
_HEAD = ("", *(registry.get(name).gain for name in result_file.UPLIFT_METRICS), "won : lost", "tied", "p (Holm)")


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    said = [elements.paragraph(sentences.without_baseline(found))] if not found.baseline else []
    apart = [elements.bullets([sentences.not_comparable(one) for one in found.apart])] if found.apart else []
    if not found.comparisons:
        return [*said, *apart]
    return [
        *said,
        elements.bullets([sentences.comparison_sentence(pair) for pair in headline.notable_comparisons(found)]),
        elements.drawn(
            drawings,
            "compared",
            "Differences trial by trial: the same person with the same task at the same point of the session. Right of "
            f"the line the robot that is named first is better. Bars: {_bars(found)}.",
        ),
        elements.table(
            _HEAD, [_row(pair) for pair in found.comparisons], f"The same in numbers. {_intervals(found)} {_COLUMNS}"
        ),
        *apart,
    ]


def _among(found: Findings) -> int:
    return max(pair.among for pair in found.comparisons)


def _bars(found: Findings) -> str:
    among = _among(found)
    return "95 % intervals" + (f", those of success adjusted for {among} comparisons" if among > 1 else "")


def _intervals(found: Findings) -> str:
    """What the brackets say."""
    among = _among(found)
    if among == 1:
        return "In brackets: 95 % interval."
    return (
        f"In brackets: 95 % interval; that of success is adjusted for {among} comparisons, as its p is, and leaves out "
        "0 exactly where one robot is better. The others stand each for itself."
    )


def _row(pair: Comparison) -> list[Piece]:
    only = pair.mcnemar
    told = f"p {'' if only.p < 0.001 else '= '}{table_cells.p_value(only.p)}"
    name = f"{pair.second} − {pair.first}"
    return [
        name.replace(" ", "\u00a0") if len(name) <= _SHORT else name,
        *(
            table_cells.difference(pair.success if name == "sr" else pair.differences.get(name), registry.get(name))
            for name in result_file.UPLIFT_METRICS
        ),
        Value(f"{only.only_second} : {only.only_first}", "", told),
        str(pair.n - only.only_first - only.only_second),
        table_cells.p_value(pair.p_holm),
    ]
