"""The table against the baselines and the article."""

from collections.abc import Iterator, Mapping

from hthor.eval.metrics import registry
from hthor.report.analysis.document import Findings
from hthor.report.html import elements
from hthor.report.html.elements import Band, Piece
from hthor.report.page import sentences, table_cells

TITLE = "Results"
_PUBLISHED = {"none": "no robot", "frontier": "frontier", "oracle": "oracle"}


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
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
    """The article's rows."""
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
