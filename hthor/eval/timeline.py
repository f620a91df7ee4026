"""One trial along the clock: a row a seat, with what it did and said; knows nothing of the house."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.eval import trace
from hthor.types import HUMAN, TrialSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_timeline(ax: Axes, spec: TrialSpec, log: EpisodeLog) -> None:
    """Who did what when: one row a seat, a row for the messages."""
    seats = list(log.paths)
    end, limit = log.ticks * rules.TICK_S, spec.task.time_limit
    for row, seat in enumerate(seats):
        ax.plot((0, end), (-row, -row), color=trace.colour(seat), lw=2.2, alpha=0.35, solid_capstyle="butt")
        _timeline_marks(ax, log, seat, -row)
    ax.axvline(spec.task.t_star, color="#888888", lw=0.8, ls=":")
    ax.text(spec.task.t_star, 0.62, "T*", fontsize=7.5, color="#666666", ha="center")
    ax.axvline(end, color=trace.TARGET if log.met else trace.FAILED, lw=1.2)
    ax.text(
        end,
        0.62,
        "done" if log.met else "time is up",
        fontsize=7.5,
        ha="center",
        color=trace.TARGET if log.met else trace.FAILED,
    )
    ax.set_xlim(-1, limit + 1)
    ax.set_ylim(-len(seats) + 0.4, 1.05)
    ax.set_yticks(
        [-row for row in range(len(seats))], ["person" if seat == HUMAN else seat for seat in seats], fontsize=8
    )
    ax.set_xlabel("time [s]", fontsize=8)
    ax.tick_params(axis="x", labelsize=7.5)
    ax.tick_params(axis="y", length=0)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)


def _timeline_marks(ax: Axes, log: EpisodeLog, seat: str, row: float) -> None:
    for number, event in enumerate(trace.messages(log), 1):
        if event.seat == seat:
            trace.badge(ax, (event.tick * rules.TICK_S, row), str(number))
    words = {**{kind: verb for kind, (_, verb) in trace.ACTS.items()}, "confirmed": "confirms", "declined": "declines"}
    last = -math.inf
    for event in log.events:
        if event.seat != seat or event.kind not in words:
            continue
        x = event.tick * rules.TICK_S
        marker = trace.ACTS.get(event.kind, ("o", ""))[0]
        ax.scatter(x, row, s=26, marker=marker, color=trace.colour(seat), edgecolor="white", linewidths=0.6, zorder=3)
        lift = -14 if x - last < 7.0 else 6
        last = x if lift > 0 else last
        ax.annotate(
            words[event.kind], (x, row), (0, lift), textcoords="offset points", fontsize=7, ha="center", color=trace.INK
        )
