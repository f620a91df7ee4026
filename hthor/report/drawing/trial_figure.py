"""Draws one trial: the house from above, the paths, the messages and their outcomes, and a timeline."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib import patheffects
from matplotlib.figure import Figure
from matplotlib.transforms import blended_transform_factory

from hthor import rules
from hthor.episode import EpisodeLog, Fault, task_part
from hthor.report.drawing import floor_plan, lettering, text_fit, trial_legend, trial_timeline, trial_trace
from hthor.types import HouseSpec, TrialSpec, Vec2, is_person
from hthor.types.events import Sent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CORNERS, _CROWDED_M = ((1, 1), (-1, -1), (-1, 1), (1, -1)), 1.5
"""Corners in which targets' names stand, one after the other, if the targets are closer than this [m]."""
_LINES, _MANY, _WIDE_IN = 10, 100, 8.0
"""How many messages are written out; with how many messages the arrows become faint; width of the figure [in]."""
_EDGE_IN, WORDS_PT, HEAD_PT = 0.15, 7.5, 10.0
"""Free space at the ends of a line of words [in]; size of the letters of messages and of the headline [pt]."""
_COLUMNS, _DEEPEST = 5, 8.5
"""Columns of the legend, and height of a plan at most [in]."""
_LETTER_IN, _BADGE_IN, _BESIDE_M = 0.065, 0.17, 0.15
"""Width of a letter on a badge, and height of a badge [in]; arrows shorter than this [m] are hidden by the badge."""
_STROKE: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=2.4, foreground="white")]


@lettering.plain_lettering()
def trial_figure(spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> Figure:
    """Draw a trial, about 8 inches wide: the plan, the timeline below, and the messages' words.

    Of the phases before the task itself, the paths are drawn thin, and the time before its beginning is negative.

    Args:
        spec: the trial. log: its log. house: the house of its task.
    """
    whole, log = log, task_part(log)
    words = _words(log)
    wide, high = _size(house)
    clock, told = 1.0 + 0.22 * trial_timeline.row_count(log), 0.2 * len(words)
    sheet = Figure(figsize=(wide, high + clock - 1.5 + told), dpi=200, layout="constrained")
    rows = (high - 1.5, clock, told)[: 3 if words else 2]
    above, below, *rest = sheet.subplots(len(rows), 1, height_ratios=rows)
    floor_plan.draw_house(above, house, marked=trial_trace.destinations(spec, house))
    _name_destinations(above, spec, house)
    for seat in log.paths:
        _draw_path_before(above, whole, seat, whole.ticks - log.ticks)
        draw_path(above, log, seat)
    _draw_targets(above, spec, house)
    draw_messages(above, log)
    _draw_acts(above, log)
    title = headline(spec, whole, _WIDE_IN - 2 * _EDGE_IN, HEAD_PT)
    sheet.suptitle(title, x=_EDGE_IN / _WIDE_IN, ha="left", fontsize=HEAD_PT, color=trial_trace.INK)
    text_fit.legend(
        sheet, trial_legend.legend_entries(spec, whole, house), _COLUMNS, loc="outside lower left", handlelength=1.6
    )
    trial_timeline.draw_timeline(below, spec, whole)
    for ax in rest:
        _write_words(ax, words)
    return sheet


def draw_path(ax: Axes, log: EpisodeLog, seat: str, *, words: bool = True) -> None:
    """Draw a seat's path: a line that darkens with time, a dot every ten seconds, rings at start and end.

    A robot whose agent failed stands still for the rest of the trial: a cross marks this place instead of a ring.
    """
    way, shade = trial_trace.points(log, seat), trial_trace.seat_colour(seat)
    fault = trial_trace.first_fault(log, seat)
    if fault is not None:
        way = way[: fault.tick // rules.LOG_EVERY_TICKS + 1]
    third = max(1, math.ceil(len(way) / 12))
    for first in range(0, len(way) - 1, third):
        piece = way[first : first + third + 1]
        strength = 0.35 + 0.65 * first / max(1, len(way) - 1)
        ax.plot(piece[:, 0], piece[:, 1], color=shade, lw=1.7, alpha=strength, solid_capstyle="round", zorder=8)
    every = round(10.0 / rules.TICK_S) // rules.LOG_EVERY_TICKS
    dots = way[every::every]
    ax.scatter(dots[:, 0], dots[:, 1], s=9, color=shade, zorder=9, linewidths=0)
    ax.scatter(way[0, 0], way[0, 1], s=46, facecolor="white", edgecolor=shade, linewidths=1.7, zorder=10)
    if fault is None:
        ax.scatter(way[-1, 0], way[-1, 1], s=46, facecolor=shade, edgecolor="white", linewidths=1.0, zorder=10)
    else:
        _draw_fault(ax, (float(way[-1, 0]), float(way[-1, 1])), fault, words=words)


def _draw_path_before(ax: Axes, log: EpisodeLog, seat: str, ticks: int) -> None:
    """Draw a thin line for the first ``ticks`` of a seat's path, before the task itself."""
    way = trial_trace.points(log, seat)[: ticks // rules.LOG_EVERY_TICKS]
    if not len(way):
        return
    ax.plot(way[:, 0], way[:, 1], color=trial_trace.seat_colour(seat), lw=0.7, ls=(0, (1, 1)), alpha=0.7, zorder=7)


def _draw_fault(ax: Axes, place: Vec2, fault: Fault, *, words: bool) -> None:
    """Draw a cross where an agent failed, with the fault and its time."""
    ax.scatter(*place, s=74, marker="X", facecolor=trial_trace.FAILED, edgecolor="white", linewidths=0.9, zorder=13)
    if words:
        told = f"{fault.kind} at {fault.tick * rules.TICK_S:.1f} s"
        text = ax.annotate(
            told, place, (7, -4), textcoords="offset points", fontsize=7, color=trial_trace.FAILED, va="top", zorder=13
        )
        text.set_path_effects(_STROKE)


def _draw_targets(ax: Axes, spec: TrialSpec, house: HouseSpec) -> None:
    """Draw a star where each object starts, with a line to a hollow star if it belongs at an exact point."""
    done: list[Vec2] = []
    for job, start in trial_trace.targets(spec, house):
        x, y, _ = start.position
        if job.place is not None:
            ax.plot((x, job.place[0]), (y, job.place[1]), color=trial_trace.TARGET, lw=0.8, ls=":", zorder=7)
            ax.scatter(
                *job.place[:2], s=70, marker="*", facecolor="white", edgecolor=trial_trace.TARGET, lw=1.0, zorder=12
            )
        ax.scatter(x, y, s=120, marker="*", color=trial_trace.TARGET, edgecolor="white", linewidths=0.8, zorder=12)
        beside = sum(math.dist((x, y), other) < _CROWDED_M for other in done)
        done.append((x, y))
        _label(ax, floor_plan.title(start.kind), (x, y), _CORNERS[beside % len(_CORNERS)])


def _label(ax: Axes, words: str, place: Vec2, corner: tuple[int, int]) -> None:
    name = ax.annotate(
        words,
        place,
        (6 * corner[0], 6 * corner[1]),
        textcoords="offset points",
        fontsize=8,
        color=trial_trace.TARGET,
        weight="bold",
        ha="left" if corner[0] > 0 else "right",
        va="bottom" if corner[1] > 0 else "top",
        zorder=13,
    )
    name.set_path_effects(_STROKE)


def _name_destinations(ax: Axes, spec: TrialSpec, house: HouseSpec) -> None:
    marked = trial_trace.destinations(spec, house)
    for thing in house.things:
        if thing.id in marked:
            look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 7.5, "color": "#00604a", "zorder": 7}
            text = ax.annotate(floor_plan.title(thing.kind), thing.centre[:2], **look)
            text.set_path_effects(_STROKE)


def _words(log: EpisodeLog) -> list[tuple[str, str]]:
    """A line for each message, with its colour; of many messages only the first and the last few."""
    sent = list(enumerate(trial_trace.messages(log), 1))
    half = _LINES // 2
    left = len(sent) - 2 * half
    if left <= 0:
        return [_line_of(log, number, event) for number, event in sent]
    first, last = ([_line_of(log, number, event) for number, event in some] for some in (sent[:half], sent[-half:]))
    return [*first, (f"… and {left} more", trial_trace.INK), *last]


def _line_of(log: EpisodeLog, number: int, message: Sent) -> tuple[str, str]:
    """A message's number, time, sender, words and outcome as one line, and its colour."""
    fate = trial_trace.outcome_of(log, message.message)
    to = f" to {message.to}" if message.to else ""
    head = f"{number}  {message.tick * rules.TICK_S:.1f} s  {message.seat}{to}: “"
    end = f"” ({_end(message, fate)})"
    room = _WIDE_IN - 2 * _EDGE_IN - text_fit.text_width(head + end, WORDS_PT)
    return (head + text_fit.shorten(message.text, room, WORDS_PT) + end, trial_trace.message_colour(log, message))


def _end(message: Sent, fate: str) -> str:
    """How a message ended, in a word or two; people's messages and answers, unless they ask, are only read."""
    if fate not in ("sent", "shown"):
        return fate
    if message.question or not (is_person(message.seat) or message.answers is not None):
        return "unanswered"
    return "read" if fate == "shown" else "not read"


def _write_words(ax: Axes, words: Sequence[tuple[str, str]]) -> None:
    ax.axis("off")
    across = blended_transform_factory(ax.get_figure(root=True).transFigure, ax.transAxes)  # type: ignore[union-attr]
    for row, (line, shade) in enumerate(words):
        height = 1.0 - (row + 0.5) / len(words)
        told = ax.text(_EDGE_IN / _WIDE_IN, height, line, transform=across, fontsize=WORDS_PT, color=shade, va="center")
        told.set_in_layout(False)  # a long line takes no room from the plan


def draw_messages(ax: Axes, log: EpisodeLog, *, arrows: bool = True) -> None:
    """Draw every message's number where it was sent, and an arrow to the place that the message gives.

    Messages that would hide one another share a badge.
    """
    sent = [
        (number, message, trial_trace.position_at(log, message.seat, message.tick))
        for number, message in enumerate(trial_trace.messages(log), 1)
    ]
    strength = 1.0 if len(sent) <= _LINES else 0.45 if len(sent) <= _MANY else 0.15
    shades, drawn = trial_trace.message_colours(log), set()
    for _, message, here in sent if arrows else ():
        claim, shade = message.position, shades[message.message]
        if claim is None or math.dist(claim[:2], here) <= _BESIDE_M:
            continue
        same = (shade, *(round(part / _BESIDE_M) for part in (*here, *claim[:2])))
        if same not in drawn:  # equal arrows are drawn only once
            drawn.add(same)
            arrow = {"arrowstyle": "-|>", "color": shade, "alpha": strength}
            line = {"lw": 1.0 if strength == 1.0 else 0.7, "ls": (0, (3, 2)), "shrinkA": 6, "shrinkB": 5}
            made = ax.annotate("", (claim[0], claim[1]), here, arrowprops=arrow | line, zorder=11)
            made.set_in_layout(False)
    inch = _metres(ax)
    for group in trial_trace.group_messages(log, sent, _LETTER_IN * inch, _BADGE_IN * inch):
        trial_trace.draw_badge(ax, _on_plan(ax, group, inch), group.words, group.shade)


def _on_plan(ax: Axes, group: trial_trace.MessageGroup, inch: float) -> Vec2:
    """The position of a badge: at its place, but far enough from the edge that it is not cut off."""
    half = 0.5 * _LETTER_IN * inch * (len(group.words) + 2)
    west, east = ax.get_xlim()
    return (min(max(group.place[0], west + half), east - half), group.place[1])


def _metres(ax: Axes) -> float:
    """How many metres of the house an inch of the picture shows, approximately."""
    low, high = ax.get_xlim()
    return (high - low) / max(1.0, 0.75 * float(ax.get_figure(root=True).get_figwidth()))  # type: ignore[union-attr]


def _draw_acts(ax: Axes, log: EpisodeLog) -> None:
    for event in log.events:
        if event.kind in trial_trace.ACTS:
            place, shade = trial_trace.position_at(log, event.seat, event.tick), trial_trace.seat_colour(event.seat)
            trial_trace.draw_mark(ax, place, trial_trace.ACTS[event.kind][0], 40, shade, 0.8, 11)


def headline(spec: TrialSpec, log: EpisodeLog, inches: float, size: float) -> str:
    """The instruction, the agents, and how the trial ended, broken into lines.

    Args:
        inches: width of a line at most. size: of its letters [pt].
    """
    agents = " and ".join(dict.fromkeys(robot.agent.name for robot in spec.robots)) or "no robot"
    whole, log = log, task_part(log)
    seconds = log.ticks * rules.TICK_S
    end = f"done in {seconds:.1f} s" if log.met else f"not done in {seconds:.0f} s"
    if log.voided:
        end = f"voided after {seconds:.1f} s, reason: {log.voided}"
    elif not log.met and log.progress is not None:
        end += f", {100.0 * log.progress:.0f} % of it done"
    if spec.task.phases:
        end += f", after {(whole.ticks - log.ticks) * rules.TICK_S:.0f} s of {trial_trace.phase_words(spec)}"
    lines = [f"“{spec.task.instruction}”", f"{agents}: {end} (T* {spec.task.t_star:.1f} s), {spec.task.id}"]
    for robot in spec.robots:
        if (fault := trial_trace.first_fault(log, robot.seat)) is not None:
            whose = f"{robot.seat}'s agent" if len(spec.robots) > 1 else "the agent"
            lines.append(f"{whose} failed at {fault.tick * rules.TICK_S:.1f} s ({fault.kind}) and did nothing more")
    return "\n".join(text_fit.wrapped(line, inches, size) for line in lines)


def _size(house: HouseSpec) -> tuple[float, float]:
    corners: Sequence[Vec2] = [point for room in house.rooms for point in room.polygon]
    wide = max(x for x, _ in corners) - min(x for x, _ in corners)
    deep = max(y for _, y in corners) - min(y for _, y in corners)
    return (_WIDE_IN, max(4.2, min((_WIDE_IN - 0.8) * deep / wide, _DEEPEST) + 2.7))
