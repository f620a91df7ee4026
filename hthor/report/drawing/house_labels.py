"""Names of rooms and a scale on a picture of a house from above; renders nothing itself."""

from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from hthor.report.drawing import floor_plan, lettering, trial_trace
from hthor.types import HouseSpec

_DPI, _STRIP_PX = 100, 34
_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.6, foreground="white")]
_TITLE_CHARACTERS = 8.0
"""Pixels that a character of the title takes, about."""


@lettering.plain_lettering()
def with_labels(
    picture: Any, house: HouseSpec, bounds: tuple[float, float, float, float], *, named: bool = True
) -> Any:
    """The picture with rooms named on their barest floor, and a strip below with a scale and the house's name.

    Args:
        picture: (H, W, 3) uint8, north up. bounds: x0, y0, x1, y1 [m] that it covers. named: whether rooms are named.
    """
    high, wide = picture.shape[:2]
    x0, y0, x1, y1 = bounds
    sheet = Figure(figsize=(wide / _DPI, (high + _STRIP_PX) / _DPI), dpi=_DPI, facecolor="white")
    canvas = FigureCanvasAgg(sheet)
    ax = sheet.add_axes((0.0, _STRIP_PX / (high + _STRIP_PX), 1.0, high / (high + _STRIP_PX)))
    ax.imshow(picture, extent=(x0, x1, y0, y1), interpolation="none", aspect="auto")
    ax.axis("off")
    for room in house.rooms if named else ():
        at = floor_plan.quiet_spot(room, house)
        text = ax.text(
            *at, room.name or room.kind, ha="center", va="center", fontsize=9, weight="bold", color=trial_trace.INK
        )
        text.set_path_effects(_STROKE)
    strip = sheet.add_axes((0.0, 0.0, 1.0, _STRIP_PX / (high + _STRIP_PX)))
    strip.set_xlim(x0, x1)
    strip.set_ylim(0.0, 1.0)
    strip.axis("off")
    edge = 12.0 * (x1 - x0) / wide
    strip.plot((x0 + edge, x0 + edge + 1.0), (0.5, 0.5), color=trial_trace.INK, lw=2.0, solid_capstyle="butt")
    strip.text(x0 + 1.6 * edge + 1.0, 0.5, "1 m", va="center", fontsize=9, color=trial_trace.INK)
    if wide > 160 + _TITLE_CHARACTERS * len(house.id):
        xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
        words = f"{house.id}, {max(xs) - min(xs):.1f} × {max(ys) - min(ys):.1f} m"
        strip.text(x1 - edge, 0.5, words, ha="right", va="center", fontsize=9, color=trial_trace.INK)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
