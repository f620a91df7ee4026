"""Draws a task: the house from above, the objects, the start poses and the shortest walk."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from matplotlib import patheffects
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor import catalog
from hthor.eval.task_check.omniscient_solver import PACE_M_S
from hthor.eval.task_check.solution import Solution
from hthor.report.drawing import floor_plan, lettering, text_fit, trial_legend, trial_trace
from hthor.types import HouseSpec, Placement, Pose, TaskSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OTHER = "#6b6f76"
_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.2, foreground="white")]
_APART_M = 0.45
_WIDE_IN, _TITLE_PT = 8.0, 10.0
"""Width of the figure [in], and size of the title's letters [pt]."""


@lettering.plain_lettering()
def task_figure(task: TaskSpec, house: HouseSpec, feat: Solution) -> Figure:
    """Draw a task, about 8 inches wide.

    Args:
        feat: how a person who knows everything does the task.
    """
    xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
    sheet = Figure(figsize=(_WIDE_IN, max(3.6, 6.0 * (max(ys) - min(ys)) / (max(xs) - min(xs)) + 1.0)), dpi=200)
    sheet.set_layout_engine("constrained")
    ax = sheet.subplots()
    wanted = {name for job in task.goal.todo for name in job.destinations}
    floor_plan.draw_house(ax, house, marked=[thing.id for thing in house.things if {thing.id, thing.kind} & wanted])
    ax.plot(*zip(*feat.way, strict=True), color=trial_trace.PEOPLE[0], lw=1.5, ls=(0, (4, 2)), zorder=8)
    if task.goal.route:
        _draw_route(ax, task)
    _draw_objects(ax, task)
    for pose in (task.human_start, *task.other_human_starts):
        _draw_start(ax, pose, 0)
    for number, pose in enumerate(task.robot_starts, 1):
        _draw_start(ax, pose, number)
    title = "\n".join(text_fit.wrapped(line, _WIDE_IN - 0.3, _TITLE_PT) for line in _headline(task, feat))
    sheet.suptitle(title, x=0.015, ha="left", fontsize=_TITLE_PT, color=trial_trace.INK)
    _legend(sheet, task, bool(wanted))
    return sheet


def _draw_route(ax: Axes, task: TaskSpec) -> None:
    """Draw the way that the instruction describes, with an arrow at its end."""
    xs, ys = zip(*task.goal.route, strict=True)
    ax.plot(xs, ys, color=trial_trace.TARGET, lw=2.4, alpha=0.75, solid_capstyle="round", zorder=7)
    head = {"arrowstyle": "-|>", "color": trial_trace.TARGET, "lw": 2.4, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", task.goal.route[-1], task.goal.route[-2], arrowprops=head, zorder=9)


def _draw_objects(ax: Axes, task: TaskSpec) -> None:
    targets = {job.target for job in task.goal.todo}
    for placed in sorted(task.objects, key=lambda placed: placed.id in targets):
        chosen = placed.id in targets
        shade = trial_trace.TARGET if chosen else _OTHER
        x, y, _ = placed.position
        size, marker = (130, "*") if chosen else (20, "o")
        ax.scatter(x, y, s=size, marker=marker, color=shade, edgecolor="white", linewidths=0.8, zorder=12 + chosen)
        low = any(_crowds(placed, other) for other in task.objects)
        text = ax.annotate(
            catalog.kind(placed.kind).title,
            (x, y),
            (5, -9 if low else 5),
            textcoords="offset points",
            fontsize=8 if chosen else 6.5,
            color=shade,
            weight="bold" if chosen else "normal",
            zorder=14,
        )
        text.set_path_effects(_STROKE)


def _crowds(placed: Placement, other: Placement) -> bool:
    """Whether another object's name would cover this one's, so that this one's is written below its mark."""
    apart = math.dist(placed.position[:2], other.position[:2])
    return 0.0 < apart < _APART_M and placed.position[1] < other.position[1]


def _draw_start(ax: Axes, pose: Pose, number: int) -> None:
    """Draw a ring with a line in the viewing direction; robots also get their number."""
    shade = trial_trace.PEOPLE[0] if number == 0 else trial_trace.ROBOTS[(number - 1) % len(trial_trace.ROBOTS)]
    ax.plot(
        (pose.x, pose.x + 0.32 * math.cos(pose.yaw)),
        (pose.y, pose.y + 0.32 * math.sin(pose.yaw)),
        color=shade,
        lw=1.6,
        solid_capstyle="round",
        zorder=10,
    )
    ax.scatter(pose.x, pose.y, s=70, facecolor="white", edgecolor=shade, linewidths=1.6, zorder=11)
    if number:
        ax.text(pose.x, pose.y, str(number), fontsize=6, color=shade, ha="center", va="center_baseline", zorder=12)


def _headline(task: TaskSpec, feat: Solution) -> tuple[str, str]:
    how = f"{feat.seconds:.1f} s at {PACE_M_S:g} m/s" if feat.met else "not done alone"
    level = f", {task.difficulty}" if task.difficulty else ""
    return f"“{task.instruction}”", f"{task.id}: T* {task.t_star:.1f} s{level}; all-knowing person {how}"


def _legend(sheet: Figure, task: TaskSpec, destined: bool) -> None:
    shown = {placed.id for placed in task.objects}
    targets = any(job.target in shown for job in task.goal.todo)
    handles = [
        *([trial_legend.mark("*", trial_trace.TARGET, "target", size=10)] if targets else []),
        trial_legend.mark("o", _OTHER, "other object" if targets else "object", size=5.5),
        *([Line2D([], [], color=trial_trace.TARGET, lw=2.4, label="route")] if task.goal.route else []),
        *([trial_legend.destination(7)] if destined else []),
        trial_legend.mark("o", "white", "person's start", edge=trial_trace.PEOPLE[0], size=7),
        trial_legend.mark("o", "white", "robots' starts", edge=trial_trace.ROBOTS[0], size=7),
        Line2D([], [], color=trial_trace.PEOPLE[0], lw=1.5, ls=(0, (4, 2)), label="shortest walk"),
    ]
    text_fit.legend(sheet, handles, len(handles), loc="outside lower center", handlelength=1.8)
