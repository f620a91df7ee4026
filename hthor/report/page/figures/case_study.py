"""Draws a case study: one row per robot, with all paths on a plan of the house and each seat's view at key moments."""

from __future__ import annotations

import math
import string
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from msgspec import Struct

from hthor import rules
from hthor.episode import task_part
from hthor.eval.records.trial_record import TrialRecord
from hthor.report.drawing import floor_plan, text_fit, trial_figure, trial_legend, trial_trace
from hthor.report.drawing.person_display.display_pictures import DisplayPictures
from hthor.report.html import matplotlib_svg
from hthor.report.page import camera_frames
from hthor.report.page.camera_frames import Seen
from hthor.report.page.key_moments import MANY, Moment
from hthor.types import HouseSpec, Vec2

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MAP_WIDE, _VIEW_WIDE = 3.1, 1.55
_HEAD, _EDGES = 0.36, 0.5
"""Height of the words above each row, and of the space above and below all rows [in]."""
_MAP_HIGH = 3.3
"""Height of a map at most [in]."""
_DISPLAY = 0.42
"""Height of a person's display below their view, as a share of the view's width."""
_NEAR_M, _BESIDE_M = 0.5, 0.6
_LETTER_PT, _BADGE_IN = 6.5, 0.12
"""Size of a letter on a badge [pt], and the badge's width besides its letters [in]."""
_HEAD_PT, _TASK_PT, _EDGE_IN = 8.5, 9.0, 0.2
"""Size of the words above a row and above all rows [pt], and free space at their ends [in]."""
_HEAD_LINES, _LINE = 3, 0.15
"""Lines at most of the words above a row or above all rows, and the height of each line after the first [in]."""
_CORNERS: tuple[Vec2, ...] = ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0))


class Row(Struct, frozen=True, kw_only=True, eq=False):
    """One robot's trial: its name, its key moments, and what was seen at them."""

    label: str
    record: TrialRecord
    moments: Sequence[Moment]
    seen: Seen


def case_study_figure(rows: Sequence[Row], house: HouseSpec) -> Figure:
    """Draw the case, about 8 inches wide."""
    xs, ys = zip(*(point for room in house.rooms for point in room.polygon), strict=True)
    deep = _MAP_WIDE * (max(ys) - min(ys) + 1.0) / (max(xs) - min(xs) + 0.7)
    deep = min(deep, _MAP_HIGH)
    seats = [list(row.record.paths) for row in rows]
    wide = _MAP_WIDE + MANY * _VIEW_WIDE
    heads = [_lines(_headline(row), wide, _HEAD_PT, bold=True) for row in rows]
    task = _lines(_task(rows[0].record), wide, _TASK_PT)
    highs = [
        max(deep, _views_high(row) + 0.2) + _HEAD + _LINE * head.count("\n")
        for row, head in zip(rows, heads, strict=True)
    ]
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(sum(highs) + _EDGES + _LINE * task.count("\n"), wide)
        made.set_facecolor("white")
        bands = made.subfigures(len(rows), 1, height_ratios=highs, squeeze=False)[:, 0]
        for band, row, held, head in zip(bands, rows, seats, heads, strict=True):
            band.set_facecolor("white")
            shown = DisplayPictures(row.record.log, row.seen.images)
            grid = band.add_gridspec(
                len(held),
                MANY + 1,
                width_ratios=[_MAP_WIDE, *[_VIEW_WIDE] * MANY],
                height_ratios=[_view_high(seat, shown) for seat in held],
            )
            _draw_map(band.add_subplot(grid[:, 0]), row, house)
            for column, moment in enumerate(row.moments):
                for line, seat in enumerate(held):
                    view = _with_display(row.seen.views[moment.tick][seat], shown, seat, moment.tick)
                    ax = band.add_subplot(grid[line, column + 1])
                    ax.set_anchor("C" if len(held) == 1 else "S" if line == 0 else "N")
                    _draw_view(ax, view, seat, column, moment, first=line == 0)
            band.suptitle(head, x=0.012, ha="left", fontsize=_HEAD_PT, weight="bold", color=matplotlib_svg.INK)
        destined = bool(trial_trace.destinations(rows[0].record.spec, house))
        handles = _legend(rows, destined=destined)
        text_fit.legend(made, handles, len(handles), size=7.0, loc="outside lower left", columnspacing=1.4)
        made.suptitle(task, x=0.012, ha="left", fontsize=_TASK_PT, color=matplotlib_svg.INK)
    return made


def _lines(words: str, wide: float, size: float, *, bold: bool = False) -> str:
    """Words in up to `_HEAD_LINES` lines of the figure's width [in]; an ellipsis stands for those that do not fit."""
    room = wide - 2 * _EDGE_IN
    lines = text_fit.wrap(words, room, size, bold=bold)
    rest = " ".join(lines[_HEAD_LINES - 1 :])
    last = [text_fit.shorten(rest, room, size, bold=bold)] if rest else []
    return "\n".join([*lines[: _HEAD_LINES - 1], *last])


def _views_high(row: Row) -> float:
    """Height of a column of views, one of each seat [in]."""
    shown = DisplayPictures(row.record.log)
    return sum(_view_high(seat, shown) for seat in row.record.paths)


def _view_high(seat: str, displays: DisplayPictures) -> float:
    """Height of a view [in], with the display below it if the seat's display showed anything."""
    return _VIEW_WIDE * (0.75 + (_DISPLAY if seat in displays.people else 0.0))


def _with_display(view: Any, displays: DisplayPictures, seat: str, tick: int) -> Any:
    """A view with panel and map below it, if the seat's display showed anything in the trial."""
    if seat not in displays.people:
        return view
    wide, high = camera_frames.SIZE[0], round(_DISPLAY * camera_frames.SIZE[0])
    strip = displays.strip(seat, tick, wide, high)
    share = view.shape[1] / wide
    return np.vstack([view, strip if share == 1.0 else cv2.resize(strip, None, fx=share, fy=share)])


def _draw_map(ax: Axes, row: Row, house: HouseSpec) -> None:
    record = row.record
    floor_plan.draw_house(ax, house, marked=trial_trace.destinations(record.spec, house), small=True)
    for seat in record.paths:
        trial_figure.draw_path(ax, record.log, seat, words=False)
    for _, start in trial_trace.targets(record.spec, house):
        trial_trace.draw_mark(ax, start.position, "*", 80, trial_trace.TARGET, 0.6, 12)
    busy = [start.position[:2] for _, start in trial_trace.targets(record.spec, house)]
    marks = [(seat, place, letters) for seat in record.paths for place, letters in _places(row, seat)]
    for seat, place, letters in marks:
        others = [other for _, other, _ in marks if other != place]
        inside = [side for side in _CORNERS if _is_on_map(ax, place, letters, side)] or _CORNERS
        side = max(inside, key=lambda side: _room(place, side, [*busy, *others]))
        _letter(ax, place, letters, seat, side)
        busy.append(_beside(place, side))


def _is_on_map(ax: Axes, place: Vec2, letters: str, side: Vec2) -> bool:
    """Whether the letters at this corner end within the map; outside it they could be cut off."""
    (west, east), (south, north) = ax.get_xlim(), ax.get_ylim()
    metres = max((east - west) / _MAP_WIDE, (north - south) / _MAP_HIGH)  # per inch of the map
    wide = _BADGE_IN + text_fit.text_width(letters, _LETTER_PT, bold=True)
    x, y = place[0] + side[0] * metres * wide, place[1] + side[1] * metres * 2.0 * _BADGE_IN
    return west <= x <= east and south <= y <= north


def _room(place: Vec2, side: Vec2, busy: Sequence[Vec2]) -> float:
    """How far letters at this corner are from everything else."""
    return round(min((math.dist(_beside(place, side), other) for other in busy), default=math.inf), 2)


def _beside(place: Vec2, side: Vec2) -> Vec2:
    return (place[0] + _BESIDE_M * side[0], place[1] + _BESIDE_M * side[1])


def _places(row: Row, seat: str) -> list[tuple[Vec2, str]]:
    """Positions of a seat at the moments; letters of moments with the same position stand together."""
    found: list[tuple[Vec2, str]] = []
    for letter, moment in zip(string.ascii_lowercase, row.moments, strict=False):
        place = trial_trace.position_at(row.record.log, seat, moment.tick)
        if found and math.dist(found[-1][0], place) < _NEAR_M:
            found[-1] = (found[-1][0], f"{found[-1][1]} {letter}")
        else:
            found.append((place, letter))
    return found


def _letter(ax: Axes, place: Vec2, letters: str, seat: str, side: Vec2) -> None:
    """Write letters next to the place, where there is room."""
    made = ax.annotate(
        letters,
        place,
        (5 * side[0], 5 * side[1]),
        textcoords="offset points",
        ha="left" if side[0] > 0 else "right",
        va="bottom" if side[1] > 0 else "top",
        **_badge(seat),
    )
    made.set_in_layout(False)  # at the edge of a house it would make this row smaller, and all rows have one scale


def _draw_view(ax: Axes, view: Any, seat: str, column: int, moment: Moment, *, first: bool) -> None:
    """Draw a view in a frame of its seat's colour, with its letter; the first also has the event's words above it."""
    ax.imshow(view, interpolation="none")
    ax.set_xticks([])
    ax.set_yticks([])
    for side in ax.spines.values():
        side.set(visible=True, color=trial_trace.seat_colour(seat), linewidth=1.4)
    letter = string.ascii_lowercase[column]
    ax.annotate(letter, (0.0, 1.0), (6, -6), "axes fraction", "offset points", ha="center", va="center", **_badge(seat))
    if first:
        when = f"{moment.tick * rules.TICK_S:.1f} s"
        ax.set_title(f"{when}: {moment.words}", fontsize=6.8)


def _badge(seat: str) -> dict[str, Any]:
    """The style of a letter in a seat's colour, for the map and the view."""
    box = {"boxstyle": "round,pad=0.2,rounding_size=0.5", "fc": trial_trace.seat_colour(seat), "ec": "white", "lw": 0.7}
    return {"fontsize": _LETTER_PT, "weight": "bold", "color": "white", "bbox": box, "zorder": 15}


def _headline(row: Row) -> str:
    record, seconds = row.record, task_part(row.record.log).ticks * rules.TICK_S
    end = f"done in {seconds:.1f} s" if record.met else f"not done in {seconds:.0f} s"
    sent = trial_trace.messages(record.log)
    failed = [
        f"{fault.seat} failed at {fault.tick * rules.TICK_S:.1f} s ({fault.kind})"
        for seat in record.paths
        if (fault := trial_trace.first_fault(record.log, seat)) is not None
    ]
    said = [
        f"message {number} of {len(sent)} ({trial_trace.outcome_of(record.log, message.message)}): “{message.text}”"
        for number, message in enumerate(sent, 1)
        if any(moment.tick == message.tick for moment in row.moments)
    ]
    return "; ".join([f"{row.label}: {end}", *failed, *said[:1]])


def _task(record: TrialRecord) -> str:
    spec = record.spec
    whose = f"{spec.task.id}, session {spec.session}, trial {spec.index + 1}, T* {spec.task.t_star:.1f} s"
    return f"“{spec.task.instruction}”  {whose}"


def _legend(rows: Sequence[Row], *, destined: bool) -> list[Line2D]:
    seats = dict.fromkeys(seat for row in rows for seat in row.record.paths)
    named = {seat: trial_trace.seat_name(seat, seats) for seat in seats}
    marks = [trial_legend.line(trial_trace.seat_colour(seat), f"{name}, way and view") for seat, name in named.items()]
    marks += [
        trial_legend.mark("o", "white", "start", edge=matplotlib_svg.SOFT, size=6.0),
        trial_legend.mark("o", matplotlib_svg.SOFT, "end", size=6.0),
        trial_legend.mark("*", trial_trace.TARGET, "target at the start", size=9.0),
    ]
    if any(row.record.faults for row in rows):
        marks.append(trial_legend.mark("X", trial_trace.FAILED, "the agent failed", size=7.5))
    if destined:
        marks.append(trial_legend.destination(6.0))
    return marks
