"""Writes a report from the folders of runs: `report.html`, `report.json`, and the figures as SVG and PDF."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from hthor import jsonio
from hthor.errors import HthorError
from hthor.report.analysis import build, load_runs
from hthor.report.analysis.document import Findings, Published
from hthor.report.analysis.load_runs import Run, pairing_key
from hthor.report.drawing import figure_file, render_trial
from hthor.report.html import matplotlib_svg
from hthor.report.page import figure_index, page
from hthor.report.page.figure_index import MapScene


def write_report(
    folders: Sequence[Path], out: Path, published: Published | None = None, *, pdf: bool = False
) -> Findings:
    """Read the runs, find baselines for those that have none, and write the report into ``out``.

    Args:
        folders: of the runs. published: the results that the page compares with. pdf: whether figures are also PDFs.

    Raises:
        RunError: if a run is damaged, or the runs do not belong together.
        HthorError: if ``out`` is a file, or a house has changed since its trial.
    """
    if out.exists() and not out.is_dir():
        raise HthorError(f"{out} is a file; --out takes the report's folder.")
    runs = load_runs.with_baselines(load_runs.load_runs(folders))
    found = build.build_findings(runs, published)
    elements: dict[str, str] = {}
    for one in figure_index.draw_figures(found, list(_scenes(runs, found))):
        elements[one.name] = matplotlib_svg.to_svg(one.figure, one.name, one.words)
        if pdf:
            with matplotlib_svg.style():
                figure_file.write_figure(one.figure, out / "figures" / f"{one.name}.pdf")
    text = page.render(found, elements)
    for name, element in elements.items():
        jsonio.write(out / "figures" / f"{name}.svg", matplotlib_svg.svg_document(element).encode())
    jsonio.write(out / "report.json", jsonio.pretty(found))
    jsonio.write(out / "report.html", text.encode())
    return found


def _scenes(runs: Sequence[Run], found: Findings) -> Iterator[MapScene]:
    """The content of the maps, in the findings' order."""
    own = {run.label: run for run in runs if run.plan.humans.name == found.people}
    alone = own[found.baseline].by_pair if found.baseline else {}
    by_arm = {label: {record.key: record for record in run.records} for label, run in own.items()}
    for one in found.shown:
        record = by_arm[one.arm][one.key]
        yield MapScene(
            record=record,
            alone=alone.get(pairing_key(record)),
            house=render_trial.load_house(own[one.arm].folder, record),
        )
