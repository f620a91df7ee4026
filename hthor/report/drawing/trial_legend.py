"""The legend of a drawn trial: an entry for everything that the figure or the video shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hthor.episode import EpisodeLog, task_part
from hthor.report.drawing import floor_plan, trial_trace
from hthor.report.drawing.person_display import timeline_bars
from hthor.types import HouseSpec, TrialSpec

if TYPE_CHECKING:
    from matplotlib.artist import Artist


def legend_entries(spec: TrialSpec, log: EpisodeLog, house: HouseSpec, *, moving: bool = False) -> list[Artist]:
    """The legend's entries.

    Args:
        moving: whether the legend is for a video, which does not mark starts, ends, actions and messages.
    """
    found: list[Artist] = [
        line(trial_trace.seat_colour(human.seat), trial_trace.person_words(human, spec)) for human in spec.humans
    ]
    found += [line(trial_trace.seat_colour(robot.seat), trial_trace.robot_words(robot)) for robot in spec.robots]
    if spec.task.phases and not moving:
        found.append(Line2D([], [], color="#555555", lw=0.7, ls=(0, (1, 1)), label=trial_trace.phase_words(spec)))
    if not moving:
        found += [mark("o", "white", "start", edge="#555555"), mark("o", "#555555", "end")]
    found.append(mark("*", trial_trace.TARGET, "target at the start", size=9))
    if any(job.place is not None for job in spec.task.goal.todo) and not moving:
        found.append(mark("*", "white", "where it belongs", edge=trial_trace.TARGET, size=8))
    if trial_trace.destinations(spec, house):
        found.append(destination())
    if moving and trial_trace.messages(log):
        found.append(mark("o", "none", "where a message says it is", edge=trial_trace.MESSAGE, size=9))
    if log.faults:
        found.append(mark("X", trial_trace.FAILED, "the agent failed", size=8))
    if any(floor_plan.is_flat(thing) for thing in house.things):
        found.append(
            Patch(
                facecolor=floor_plan.RUG, edgecolor=floor_plan.RUG_EDGE, hatch=floor_plan.RUG_HATCH, label="rug, flat"
            )
        )
    return found if moving else [*found, *_marks(task_part(log)), *timeline_bars.legend_entries(task_part(log))]


def _marks(log: EpisodeLog) -> list[Artist]:
    """The entries for marks of messages and actions."""
    shades = set(trial_trace.message_colours(log).values())
    words = {trial_trace.MESSAGE: "accepted", trial_trace.IDLE_MESSAGE: "not accepted"}
    found: list[Artist] = [mark("o", shade, f"message, {words[shade]}", size=7) for shade in words if shade in shades]
    present = {event.kind for event in log.events}
    return found + [mark(shape, "#555555", verb) for kind, (shape, verb) in trial_trace.ACTS.items() if kind in present]


def line(shade: str, label: str) -> Line2D:
    """The entry for a path."""
    return Line2D([], [], color=shade, lw=2, label=label)


def mark(marker: str, face: str, label: str, *, edge: str = "white", size: float = 6.5) -> Line2D:
    """The entry for a mark of ``size`` [pt]."""
    return Line2D(
        [], [], ls="", marker=marker, markersize=size, markerfacecolor=face, markeredgecolor=edge, label=label
    )


def destination(size: float = 6.5) -> Line2D:
    """The entry for the places where objects belong."""
    return mark("s", floor_plan.MARKED, "destination", edge=floor_plan.MARKED_EDGE, size=size)
