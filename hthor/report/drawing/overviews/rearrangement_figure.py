"""Draws a rearrangement from three angles: where the targets were before the shuffle, and where they are after it."""

from __future__ import annotations

import math

from matplotlib.figure import Figure
from msgspec import Struct

from hthor import catalog
from hthor.errors import HthorError
from hthor.report.drawing import lettering, text_fit, trial_legend, trial_trace
from hthor.report.drawing.overviews import framing, marks
from hthor.report.drawing.overviews.marks import Overview
from hthor.types import TaskSpec, Vec3
from hthor.world import World

BEFORE, AFTER = "#f2b400", "#d3122a"
"""Gold and red, the colours of the places before and after, as in the article."""
ANGLES = 3
_MOVED_M = 0.05
"""[m] An object that is farther than this from its place was moved."""
_WIDE_IN, _EDGE_IN, _TITLE_PT = 11.0, 0.12, 10.0
"""Width of the figure and free space at its edges [in]; size of the title's letters [pt]."""


class Shuffled(Struct, frozen=True, kw_only=True):
    """A target of a rearrangement: its centre [m] before and after the shuffle."""

    kind: str
    before: Vec3
    after: Vec3

    @property
    def moved(self) -> bool:
        """Whether the shuffle moved it."""
        return math.dist(self.before, self.after) > _MOVED_M


def shuffled_targets(task: TaskSpec) -> list[Shuffled]:
    """The targets of a rearrangement, in the order of the task's jobs.

    Raises:
        HthorError: if the task has no record of places from before a shuffle.
    """
    after = {placed.id: placed for placed in task.objects}
    found = [
        Shuffled(kind=after[job.target].kind, before=job.place, after=after[job.target].position)
        for job in task.goal.todo
        if job.place is not None and job.relation != "at" and job.target in after  # "at": a place to carry it to
    ]
    if not found:
        raise HthorError(
            f"{task.id}: this task has no places from before a shuffle. --angles draws tasks of the kind "
            "room_rearrangement, such as rearrange/elder/01; 'hthor tasks list rearrange' lists them."
        )
    return found


@lettering.plain_lettering()
def rearrangement_figure(task: TaskSpec, world: World, profile: str = "fast") -> Figure:
    """Draw a rearrangement, about 11 inches wide.

    Args:
        world: the house of the task, with its objects; the task is begun in it. profile: fast or nice.
    """
    targets = shuffled_targets(task)
    world.reset(task)
    each = (_WIDE_IN - 2 * _EDGE_IN) / ANGLES
    title = text_fit.wrapped(_headline(task, targets), _WIDE_IN - 2 * _EDGE_IN, _TITLE_PT)
    head = 0.24 * (title.count("\n") + 1) + _EDGE_IN
    deep = each * marks.PIXELS[1] / marks.PIXELS[0]
    tall = head + deep + 0.4
    sheet = Figure(figsize=(_WIDE_IN, tall), dpi=200, facecolor="white")
    points = [place for target in targets for place in (target.before, target.after)]
    for number, azimuth in enumerate(framing.best_azimuths(world, points, ANGLES)):
        left = (_EDGE_IN + number * each) / _WIDE_IN
        ax = sheet.add_axes((left, 0.4 / tall, (each - 0.06) / _WIDE_IN, deep / tall))
        _draw_targets(marks.draw_overview(ax, world, azimuth, profile), targets)
    sheet.text(_EDGE_IN / _WIDE_IN, 1.0 - _EDGE_IN / tall, title, fontsize=_TITLE_PT, va="top", color=trial_trace.INK)
    handles = [
        trial_legend.mark("s", BEFORE, "before the shuffle: where it belongs", edge="#555555", size=8),
        trial_legend.mark("s", AFTER, "after the shuffle: where it is", edge="#555555", size=8),
        trial_legend.mark("s", BEFORE, "red in gold: not moved", edge=AFTER, size=8),
        trial_legend.line("#777777", "dashed: hidden from this angle"),
    ]
    handles[-1].set_linestyle((0, (2, 1.5)))
    text_fit.legend(sheet, handles, len(handles), size=8.0, loc="lower left")
    return sheet


def _draw_targets(overview: Overview, targets: list[Shuffled]) -> None:
    for target in targets:
        overview.box(target.before, target.kind, BEFORE)
        overview.box(target.after, target.kind, AFTER, grow=1.0 if target.moved else 0.7)
        if target.moved:
            overview.arrow(target.before, target.after, AFTER)
        overview.name(target.after, catalog.kind(target.kind).title, AFTER if target.moved else trial_trace.INK)


def _headline(task: TaskSpec, targets: list[Shuffled]) -> str:
    moved = sum(target.moved for target in targets)
    return f"“{task.instruction}” {task.id}: {moved} of {len(targets)} targets were moved"
