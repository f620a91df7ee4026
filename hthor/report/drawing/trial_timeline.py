"""Draws one trial on a time axis: one row per seat, with its actions and messages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

from hthor import rules
from hthor.episode import EpisodeLog, Fault, task_part
from hthor.eval.metrics.definitions.theory_of_mind import belief_scores
from hthor.report.drawing import trial_trace
from hthor.report.drawing.person_display import timeline_bars
from hthor.types import TrialSpec
from hthor.types.events import Progress, SaidReady

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
_BELIEF_HEIGHT = 0.6
"""Height of the row of beliefs for a score of 1."""
_LINE_PT = 8.5
"""Height of a word [pt]."""


def draw_timeline(ax: Axes, spec: TrialSpec, log: EpisodeLog) -> None:
    """Draw who did what and when.

    There is one row per seat, one for the progress of a goal with several parts, and one for robots' knowledge of a
    person's beliefs, where they predicted these. Time counts from the beginning of the task itself; the phases before
    it are a grey area.
    """
    whole, log = log, task_part(log)
    before = (whole.ticks - log.ticks) * rules.TICK_S
    seats, known = list(log.paths), belief_scores(log)
    steps = [event for event in log.events if isinstance(event, Progress)]
    rows = row_count(log)
    end, limit = log.ticks * rules.TICK_S, spec.task.time_limit
    span = before + limit
    ax.set_xlim(-before - 1, limit + 1)
    ax.set_ylim(-rows + 0.4, 0.75)
    words = _Words(ax, _WORD * span)
    if before:
        _draw_before(ax, spec, whole, before)
    for row, seat in enumerate(seats):
        fault = trial_trace.first_fault(log, seat)
        until = end if fault is None else fault.tick * rules.TICK_S
        ax.plot(
            (0, until), (-row, -row), color=trial_trace.seat_colour(seat), lw=2.2, alpha=0.35, solid_capstyle="butt"
        )
        if fault is not None:
            ax.plot((until, end), (-row, -row), color=trial_trace.GONE, lw=1.0, ls=":", solid_capstyle="butt")
        timeline_bars.draw_bars(ax, log, seat, -row)
        _draw_badges(ax, log, seat, -row, _LETTER * span)
        _draw_acts(ax, log, seat, -row, words)
        if fault is not None:
            _mark_fault(ax, fault, until, -row)
    if known:
        _draw_beliefs(ax, known, end, 1 - rows)
    if log.progress is not None:
        _draw_progress(ax, steps, end, -len(seats), _WORD * span)
    beside = abs(spec.task.t_star - end) < _WORD * span  # else one would be written over the other
    sides = _SIDES if beside else ("center", "center")
    first, last = sides if spec.task.t_star <= end else sides[::-1]
    if spec.task.t_star <= limit:  # a T* beyond the time limit has no place on the axis
        _moment(ax, spec.task.t_star, "T*", "#777777", ":", first)
    word, shade = trial_trace.end_word(log), trial_trace.TARGET if log.met else trial_trace.FAILED
    _moment(ax, end, word, shade, "-", last)
    names = [trial_trace.seat_name(seat, seats) for seat in seats]
    names += ["progress"] * (log.progress is not None) + ["beliefs known"] * bool(known)
    ax.set_yticks([-row for row in range(rows)], names, fontsize=8)
    ax.set_xlabel("time [s]", fontsize=8)
    ax.tick_params(axis="x", labelsize=7.5)
    ax.tick_params(axis="y", length=0)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)


def row_count(log: EpisodeLog) -> int:
    """How many rows the time axis has."""
    return len(log.paths) + (log.progress is not None) + bool(belief_scores(log))


def _draw_beliefs(ax: Axes, scores: Sequence[tuple[int, float]], end: float, row: float) -> None:
    """Draw how well the robots knew what the person believed, from 0 (the row's lower edge) to 1, until asked again."""
    seconds = [tick * rules.TICK_S for tick, _ in scores]
    low = row - _BELIEF_HEIGHT / 2
    for (begin, until), (_, score) in zip(pairwise([*seconds, end]), scores, strict=True):
        size = _BELIEF_HEIGHT * score
        ax.barh(low + size / 2, until - begin, left=begin, height=size, color=trial_trace.IDLE_MESSAGE, lw=0)
    ax.plot((seconds[0], end), (low + _BELIEF_HEIGHT,) * 2, color=trial_trace.INK, lw=0.5, ls=":")


def _draw_before(ax: Axes, spec: TrialSpec, log: EpisodeLog, before: float) -> None:
    """Draw the time before the task itself, and when each seat was ready for it."""
    ax.axvspan(-before, 0.0, color="#eef0f3", lw=0, zorder=0)
    look: dict[str, Any] = {"transform": ax.get_xaxis_transform(), "fontsize": 7.5, "color": "#777777", "ha": "center"}
    ax.text(-before / 2.0, 1.02, trial_trace.phase_words(spec), **look)
    for row, seat in enumerate(log.paths):
        shade = trial_trace.seat_colour(seat)
        ax.plot((-before, 0.0), (-row, -row), color=shade, lw=2.2, alpha=0.15, solid_capstyle="butt")
        for event in log.events:
            if isinstance(event, SaidReady) and event.seat == seat:
                x = event.tick * rules.TICK_S - before
                trial_trace.draw_mark(ax, (x, -row), "o", 26, shade, 0.6, 3)
                place = {"xytext": (0, 6), "textcoords": "offset points", "ha": "right", "fontsize": 7}
                ax.annotate("ready", (x, -row), color=trial_trace.INK, **place)  # type: ignore[arg-type]


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
