"""Draws the two graphs from which a task is made: the scene priors, and the relations that were drawn for one task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hthor import catalog
from hthor.catalog import priors
from hthor.catalog.priors import Triplet
from hthor.report.drawing import floor_plan, trial_trace
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.arrangement.scene_graph import Relation
from hthor.types import HouseSpec, Placement

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RELATIONS = {"on": "#0072B2", "in": "#D55E00", "near": "#8a6d00"}
"""Colours of relations, which colour-blind readers can tell apart."""
ABSENT = "#c9cdd2"
"""The colour of priors whose reference the house lacks."""
_LINE_PT, _THIN_PT = 4.5, 0.25
"""Width of the line of a weight of 1, and width added to all lines [pt]."""
_NODE_PT, _SMALL_PT = 7.5, 6.2
"""Size of the letters of targets and of references [pt]."""
_LEFT, _RIGHT = 0.3, 0.68
"""Where lines begin and end, as shares of a panel's width."""


def draw_priors(ax: Axes, house: HouseSpec, chosen: Mapping[str, Relation], kinds: Mapping[str, str]) -> None:
    """Draw the 65 scene priors: targets left, references right, a line for each triplet, as wide as its weight.

    Args:
        chosen: the relations of the task's objects, whose lines are strong. kinds: kinds of those objects by id.
    """
    present = scene_graph.kinds_present(house)
    strong = {(kinds[id], one.relation, one.reference) for id, one in chosen.items()}
    targets = _spread(priors.targets())
    rows = priors.triplets()
    references = _spread(_sorted_references(rows, targets))
    _frame(ax)
    for row in sorted(rows, key=lambda row: row.key in strong):
        known, drawn = row.reference in present, row.key in strong
        shade = RELATIONS[row.relation] if known else ABSENT
        ends = (targets[row.target], references[row.reference])
        wide = _THIN_PT + _LINE_PT * row.weight + (1.0 if drawn else 0.0)
        ax.plot((_LEFT, _RIGHT), ends, color=shade, lw=wide, alpha=1.0 if drawn else 0.35, zorder=3 if drawn else 2)
    for target, y in targets.items():
        _node(ax, _LEFT - 0.02, y, target, "right", _NODE_PT, weight="bold")
    for reference, y in references.items():
        shade = trial_trace.INK if reference in present else ABSENT
        _node(ax, _RIGHT + 0.015, y, reference, "left", _SMALL_PT, color=shade)


def draw_relations(
    ax: Axes, objects: Sequence[Placement], chosen: Mapping[str, Relation], wanted: Sequence[str]
) -> None:
    """Draw the scene graph of a task: an arrow from each object to what it is on, in or near.

    Args:
        wanted: ids of the objects that the task is about, whose names are green.
    """
    _frame(ax)
    places = _spread([placed.id for placed in objects])
    for placed in objects:
        y, relation = places[placed.id], chosen[placed.id]
        shade = RELATIONS[relation.relation]
        look: dict[str, Any] = {"arrowstyle": "-|>", "color": shade, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (_RIGHT, y), (_LEFT + 0.02, y), arrowprops=look)
        middle = (_LEFT + _RIGHT) / 2
        weight = _weight(placed.kind, relation)
        ax.text(middle, y + 0.012, relation.relation, fontsize=_NODE_PT, color=shade, ha="center", va="bottom")
        ax.text(middle, y - 0.014, weight, fontsize=5.6, color="#777777", ha="center", va="top")
        mine = trial_trace.TARGET if placed.id in wanted else trial_trace.INK
        _node(ax, _LEFT, y, placed.kind, "right", _NODE_PT, weight="bold", color=mine)
        _node(ax, _RIGHT + 0.015, y, relation.reference, "left", _NODE_PT)
        if relation.relation == "near":
            under = f"{placed.relation} {floor_plan.title(relation.support)}"
            ax.text(_RIGHT + 0.015, y - 0.03, under, fontsize=5.6, color="#777777", va="top")


def _weight(kind: str, relation: Relation) -> str:
    """The weight of a relation among the priors of its kind; nothing for a relation that is not among them."""
    if kind not in priors.targets():
        return ""
    weight = priors.weights(kind).get((relation.relation, relation.reference))
    return "" if weight is None else f"weight {weight:.2f}"


def _sorted_references(rows: Sequence[Triplet], targets: Mapping[str, float]) -> list[str]:
    """The references from top to bottom, each at the mean height of its targets, so that fewer lines cross."""
    heights: dict[str, list[float]] = {}
    for row in rows:
        heights.setdefault(row.reference, []).append(targets[row.target])
    return sorted(heights, key=lambda name: (-sum(heights[name]) / len(heights[name]), name))


def _spread(names: Sequence[str]) -> dict[str, float]:
    """Equally spaced heights from top to bottom."""
    return {name: 1.0 - (number + 0.5) / len(names) for number, name in enumerate(names)}


def _frame(ax: Axes) -> None:
    ax.set_xlim(0.0, 1.0)
    ax.set_ylim(0.0, 1.0)
    ax.axis("off")


def _node(ax: Axes, x: float, y: float, kind: str, side: str, size: float, **look: Any) -> None:
    words = catalog.kind(kind).title if kind in catalog.names() else kind.replace("_", " ")
    ax.text(x, y, words, fontsize=size, ha=side, va="center", **{"color": trial_trace.INK, **look})
