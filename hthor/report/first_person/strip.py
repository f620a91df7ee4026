"""Draws a trial through the eyes of one seat as a strip: its views at key moments, with what happened and was said."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.report.drawing import lettering, text_fit, trial_figure, trial_trace
from hthor.report.drawing.film import captions
from hthor.report.first_person.seat_views import SeatViews
from hthor.report.page import key_moments
from hthor.report.page.key_moments import Moment
from hthor.types import HouseSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MANY, _COLUMNS = 8, 4
"""Views at most, and views in a row."""
_WIDE_IN, _EDGE_IN, _GAP_IN = 9.0, 0.12, 0.1
"""Width of the figure, free space around it, and space between views [in]."""
_WORDS_PT, _TITLE_PT, _LINE_IN = 7.5, 10.0, 0.15
"""Size of the letters below a view and of the title [pt]; distance of lines below a view [in]."""
_SAID_LINES = 3
"""Lines at most of what is said at a moment."""


def strip_moments(record: TrialRecord, house: HouseSpec, seat: str) -> list[Moment]:
    """The moments that the strip of a seat shows: the start, the key moments and the end."""
    return [Moment(tick=0, words="start"), *key_moments.key_moments(record, house, MANY - 1, seat)]


@lettering.plain_lettering()
def strip_figure(views: SeatViews, moments: list[Moment]) -> Figure:
    """Draw the strip, about 9 inches wide, from views at ``moments``."""
    pictures = [views.picture(moment.tick) for moment in moments]
    high, wide = pictures[0].shape[:2]
    columns = min(_COLUMNS, len(moments))
    rows = math.ceil(len(moments) / columns)
    each = (_WIDE_IN - 2 * _EDGE_IN - (columns - 1) * _GAP_IN) / columns
    words_in = (1 + _SAID_LINES) * _LINE_IN + _GAP_IN
    inches = _WIDE_IN - 2 * _EDGE_IN
    title = trial_figure.headline(views.record.spec, views.record.log, inches, _TITLE_PT)
    title += "\n" + text_fit.wrapped(f"seen by {views.name}", inches, _TITLE_PT)
    head = _EDGE_IN + (title.count("\n") + 1) * _TITLE_PT * 1.4 / 72.0
    tall = head + rows * (each * high / wide + words_in) + _EDGE_IN
    sheet = Figure(figsize=(_WIDE_IN, tall), dpi=160, facecolor="white")
    sheet.text(_EDGE_IN / _WIDE_IN, 1.0 - _EDGE_IN / tall, title, fontsize=_TITLE_PT, va="top", color=trial_trace.INK)
    for number, (moment, picture) in enumerate(zip(moments, pictures, strict=True)):
        row, column = divmod(number, columns)
        left, top = _EDGE_IN + column * (each + _GAP_IN), tall - head - row * (each * high / wide + words_in)
        box = (left / _WIDE_IN, (top - each * high / wide) / tall, each / _WIDE_IN, each * high / wide / tall)
        _draw_view(sheet.add_axes(box), views, moment, picture, each)
    return sheet


def _draw_view(ax: Axes, views: SeatViews, moment: Moment, picture: Any, inches: float) -> None:
    """Draw a view in a frame of its seat's colour, with the time, what happened, and what is said below it."""
    ax.imshow(picture, interpolation="none", aspect="auto")  # the axes have the picture's shape
    ax.set_xticks([])
    ax.set_yticks([])
    for side in ax.spines.values():
        side.set(visible=True, color=trial_trace.seat_colour(views.seat), linewidth=1.4)
    lines = [(f"{moment.tick * rules.TICK_S:.1f} s: {moment.words}", trial_trace.INK, "bold")]
    message = captions.newest_message(views.record.log, moment.tick, views.seat)
    if message is not None:
        said = text_fit.wrap(captions.message_words(message), inches, _WORDS_PT)
        said = [*said[: _SAID_LINES - 1], " ".join(said[_SAID_LINES - 1 :])]
        lines += [(line, trial_trace.MESSAGE, "normal") for line in said if line]
    for number, (line, shade, weight) in enumerate(lines):
        ax.annotate(
            text_fit.shorten(line, inches, _WORDS_PT, bold=weight == "bold"),
            (0.0, 0.0),
            (0.0, -72.0 * (0.06 + number * _LINE_IN)),
            xycoords="axes fraction",
            textcoords="offset points",
            fontsize=_WORDS_PT,
            color=shade,
            weight=weight,
            va="top",
        )
