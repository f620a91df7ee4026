"""Draws what the simulated human believed, saw and chose in one trial.

Above, the house at some of the human's choices: how likely each place seemed, how well it had been searched, and where
the human chose to go. Below, the same trial on a time axis.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib import colormaps, patheffects
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Wedge

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay.human_trace import HumanTrace, TraceEvent
from hthor.geometry import plane
from hthor.humans.core.thoughts import Beliefs, Noticed, RankedOptions
from hthor.report.drawing import floor_plan, human_trace_timeline, lettering, text_fit, trial_trace
from hthor.types import HouseSpec, Vec2

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOMENTS, _TALL = 4, 1.1
"""How many plans stand in a row at most if the house is this much deeper than wide; other plans stand in pairs."""
_WIDE, _WIDER = 11.0, 14.0
"""Width of the figure [in] with two plans in a row, and with more."""
_TITLE_PT, _EDGE_IN = 11.0, 0.3
"""Size of the title's letters [pt], and free space at the title's end [in]."""
_SHADES = colormaps["YlOrBr"]
_TOP, _NAMED = 0.35, 0.03
"""From this probability on, a place has the darkest shade; below the second one, no number is written on the place."""
_LOOKED = 0.5
_VIEW_M, _VIEW_DEG = 1.1, 97.0
_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.0, foreground="white")]


@lettering.plain_lettering()
def figure(record: TrialRecord, house: HouseSpec, stream: HumanTrace) -> Figure:
    """Draw a human trace; the figure is 11 inches wide, or 14 if the house is deep."""
    moments = _moments(stream.events)
    wide, deep = _extent(house)
    columns = max(2, min(len(moments), _MOMENTS)) if deep > _TALL * wide else 2
    inches = _WIDE if columns == 2 else _WIDER
    rows = math.ceil(len(moments) / columns) or 1
    plan_high = max(2.6, inches / columns * deep / wide + 0.45)
    lanes = human_trace_timeline.timeline_height(stream)
    words = human_trace_timeline.offers(stream)
    told = 0.2 * len(words) + 0.1
    sheet = Figure(figsize=(inches, 0.9 + plan_high * rows + lanes + told), dpi=160, layout="constrained")
    grid = sheet.add_gridspec(rows + 2, columns, height_ratios=[plan_high] * rows + [lanes, max(told, 0.05)])
    for number, (beliefs, choice) in enumerate(moments):
        ax = sheet.add_subplot(grid[divmod(number, columns)])
        _draw_moment(ax, record, house, beliefs, choice, stream)
    if not moments:
        _draw_end(sheet.add_subplot(grid[0, :]), record, house, stream)
    human_trace_timeline.draw_timeline(sheet.add_subplot(grid[rows, :]), record, stream)
    _write(sheet.add_subplot(grid[rows + 1, :]), words)
    spec = record.spec
    who = f", {stream.seat}" if len(spec.humans) > 1 else ""
    whose = f"{spec.task.id}, session {spec.session}, trial {spec.index + 1}{who}"
    title = text_fit.wrapped(f"“{spec.task.instruction}”   {whose}", inches - _EDGE_IN, _TITLE_PT)
    sheet.suptitle(title, fontsize=_TITLE_PT, x=0.01, ha="left", color=trial_trace.INK)
    text_fit.legend(sheet, _legend(), 6, loc="outside lower center")
    return sheet


def _moments(events: Sequence[TraceEvent]) -> list[tuple[Beliefs, RankedOptions]]:
    """Some choices, each with the beliefs behind it: the first, the last, and others evenly between."""
    beliefs = [event for event in events if isinstance(event, Beliefs)]
    choices = [event for event in events if isinstance(event, RankedOptions)]
    pairs = list(zip(beliefs, choices, strict=False))
    if len(pairs) <= _MOMENTS:
        return pairs
    return [pairs[round(k * (len(pairs) - 1) / (_MOMENTS - 1))] for k in range(_MOMENTS)]


def _draw_moment(
    ax: Axes, record: TrialRecord, house: HouseSpec, beliefs: Beliefs, choice: RankedOptions, stream: HumanTrace
) -> None:
    floor_plan.draw_house(ax, house)
    chances, ahead = posterior(beliefs)
    exposures = {place.id: place.exposure for place in beliefs.places}
    for thing in house.things:
        if thing.id in chances:
            _draw_place(ax, thing, chances[thing.id], exposures[thing.id])
    log, until = record.log, beliefs.tick
    _draw_way(ax, record, stream.seat, until)
    here = trial_trace.position_at(log, stream.seat, until)
    shares = human_trace_timeline.option_chances(choice, stream.traits["beta"])
    spots = _spots(house)
    for name, share in shares.items():
        if name in spots and name != choice.chosen and share >= _NAMED and name.startswith("door "):
            _say(ax, spots[name], f"{100 * share:.0f} %", "#555555")
    goal = spots.get(choice.chosen)
    if goal is not None:
        arrow = {"arrowstyle": "-|>", "color": trial_trace.TARGET, "lw": 1.6, "shrinkA": 5, "shrinkB": 2}
        ax.annotate("", goal, here, arrowprops=arrow, zorder=13)
    _draw_targets(ax, record)
    chosen, share = _plain(choice.chosen, beliefs), shares[choice.chosen]
    what = f"the {_sought(record, choice.aim)}"
    elsewhere = f"{100 * ahead:.0f} % behind doorways" if ahead > 0.0 else "nothing is left unseen"
    title = f"{until * rules.TICK_S:.1f} s: looks for {what},\n{elsewhere};\nchooses {chosen} ({100 * share:.0f} %)"
    ax.set_title(title, fontsize=8, loc="left", color=trial_trace.INK)


def _draw_end(ax: Axes, record: TrialRecord, house: HouseSpec, stream: HumanTrace) -> None:
    """Draw the whole path, and what was noticed, in a trial in which nothing had to be searched for."""
    floor_plan.draw_house(ax, house)
    noticed = {event.object for event in stream.events if isinstance(event, Noticed)}
    for thing in house.things:
        if thing.id in noticed:
            _draw_place(ax, thing, 0.0, 0.0)
    _draw_way(ax, record, stream.seat, record.ticks)
    _draw_targets(ax, record)
    ax.set_title("nothing had to be searched for", fontsize=8.5, loc="left", color=trial_trace.INK)


def _draw_targets(ax: Axes, record: TrialRecord) -> None:
    wanted = {job.target for job in record.spec.task.goal.todo}
    for placed in record.spec.task.objects:
        if placed.id in wanted:
            trial_trace.draw_mark(ax, placed.position, "*", 70, trial_trace.TARGET, 0.7, 12)


def posterior(beliefs: Beliefs) -> tuple[dict[str, float], float]:
    """Probability of the object at each known place, and behind doorways, given the search so far; the sum is 1."""
    left = {place.id: place.belief * math.exp(-place.exposure) for place in beliefs.places}
    total = sum(left.values()) + beliefs.ahead
    return {name: mass / total for name, mass in left.items()}, beliefs.ahead / total


def _draw_place(ax: Axes, thing: Any, chance: float, exposure: float) -> None:
    outline = plane.rectangle((thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw)
    shade = _SHADES(0.06 + 0.8 * min(1.0, chance / _TOP))
    searched = min(1.0, exposure / 3.0)
    edge, width = ("#56B4E9", 0.8 + 1.6 * searched) if exposure >= _LOOKED else ("#7d766a", 0.8)
    ax.add_patch(Polygon(outline, closed=True, facecolor=shade, edgecolor=edge, lw=width, zorder=3.5))
    if chance >= _NAMED:
        _say(ax, (thing.centre[0], thing.centre[1]), f"{100 * chance:.0f} %", trial_trace.INK)


def _draw_way(ax: Axes, record: TrialRecord, seat: str, until: int) -> None:
    path, shade = record.paths[seat][: until // rules.LOG_EVERY_TICKS + 1], trial_trace.seat_colour(seat)
    xs, ys = [x / 1000 for x, _, _ in path], [y / 1000 for _, y, _ in path]
    ax.plot(xs, ys, color=shade, lw=1.4, alpha=0.75, zorder=8)
    yaw = math.degrees(path[-1][2] / 1000)
    half = _VIEW_DEG / 2.0
    view = Wedge((xs[-1], ys[-1]), _VIEW_M, yaw - half, yaw + half, facecolor=shade, alpha=0.18, lw=0, zorder=9)
    ax.add_patch(view)
    ax.scatter(xs[-1], ys[-1], s=34, facecolor=shade, edgecolor="white", linewidths=0.8, zorder=10)


def _spots(house: HouseSpec) -> Mapping[str, Vec2]:
    """The position of each option, by its name."""
    spots: dict[str, Vec2] = {thing.id: (thing.centre[0], thing.centre[1]) for thing in house.things}
    for opening in house.openings:
        (ax, ay), (bx, by) = opening.a, opening.b
        spots[f"door {opening.id}"] = ((ax + bx) / 2.0, (ay + by) / 2.0)
    return spots


def _sought(record: TrialRecord, aim: str) -> str:
    """The name of what is looked for, in words."""
    goal = record.spec.task.goal
    kinds = {placed.id: placed.kind for placed in record.spec.task.objects}
    several = len(goal.todo) > 1
    word = kinds.get(goal.target, goal.target) if aim == "target" else goal.destination or aim
    return "objects" if several and aim == "target" else floor_plan.title(word).lower()


def _plain(option: str, beliefs: Beliefs) -> str:
    """The name of an option, in words."""
    kinds = {place.id: place.kind for place in beliefs.places}
    return "a doorway" if option.startswith("door ") else f"the {floor_plan.title(kinds.get(option, option)).lower()}"


def _say(ax: Axes, place: Vec2, words: str, shade: str) -> None:
    text = ax.text(*place, words, fontsize=6.5, color=shade, ha="center", va="center", zorder=12, weight="bold")
    text.set_path_effects(_STROKE)


def _write(ax: Axes, words: Sequence[str]) -> None:
    ax.axis("off")
    for row, line in enumerate(words):
        height = 1.0 - (row + 0.5) / len(words)
        ax.text(0.0, height, line, transform=ax.transAxes, fontsize=8, color=trial_trace.INK, va="center")


def _extent(house: HouseSpec) -> Vec2:
    points = [point for room in house.rooms for point in room.polygon]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return max(xs) - min(xs), max(ys) - min(ys)


def _legend() -> list[Any]:
    star = Line2D([], [], ls="", marker="*", markersize=9, color=trial_trace.TARGET, label="where it really lay")
    return [
        Patch(facecolor=_SHADES(0.86), edgecolor="#7d766a", label=f"expected there ({100 * _TOP:.0f} % or more)"),
        Patch(facecolor=_SHADES(0.06), edgecolor="#7d766a", label="hardly expected"),
        Patch(facecolor="white", edgecolor="#56B4E9", lw=2, label="looked at, thicker: better"),
        Patch(facecolor="#d9d4cb", edgecolor="#a8a196", label="not noticed yet"),
        Line2D([], [], color=trial_trace.TARGET, lw=1.6, label="what is chosen"),
        star,
    ]
