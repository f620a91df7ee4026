"""One trial from above: the person's and the robots' ways, and the same person's without a robot."""

from __future__ import annotations

from matplotlib.figure import Figure

from hthor.eval import picture, plan, trace
from hthor.eval.pages import ink
from hthor.eval.record import Record
from hthor.types import HUMAN, HouseSpec

_WIDE = 3.5


def figure(record: Record, house: HouseSpec, alone: Record | None) -> Figure:
    """A small plan.

    Args:
        alone: the trial of the same person at the same task without a robot, if there is one.
    """
    xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
    deep = (max(ys) - min(ys)) / (max(xs) - min(xs))
    with ink.style():
        made = ink.sheet(min(4.4, _WIDE * deep + 0.1), _WIDE)
        made.set_facecolor("white")  # a plan's colours are those of light paper
        ax = made.subplots()
        plan.draw_house(ax, house, marked=trace.destinations(record.spec, house), small=True)
        if alone is not None:
            way = trace.points(alone.log, HUMAN)
            ax.plot(way[:, 0], way[:, 1], color=trace.INK, lw=0.8, ls=(0, (2, 2)), alpha=0.7, zorder=7.5)
        for seat in record.paths:
            picture.draw_path(ax, record.log, seat)
        for _, start in trace.targets(record.spec, house):
            ax.scatter(
                *start.position[:2], s=95, marker="*", color=trace.TARGET, edgecolor="white", linewidths=0.6, zorder=12
            )
        for number, event in enumerate(trace.messages(record.log), 1):
            trace.badge(ax, trace.at(record.log, event.seat, event.tick), str(number), trace.tint(record.log, event))
    return made
