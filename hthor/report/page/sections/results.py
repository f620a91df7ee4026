"""Tables that compare runs with the baselines and the article, and with each other trial by trial."""

from collections.abc import Iterator, Mapping

from hthor.eval.comparison.comparison import Comparison
from hthor.eval.metrics import registry
from hthor.eval.results import result_file
from hthor.report.analysis.document import Findings
from hthor.report.html import elements
from hthor.report.html.elements import Band, Piece, Value
from hthor.report.page import headline, sentences, table_cells

_PUBLISHED = {"none": "no robot", "frontier": "frontier", "oracle": "oracle"}
_SHORT = 24
"""Names up to this long stand in one line."""
_COLUMNS = (
    "Below: n, the trials that both runs share (or have together, where their people differ), and mde, the smallest "
    "true difference that these would have seen in four of five cases. Won: only the robot that is named first "
    "succeeded; lost: only the other; with the exact McNemar test of that. Tied: both succeeded, or neither did. "
    "p (Holm): two-sided, of no difference in success, adjusted for all comparisons here."
)
_PAIR_HEAD = ("", *(registry.get(name).gain for name in result_file.UPLIFT_METRICS), "won : lost", "tied", "p (Holm)")


def scores(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section on scores."""
    metrics = [metric for metric in registry.MAIN if any(arm.scores[metric.name].n for arm in found.arms)]
    rows: list[list[Piece] | Band] = []
    if found.published is not None:
        rows.append(Band(f"These runs: {found.suite.name}, {found.people} people"))
    for arm in found.arms:
        estimates = (table_cells.estimate(arm.scores[one.name], one.unit, one.decimals) for one in metrics)
        rows.append([arm.label, *estimates])
    rows += _published(found, [metric.name for metric in metrics])
    head = ("robot", *(metric.heading for metric in metrics))
    return [
        elements.table(head, rows, f"Means over trials. {table_cells.NOTE}"),
        elements.paragraph(sentences.published_figures(found)),
        elements.drawn(
            drawings,
            "scores",
            "Success, time-weighted success and adoption, with 95 % intervals. "
            + ("Open diamonds: what the article printed for the same kind of robot." if found.published else ""),
        ),
    ]


def _published(found: Findings, metrics: list[str]) -> Iterator[list[Piece] | Band]:
    """The rows of the article's figures."""
    study = found.published
    if study is None:
        return
    rows: list[list[Piece]] = []
    for condition, name in _PUBLISHED.items():
        figures = [f"{metric} {condition}" for metric in metrics]
        if any(one in study.figures for one in figures):
            rows.append([name, *(table_cells.share(study.figures.get(one), study.counts.get(one)) for one in figures)])
    trials = sum(one.n for name, one in study.counts.items() if name.startswith("sr "))
    yield Band(f"Published: {study.source.partition(':')[0]}, people in {trials} trials")
    yield from rows


def comparison(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section on comparisons."""
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
            f"{_compared(found)} Right of the line the robot that is named first is better. Bars: {_bars(found)}.",
        ),
        elements.table(
            _PAIR_HEAD,
            [_pair_row(pair) for pair in found.comparisons],
            f"The same in numbers. {_intervals(found)} {_COLUMNS}",
        ),
        *apart,
    ]


def _compared(found: Findings) -> str:
    """What is compared with what."""
    if any(pair.groups_of for pair in found.comparisons):
        return (
            "Differences between groups of a between-subjects study: each robot met other people, who did the same "
            "tasks, so that no trial has a partner."
        )
    return "Differences trial by trial: the same people with the same task at the same point of the session."


def _among(found: Findings) -> int:
    return max(pair.among for pair in found.comparisons)


def _bars(found: Findings) -> str:
    among = _among(found)
    return "95 % intervals" + (f", those of success adjusted for {among} comparisons" if among > 1 else "")


def _intervals(found: Findings) -> str:
    """What the brackets in the table mean."""
    among = _among(found)
    if among == 1:
        return "In brackets: 95 % interval."
    return (
        f"In brackets: 95 % interval; that of success is adjusted for {among} comparisons, as its p is, and leaves out "
        "0 exactly where one robot is better. The others stand each for itself."
    )


def _pair_row(pair: Comparison) -> list[Piece]:
    only = pair.mcnemar
    told = "" if only is None else f"p {'' if only.p < 0.001 else '= '}{table_cells.p_value(only.p)}"
    name = f"{pair.second} − {pair.first}"
    return [
        name.replace(" ", "\u00a0") if len(name) <= _SHORT else name,
        *(
            table_cells.difference(pair.success if name == "sr" else pair.differences.get(name), registry.get(name))
            for name in result_file.UPLIFT_METRICS
        ),
        Value("–" if only is None else f"{only.only_second} : {only.only_first}", "", told),
        "–" if only is None else str(pair.n - only.only_first - only.only_second),
        table_cells.p_value(pair.p_holm),
    ]
