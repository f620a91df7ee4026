"""Draws on a trial's time axis when panel and map of each person were shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.lines import Line2D

from hthor import rules
from hthor.comms import display
from hthor.comms.display import Part
from hthor.episode import EpisodeLog
from hthor.types import is_person

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_SHADES: dict[Part, str] = {"panel": "#7a3b8f", "map": "#2a9d8f"}
_BELOW: dict[Part, float] = {"panel": 0.20, "map": 0.34}
"""How far below a person's row the bar of each part is, in rows."""
_LINE_PT = 2.0


def draw_bars(ax: Axes, log: EpisodeLog, seat: str, row: float) -> None:
    """Draw a bar for each span in which a part of the person's display was shown; nothing for a robot."""
    if not is_person(seat):
        return
    for part, spans in display.shown_spans(log.events, seat, log.ticks).items():
        for begin, end in spans:
            times, height = (begin * rules.TICK_S, end * rules.TICK_S), row - _BELOW[part]
            ax.plot(times, (height, height), color=_SHADES[part], lw=_LINE_PT, solid_capstyle="butt", zorder=4)


def legend_entries(log: EpisodeLog) -> list[Artist]:
    """Legend entries for the parts that anybody had shown."""
    people = [seat for seat in log.paths if is_person(seat)]
    found = [display.shown_spans(log.events, seat, log.ticks) for seat in people]
    return [
        Line2D([], [], color=_SHADES[part], lw=_LINE_PT, label=f"{part} shown")
        for part in display.PARTS
        if any(spans[part] for spans in found)
    ]
