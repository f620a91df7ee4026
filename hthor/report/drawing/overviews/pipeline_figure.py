"""Draws how a task is made, as one figure: the knowledge graph, the scene graph, and the placed scene."""

from __future__ import annotations

import math

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hthor import catalog
from hthor.catalog import priors
from hthor.report.drawing import lettering, text_fit, trial_legend, trial_trace
from hthor.report.drawing.overviews import framing, graph_panels, marks
from hthor.tasks.arrangement import scene_graph
from hthor.types import TaskSpec
from hthor.world import World

_WIDE_IN, _TALL_IN, _EDGE_IN = 11.0, 4.6, 0.12
_TITLE_PT, _PANEL_PT = 10.0, 8.0
"""Size of the letters of the figure's title and of the panels' titles [pt]."""
_WIDTHS = (3.1, 3.0, 4.4)
"""Widths of the panels [in]."""
_OTHER = "#4a5058"


@lettering.plain_lettering()
def pipeline_figure(task: TaskSpec, world: World, profile: str = "fast") -> Figure:
    """Draw how a task was made, about 11 inches wide.

    Args:
        world: the house of the task, with its objects; the task is begun in it. profile: fast or nice.
    """
    world.reset(task)
    house = world.house
    chosen, wanted = scene_graph.read_graph(task.objects, house), [job.target for job in task.goal.todo]
    kinds = {placed.id: placed.kind for placed in task.objects}
    sheet = Figure(figsize=(_WIDE_IN, _TALL_IN), dpi=200, facecolor="white")
    title = text_fit.shorten(f"“{task.instruction}” {task.id}", _WIDE_IN - 2 * _EDGE_IN, _TITLE_PT)
    sheet.text(
        _EDGE_IN / _WIDE_IN, 1.0 - _EDGE_IN / _TALL_IN, title, fontsize=_TITLE_PT, va="top", color=trial_trace.INK
    )
    present = scene_graph.kinds_present(house)
    known = sum(row.reference in present for row in priors.triplets())
    words = (
        f"1  Knowledge graph: {known} of {len(priors.triplets())} priors apply",
        "2  Scene graph: a relation for each object",
        "3  Placed scene: a pose for each relation",
    )
    left = _EDGE_IN
    panels = []
    for wide, head in zip(_WIDTHS, words, strict=True):
        ax = sheet.add_axes((left / _WIDE_IN, 0.42 / _TALL_IN, wide / _WIDE_IN, (_TALL_IN - 1.06) / _TALL_IN))
        top = 1.0 - 0.5 / _TALL_IN
        head = text_fit.shorten(head, wide, _PANEL_PT, bold=True)
        sheet.text(left / _WIDE_IN, top, head, fontsize=_PANEL_PT, weight="bold", va="top", color=trial_trace.INK)
        panels.append(ax)
        left += wide + _EDGE_IN
    graph_panels.draw_priors(panels[0], house, chosen, kinds)
    graph_panels.draw_relations(panels[1], task.objects, chosen, wanted)
    places = [placed.position for placed in task.objects]
    (azimuth,) = framing.best_azimuths(world, places, 1)
    overview = marks.draw_overview(panels[2], world, azimuth, profile)
    for placed in sorted(task.objects, key=lambda one: math.dist(one.position, overview.viewpoint.eye), reverse=True):
        shade = trial_trace.TARGET if placed.id in wanted else _OTHER
        overview.box(placed.position, placed.kind, shade, yaw=placed.yaw)
        overview.name(placed.position, catalog.kind(placed.kind).title, shade)
    text_fit.legend(sheet, _legend(), 8, size=7.5, loc="lower left", columnspacing=1.4)
    return sheet


def _legend() -> list[Line2D]:
    lines = [trial_legend.line(shade, relation) for relation, shade in graph_panels.RELATIONS.items()]
    return [
        *lines,
        trial_legend.line(graph_panels.ABSENT, "not in this house"),
        trial_legend.mark("s", trial_trace.TARGET, "what the task is about", size=7),
        trial_legend.mark("s", _OTHER, "other object", size=7),
        Line2D([], [], color="#777777", lw=1.0, ls=(0, (2, 1.5)), label="hidden from this angle"),
    ]
