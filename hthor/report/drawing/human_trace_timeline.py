"""Draws what a person did, noticed, chose and was shown, on a time axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec import UNSET

from hthor import rules
from hthor.episode import task_began
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay.human_trace import HumanTrace
from hthor.humans.core.thoughts import Aim, Forgot, Noticed, RankedOptions, TrustNow, Weighed
from hthor.report.drawing import trial_trace
from hthor.types.events import Accepted, Answered, Attempt, Covered, Declined, Exposure, Offer, Shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LANES = {
    "trust": "trust",
    "messages": "shown",
    "hands": "attempt",
    "chooses": "choice",
    "noticed": "noticed",
    "is about": "aim",
}
"""The kind of event in each lane, the lowest lane first."""
_TERMS = {"a0": "willing", "trust": "trust", "gain": "gain", "load": "load", "again": "again"}
_LANE_IN = 0.46
_SHADES = {"search": "#9ecae1", "follow": "#c9a6d6", "fetch": "#a1d99b", "deliver": "#74c476", "begin": "#dddddd"}
_ANSWERS = {
    "accepted": trial_trace.MESSAGE,
    "answered": trial_trace.MESSAGE,
    "declined": trial_trace.IDLE_MESSAGE,
    "covered": "#cccccc",
}
_TRIED: dict[object, str] = {True: "#74c476", False: trial_trace.FAILED}
_CHAR, _NAMES = 0.008, 4
"""Share of the time axis that a letter takes up; how many missed objects are named."""


def row_names(stream: HumanTrace) -> list[str]:
    """The lanes that have events, the lowest first."""
    kinds = {event.kind for event in stream.events}
    return [name for name, kind in _LANES.items() if kind in kinds]


def timeline_height(stream: HumanTrace) -> float:
    """Height of the lanes [in]."""
    return _LANE_IN * len(row_names(stream)) + 0.7


def option_chances(choice: RankedOptions, beta: float) -> dict[str, float]:
    """Probability that each option was chosen, by name: value^beta, scaled to a sum of 1."""
    values = [max(value, 1e-12) for value in choice.values]
    top = max(values)
    weights = [(value / top) ** beta for value in values]
    total = sum(weights)
    return {name: weight / total for name, weight in zip(choice.options, weights, strict=True)}


def draw_timeline(ax: Axes, record: TrialRecord, stream: HumanTrace) -> None:
    """Draw the lanes, trust lowest."""
    events, end, limit = stream.events, record.ticks * rules.TICK_S, record.spec.task.time_limit
    limit += (task_began(record.log) or 0) * rules.TICK_S
    names = row_names(stream)
    rows = {name: float(row) for row, name in enumerate(names)}
    _draw_aims(ax, [event for event in events if isinstance(event, Aim)], end, rows["is about"], _CHAR * limit)
    wanted = {job.target for job in record.spec.task.goal.todo}
    if "noticed" in rows:
        _draw_noticed(ax, stream, wanted, rows["noticed"], end)
    for event in events:
        if isinstance(event, RankedOptions):
            _draw_choice(ax, event, stream.traits["beta"], rows["chooses"])
        elif isinstance(event, Attempt):
            _draw_attempt(ax, event, end, rows["hands"])
        elif isinstance(event, Shown):
            _draw_message(ax, event, stream, end, rows["messages"])
    shade = trial_trace.seat_colour(stream.seat)
    _draw_trust(ax, [event for event in events if isinstance(event, TrustNow)], end, shade)
    top = len(names) - 0.4
    ax.axvline(end, color=trial_trace.TARGET if record.met else trial_trace.FAILED, lw=1.0)
    ax.text(end, top + 0.05, "done" if record.met else "time is up", fontsize=7.5, ha="center", color=trial_trace.INK)
    ax.set_xlim(-1.0, limit + 1.0)
    ax.set_ylim(-0.55, top)
    ax.set_yticks(range(len(names)), names, fontsize=8)
    ax.set_xlabel("time [s]", fontsize=8)
    ax.tick_params(axis="x", labelsize=7.5)
    ax.tick_params(axis="y", length=0)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)


def _draw_aims(ax: Axes, aims: list[Aim], end: float, row: float, letter_s: float) -> None:
    starts = [aim.tick * rules.TICK_S for aim in aims]
    for aim, begin, until in zip(aims, starts, [*starts[1:], end], strict=True):
        words = aim.about.replace("_", " ")
        ax.barh(row, until - begin, left=begin, height=0.6, color=_SHADES.get(words.split()[0], "#eeeeee"), lw=0)
        verb = words.split()[0]
        label = next((text for text in (words, verb) if len(text) * letter_s < until - begin), "")
        ax.text(begin + 0.3, row, label, fontsize=7, va="center", color=trial_trace.INK)
        if not label:
            ax.text(begin, row - 0.43, verb, fontsize=6, va="center", color=trial_trace.INK)


def _draw_noticed(ax: Axes, stream: HumanTrace, wanted: set[str], row: float, end: float) -> None:
    """Draw a line when furniture is noticed, red when it is forgotten; a star and a name for objects of the task."""
    seen = {entry.object: entry for entry in stream.events if isinstance(entry, Exposure)}
    last, high = -math.inf, False
    for event in stream.events:
        if not isinstance(event, (Noticed, Forgot)):
            continue
        x, name = event.tick * rules.TICK_S, event.object
        if isinstance(event, Noticed) and name in wanted:
            ax.scatter(x, row, s=60, marker="*", color=trial_trace.TARGET, edgecolor="white", lw=0.6, zorder=4)
            high = not high and x - last < 20.0
            after = f", {seen[name].seconds:.1f} s in view before" if name in seen else ""
            words = _words(name) + after
            ax.text(x + 0.6, row + (0.3 if high else 0.12), words, fontsize=7, color=trial_trace.TARGET)
            last = x
        else:
            shade = trial_trace.FAILED if isinstance(event, Forgot) else "#8b8478"
            ax.plot((x, x), (row - 0.22, row + 0.02), color=shade, lw=0.9, alpha=0.8)
    missed = [f"{_words(name)} ({entry.seconds:.1f} s)" for name, entry in seen.items() if not entry.noticed]
    if missed:
        more = ", …" if len(missed) > _NAMES else ""
        words = f"in view, not noticed: {', '.join(missed[:_NAMES])}{more}"
        ax.text(end - 0.4, row - 0.36, words, fontsize=6.5, ha="right", va="center", color=trial_trace.FAILED)


def _draw_choice(ax: Axes, choice: RankedOptions, beta: float, row: float) -> None:
    """Draw a column of the options' probabilities, in which the chosen option is coloured."""
    x, low = choice.tick * rules.TICK_S, row - 0.36
    for name, share in option_chances(choice, beta).items():
        chosen = name == choice.chosen
        face = trial_trace.TARGET if chosen else "#e6e6e6"
        ax.bar(x, 0.72 * share, bottom=low, width=0.8, color=face, edgecolor="white", lw=0.3, zorder=3)
        low += 0.72 * share
    words = choice.chosen
    label = "doorway" if words.startswith("door ") else _words(words)
    ax.text(x, row + 0.38, label, fontsize=5.8, ha="center", va="bottom", color=trial_trace.INK)


def _draw_attempt(ax: Axes, attempt: Attempt, end: float, row: float) -> None:
    begin = attempt.tick * rules.TICK_S
    seconds = end - begin if attempt.seconds is UNSET else attempt.seconds
    shade = _TRIED.get(attempt.ok, "#bbbbbb")
    ax.barh(row, seconds, left=begin, height=0.5, color=shade, alpha=0.8, edgecolor="white", lw=0.8)
    ax.text(begin + 0.2, row, attempt.what, fontsize=6.5, va="center", color=trial_trace.INK, clip_on=True)


def _draw_message(ax: Axes, shown: Shown, stream: HumanTrace, end: float, row: float) -> None:
    """Draw a bar from the time when a message was shown to its outcome."""
    number, begin = shown.message, shown.tick * rules.TICK_S
    ends = (event for event in stream.events if isinstance(event, (Accepted, Declined, Covered, Answered)))
    fate = next((event for event in ends if event.message == number), None)
    until = end if fate is None else fate.tick * rules.TICK_S
    shade = "#dddddd" if fate is None else _ANSWERS[fate.kind]
    ax.barh(row, until - begin, left=begin, height=0.42, color=shade, alpha=0.85, lw=0)
    trial_trace.draw_badge(ax, (begin, row), str(number + 1), shade if fate is not None else "#999999")
    if fate is not None and not isinstance(fate, Covered):
        ax.text(until + 0.4, row, fate.kind, fontsize=6.5, va="center", color=trial_trace.INK)


def _draw_trust(ax: Axes, told: list[TrustNow], end: float, shade: str) -> None:
    """Draw the mean trust, from 0 at the bottom of its lane to 1 at the top."""
    if not told:
        return
    xs = [event.tick * rules.TICK_S for event in told]
    ys = [0.8 * event.mean - 0.4 for event in told]
    ax.fill_between((0.0, end), -0.4, 0.4, color="#f3f3f3", lw=0, zorder=0)
    ax.step([*xs, end], [*ys, ys[-1]], where="post", color=shade, lw=1.4)
    for x, event, y in zip(xs, told, ys, strict=True):
        ax.text(min(x, end) + 0.4, y + 0.12, f"{event.mean:.2f}", fontsize=6.5, color=shade)


def _words(name: str) -> str:
    """The id of an object or a piece of furniture in words, without its number."""
    kind, _, number = name.rpartition("_")
    return (kind if number.isdecimal() else name).replace("_", " ")


def offers(stream: HumanTrace) -> list[str]:
    """A line for each message that was weighed: the reasons for and against it, and the answer."""
    numbers = {entry.number: entry.message + 1 for entry in stream.events if isinstance(entry, Offer)}
    lines = []
    for event in stream.events:
        if isinstance(event, Weighed):
            terms = " ".join(f"{words} {event.terms[name] + 0.0:+.2f}" for name, words in _TERMS.items())
            share = f"chance {100.0 * event.share:.0f} %" if event.relevant else "not about the task"
            end = f"{event.answer}{', by a slip' if event.slipped else ''}"
            which, when = numbers.get(event.number, event.number), event.tick * rules.TICK_S
            lines.append(f"message {which}, read at {when:.1f} s:  {terms}  →  {share}: {end}")
    return lines
