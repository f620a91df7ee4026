"""Draws how well robots find things, from the file of `hthor train eval --out`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from hthor import documents
from hthor.errors import HthorError
from hthor.report.drawing import figure_file
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures.run_styles import RunStyle, interval
from hthor.train.comparison import Comparison, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NETWORK = RunStyle(shade="#2f9270", shape="o")
_WITHOUT = RunStyle(shade="#7d7d7d", shape="s")
_ROW_IN, _REST_IN = 0.26, 0.62


def write(path: Path, source: Path) -> None:
    """Draw the comparison in the file ``source``."""
    figure_file.write_figure(draw(documents.read(source, Comparison, HthorError)), path)


def draw(found: Comparison) -> Figure:
    """Success in new houses with 95 % intervals, for each kind of zones; hollow marks are of houses of training."""
    zones = tuple(dict.fromkeys(row.zones for row in found.rows))
    names = list(dict.fromkeys(row.robot for row in found.rows))
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(_REST_IN + _ROW_IN * len(names))
        panels = made.subplots(1, len(zones), sharey=True, squeeze=False)[0]
        for ax, zone in zip(panels, zones, strict=True):
            matplotlib_svg.quiet_axes(ax)
            ax.set_title(f"success in {zone} [%]")
            ax.set_xlim(-3.0, 103.0)
            for row in found.rows:
                if row.zones == zone:
                    _draw_row(ax, names.index(row.robot), row, found)
        panels[0].set_yticks(range(len(names)), names)
        panels[0].set_ylim(len(names) - 0.45, -0.55)
    return made


def _draw_row(ax: Axes, y: int, row: Row, found: Comparison) -> None:
    style = _NETWORK if row.robot.split(",")[0] in found.checkpoints else _WITHOUT
    mean = 100.0 * (row.success.mean or 0.0)
    if row.split == "train":
        ax.plot(mean, y, style.shape, mfc="none", mec=style.shade, ms=5.4, zorder=2)
        return
    ends = None if row.success.ci95 is None else [100.0 * end for end in row.success.ci95]
    interval(ax, y, mean, ends, style)
