"""One trial as a figure: the house from above, both paths, the messages and what came of them; simulates nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib import patheffects
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.eval import plan, timeline, trace
from hthor.types import Event, HouseSpec, TrialSpec, Vec2

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.4, foreground="white")]


def figure(spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> Figure:
    """Draw a trial, about 8 inches wide: plan above, timeline below.

    Args:
        spec: the trial. log: what it left behind. house: the house of its task.
    """
    sheet = Figure(figsize=_size(house), dpi=200, layout="constrained")
    above, below = sheet.subplots(2, 1, height_ratios=(_size(house)[1] - 1.5, 1.5))
    destinations = [thing.id for thing in house.things if thing.kind == spec.task.goal.destination]
    plan.draw_house(above, house, marked=destinations)
    _name_destination(above, spec, house)
    for seat in log.paths:
        draw_path(above, log, seat)
    _draw_target(above, spec)
    for number, event in enumerate(trace.messages(log), 1):
        _draw_message(above, log, number, event)
    _draw_acts(above, log)
    above.set_title(_headline(spec, log), fontsize=10, loc="left", color=trace.INK)
    _legend(sheet, spec, log)
    timeline.draw_timeline(below, spec, log)
    return sheet


def draw_path(ax: Axes, log: EpisodeLog, seat: str) -> None:
    """Draw a seat's way: a line that darkens with time, a dot every ten seconds, rings at start and end."""
    way, shade = trace.points(log, seat), trace.colour(seat)
    third = max(1, math.ceil(len(way) / 12))
    for first in range(0, len(way) - 1, third):
        piece = way[first : first + third + 1]
        strength = 0.35 + 0.65 * first / max(1, len(way) - 1)
        ax.plot(piece[:, 0], piece[:, 1], color=shade, lw=1.7, alpha=strength, solid_capstyle="round", zorder=8)
    every = round(10.0 / rules.TICK_S) // rules.LOG_EVERY_TICKS
    dots = way[every::every]
    ax.scatter(dots[:, 0], dots[:, 1], s=9, color=shade, zorder=9, linewidths=0)
    ax.scatter(way[0, 0], way[0, 1], s=46, facecolor="white", edgecolor=shade, linewidths=1.7, zorder=10)
    ax.scatter(way[-1, 0], way[-1, 1], s=46, facecolor=shade, edgecolor="white", linewidths=1.0, zorder=10)


def _draw_target(ax: Axes, spec: TrialSpec) -> None:
    start = next(placed for placed in spec.task.objects if placed.id == spec.task.goal.target)
    x, y, _ = start.position
    ax.scatter(x, y, s=120, marker="*", color=trace.TARGET, edgecolor="white", linewidths=0.8, zorder=12)
    name = ax.annotate(
        plan.title(start.kind),
        (x, y),
        (6, 6),
        textcoords="offset points",
        fontsize=8,
        color=trace.TARGET,
        weight="bold",
        zorder=13,
    )
    name.set_path_effects(_STROKE)


def _name_destination(ax: Axes, spec: TrialSpec, house: HouseSpec) -> None:
    for thing in house.things:
        if thing.kind == spec.task.goal.destination:
            text = ax.annotate(
                plan.title(thing.kind),
                thing.centre[:2],
                ha="center",
                va="center",
                fontsize=7.5,
                color="#00604a",
                zorder=7,
            )
            text.set_path_effects(_STROKE)


def _draw_message(ax: Axes, log: EpisodeLog, number: int, event: Event) -> None:
    here, claim = trace.at(log, event.seat, event.tick), event.data.get("position")
    if claim is not None:
        ax.annotate(
            "",
            (claim[0], claim[1]),
            here,
            arrowprops={
                "arrowstyle": "-|>",
                "color": trace.tint(log, event),
                "lw": 1.0,
                "ls": (0, (3, 2)),
                "shrinkA": 6,
                "shrinkB": 5,
            },
            zorder=11,
        )
    trace.badge(ax, here, str(number), trace.tint(log, event))


def _draw_acts(ax: Axes, log: EpisodeLog) -> None:
    for event in log.events:
        if event.kind in trace.ACTS:
            x, y = trace.at(log, event.seat, event.tick)
            marker = trace.ACTS[event.kind][0]
            ax.scatter(
                x, y, s=40, marker=marker, color=trace.colour(event.seat), edgecolor="white", linewidths=0.8, zorder=11
            )


def _headline(spec: TrialSpec, log: EpisodeLog) -> str:
    agents = ", ".join(robot.agent.name for robot in spec.robots) or "no robot"
    seconds = log.ticks * rules.TICK_S
    end = f"done in {seconds:.1f} s" if log.met else f"not done in {seconds:.0f} s"
    return f"“{spec.task.instruction}”\n{agents}: {end} (T* {spec.task.t_star:.1f} s), {spec.task.id}"


def _legend(sheet: Figure, spec: TrialSpec, log: EpisodeLog) -> None:
    handles = [_line(trace.PERSON, "person")]
    for robot in spec.robots:
        handles.append(_line(trace.colour(robot.seat), f"{robot.seat} ({robot.agent.name})"))
    handles += [
        _mark("o", "white", "start", edge="#555555"),
        _mark("o", "#555555", "end"),
        _mark("*", trace.TARGET, "target at the start", size=9),
    ]
    if spec.task.goal.destination:
        handles.append(_mark("s", "#bfe3d4", "destination", edge="#00795a"))
    if trace.messages(log):
        handles += [
            _mark("o", shade, f"message, {word}", size=7)
            for shade, word in ((trace.MESSAGE, "confirmed"), (trace.IDLE_MESSAGE, "not confirmed"))
            if shade in {trace.tint(log, event) for event in trace.messages(log)}
        ]
    present = {event.kind for event in log.events}
    handles += [_mark(mark, "#555555", f"{verb}") for kind, (mark, verb) in trace.ACTS.items() if kind in present]
    sheet.legend(handles=handles, loc="outside right upper", fontsize=7.5, frameon=False, handlelength=1.6)


def _line(shade: str, label: str) -> Line2D:
    return Line2D([], [], color=shade, lw=2, label=label)


def _mark(marker: str, face: str, label: str, *, edge: str = "white", size: float = 6.5) -> Line2D:
    return Line2D(
        [], [], ls="", marker=marker, markersize=size, markerfacecolor=face, markeredgecolor=edge, label=label
    )


def _size(house: HouseSpec) -> tuple[float, float]:
    corners: Sequence[Vec2] = [point for room in house.rooms for point in room.polygon]
    wide = max(x for x, _ in corners) - min(x for x, _ in corners)
    deep = max(y for _, y in corners) - min(y for _, y in corners)
    width = 8.0
    return (width, max(4.2, (width - 2.0) * deep / wide + 2.4))
