"""Draws one trial on a time axis: one row per seat, with its actions and messages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from hthor import rules
from hthor.episode import EpisodeLog, Fault
from hthor.report.drawing import trial_trace
from hthor.types import TrialSpec
from hthor.types.events import Progress

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_WORD = 0.09
"""Share of the time axis that a word takes up."""
_LETTER = 0.0095
"""Share of the time axis that a letter on a badge takes up."""
_Side = Literal["left", "center", "right"]
_SIDES: tuple[_Side, _Side] = ("right", "left")
"""On which side of its mark the word of each of two close moments stands, the earlier moment first."""
_LIFTS = (6, -14, 15)
"""Heights of a word above its mark [pt], the best one first."""
_LINE_PT = 8.5
"""Height of a word [pt]."""


def draw_timeline(ax: Axes, spec: TrialSpec, log: EpisodeLog) -> None:
    """Draw who did what and when: one row per seat, and one for the progress of a goal with several parts."""
    seats = list(log.paths)
    steps = [event for event in log.events if isinstance(event, Progress)]
    rows = len(seats) + (log.progress is not None)
    end, limit = log.ticks * rules.TICK_S, spec.task.time_limit
    ax.set_xlim(-1, limit + 1)
    ax.set_ylim(-rows + 0.4, 0.75)
    words = _Words(ax, _WORD * limit)
    for row, seat in enumerate(seats):
        fault = trial_trace.first_fault(log, seat)
        until = end if fault is None else fault.tick * rules.TICK_S
        ax.plot(
            (0, until), (-row, -row), color=trial_trace.seat_colour(seat), lw=2.2, alpha=0.35, solid_capstyle="butt"
        )
        if fault is not None:
            ax.plot((until, end), (-row, -row), color=trial_trace.GONE, lw=1.0, ls=":", solid_capstyle="butt")
        _draw_badges(ax, log, seat, -row, _LETTER * limit)
        _draw_acts(ax, log, seat, -row, words)
        if fault is not None:
            _mark_fault(ax, fault, until, -row)
    if rows > len(seats):
        _draw_progress(ax, steps, end, -len(seats), _WORD * limit)
    beside = abs(spec.task.t_star - end) < _WORD * limit  # else one would be written over the other
    sides = _SIDES if beside else ("center", "center")
    first, last = sides if spec.task.t_star <= end else sides[::-1]
    if spec.task.t_star <= limit:  # a T* beyond the time limit has no place on the axis
        _moment(ax, spec.task.t_star, "T*", "#777777", ":", first)
    word, shade = trial_trace.end_word(log), trial_trace.TARGET if log.met else trial_trace.FAILED
    _moment(ax, end, word, shade, "-", last)
    names = [trial_trace.seat_name(seat, seats) for seat in seats]
    ax.set_yticks([-row for row in range(rows)], [*names, "progress"][:rows], fontsize=8)
    ax.set_xlabel("time [s]", fontsize=8)
    ax.tick_params(axis="x", labelsize=7.5)
    ax.tick_params(axis="y", length=0)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)


def _draw_progress(ax: Axes, steps: Sequence[Progress], end: float, row: float, word_s: float) -> None:
    """Draw a bar that darkens as more of the goal is met, with the shares in words."""
    marks = [(0.0, 0.0), *((event.tick * rules.TICK_S, event.value) for event in steps)]
    for (begin, value), (until, _) in zip(marks, [*marks[1:], (end, 0.0)], strict=True):
        ax.barh(row, until - begin, left=begin, height=0.42, color=trial_trace.TARGET, alpha=0.08 + 0.6 * value, lw=0)
    following = math.inf
    for begin, value in reversed(marks[1:]):
        if following - begin > word_s / 2:
            ax.text(begin + 0.4, row, f"{100.0 * value:.0f} %", fontsize=7, va="center", color=trial_trace.INK)
            following = begin


def _mark_fault(ax: Axes, fault: Fault, seconds: float, row: float) -> None:
    trial_trace.draw_mark(ax, (seconds, row), "X", 56, trial_trace.FAILED, 0.8, 15)
    told = f"{fault.kind} at {seconds:.1f} s"
    ax.annotate(told, (seconds, row), (7, 5), textcoords="offset points", fontsize=7, color=trial_trace.FAILED)


def _moment(ax: Axes, seconds: float, name: str, shade: str, style: str, side: _Side) -> None:
    ax.axvline(seconds, color=shade, lw=1.0, ls=style, zorder=1)
    ax.text(seconds, 1.02, name, transform=ax.get_xaxis_transform(), fontsize=7.5, color=shade, ha=side)


def _draw_badges(ax: Axes, log: EpisodeLog, seat: str, row: float, letter_s: float) -> None:
    """Draw the numbers of the messages that a seat sent."""
    sent = [(number, event) for number, event in enumerate(trial_trace.messages(log), 1) if event.seat == seat]
    marks = [(number, event, (event.tick * rules.TICK_S, row)) for number, event in sent]
    for group in trial_trace.group_messages(log, marks, letter_s, 1.0):
        half = 0.5 * letter_s * (len(group.words) + 2)  # so that the seat's name is not covered
        trial_trace.draw_badge(ax, (max(group.place[0], half), row), group.words, group.shade)


def _draw_acts(ax: Axes, log: EpisodeLog, seat: str, row: float, words: _Words) -> None:
    """Draw what a seat did and answered, with words where there is room for them."""
    verbs = {kind: verb for kind, (_, verb) in trial_trace.ACTS.items()}
    verbs |= {"accepted": "accepts", "declined": "declines", "answered": "answers"}
    for event in log.events:
        if event.seat == seat and event.kind in verbs:
            x = event.tick * rules.TICK_S
            marker = trial_trace.ACTS.get(event.kind, ("o", ""))[0]
            trial_trace.draw_mark(ax, (x, row), marker, 26, trial_trace.seat_colour(seat), 0.6, 3)
            words.write(verbs[event.kind], x, row)


class _Words:
    """Writes words beside marks so that none covers another, in the same row or in the next; some are left out."""

    def __init__(self, ax: Axes, width_s: float) -> None:
        self.ax = ax
        self.width_s = width_s
        (_, low), (_, high) = ax.transData.transform([(0.0, 0.0), (0.0, 1.0)])
        figure = ax.get_figure(root=True)
        assert figure is not None
        self._row_pt = float(high - low) * 72.0 / figure.dpi
        self._written: list[tuple[float, float]] = []

    def write(self, word: str, seconds: float, row: float) -> None:
        """Write a word at the best free height."""
        for lift in _LIFTS:
            place = seconds, row * self._row_pt + lift
            if all(abs(place[0] - x) > self.width_s or abs(place[1] - y) >= _LINE_PT for x, y in self._written):
                self._written.append(place)
                look: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7, "ha": "center"}
                self.ax.annotate(word, (seconds, row), (0, lift), color=trial_trace.INK, **look)
                return
