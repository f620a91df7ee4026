"""Draws one trial from above: the paths of people and robots, and those of the same people without a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor.eval.records.trial_record import TrialRecord
from hthor.report.drawing import floor_plan, text_fit, trial_figure, trial_legend, trial_trace
from hthor.report.html import matplotlib_svg
from hthor.types import HouseSpec, is_person

if TYPE_CHECKING:
    from collections.abc import Collection

_WIDE, _HIGH = 3.5, 2.75
_DASH = (0, (2, 2))


def figure(record: TrialRecord, house: HouseSpec, alone: TrialRecord | None) -> Figure:
    """A small plan; all plans have one size, whatever the house.

    Args:
        alone: the trial of the same people at the same task without a robot, if there is one.
    """
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(_HIGH, _WIDE)
        made.set_facecolor("white")  # a plan's colours are those of light paper
        ax = made.subplots()
        floor_plan.draw_house(ax, house, marked=trial_trace.destinations(record.spec, house), small=True)
        if alone is not None:
            for seat in alone.paths:
                way = trial_trace.points(alone.log, seat)
                ax.plot(way[:, 0], way[:, 1], color=trial_trace.INK, lw=0.8, ls=_DASH, alpha=0.7, zorder=7.5)
        for seat in record.paths:
            trial_figure.draw_path(ax, record.log, seat, words=False)
        for _, start in trial_trace.targets(record.spec, house):
            trial_trace.draw_mark(ax, start.position, "*", 95, trial_trace.TARGET, 0.6, 12)
        trial_figure.draw_messages(ax, record.log, arrows=False)
    return made


def legend(seats: Collection[str], *, alone: bool, destined: bool, failed: bool = False) -> Figure:
    """The legend that all these plans share.

    Args:
        seats: those that are drawn. alone: whether paths without a robot are drawn. destined: whether destinations
        are drawn. failed: whether the agent of a seat failed.
    """
    ways = [trial_legend.line(trial_trace.seat_colour(seat), trial_trace.seat_name(seat, seats)) for seat in seats]
    if alone:
        who = "person alone" if sum(map(is_person, seats)) == 1 else "people without robots"
        ways.append(Line2D([], [], color=trial_trace.INK, lw=0.9, ls=_DASH, label=f"the same {who}"))
    marks = [
        trial_legend.mark("o", "white", "start", edge=matplotlib_svg.SOFT),
        trial_legend.mark("o", matplotlib_svg.SOFT, "end"),
        trial_legend.mark("*", trial_trace.TARGET, "target at the start", size=9),
        trial_legend.mark("o", trial_trace.MESSAGE, "message, accepted"),
        trial_legend.mark("o", trial_trace.IDLE_MESSAGE, "message, not accepted"),
    ]
    if failed:
        marks.append(trial_legend.mark("X", trial_trace.FAILED, "the agent failed", size=7.5))
    if destined:
        marks.append(trial_legend.destination())
    handles = [*ways, *marks]
    columns = -(-len(handles) // 2)
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(0.5)
        made.set_facecolor("white")  # as the plans have it
        text_fit.legend(
            made, handles, columns, loc="center left", columnspacing=1.6, handlelength=1.8, labelcolor=trial_trace.INK
        )
    return made
