"""Draws the way of one person in one trial, and the places that messages named to them; nobody else's way."""

from __future__ import annotations

from matplotlib.figure import Figure

from hthor.report.drawing import floor_plan, trial_figure, trial_trace
from hthor.report.html import matplotlib_svg
from hthor.report.person.own_session import OwnTrial

_WIDE, _HIGH = 3.5, 2.75


def figure(trial: OwnTrial) -> Figure:
    """The house from above; all plans have one size, whatever the house."""
    record = trial.record
    with matplotlib_svg.style():
        made = matplotlib_svg.new_figure(_HIGH, _WIDE)
        made.set_facecolor("white")  # a plan's colours are those of light paper
        ax = made.subplots()
        marked = trial_trace.destinations(record.spec, trial.house)
        floor_plan.draw_house(ax, trial.house, marked=marked, small=True)
        trial_figure.draw_path(ax, record.log, trial.seat, words=False)
        for number, message in enumerate(trial.messages, 1):
            if message.place is not None:
                shade = trial_trace.MESSAGE if message.answer == "accepted" else trial_trace.IDLE_MESSAGE
                trial_trace.draw_badge(ax, message.place[:2], str(number), shade)
    return made
