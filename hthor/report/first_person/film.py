"""Draws a trial through the eyes of one seat as a video, as fast as the video from above, so that both run together."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.report.drawing import trial_trace, trial_video
from hthor.report.drawing.film import captions, frame_words, webm_file
from hthor.report.drawing.film.frame_words import LINE_PX
from hthor.report.first_person.seat_views import SeatViews

_WIDE_PX, _LEFT_PX, _RIM_PX, _BASE_PX = 640, 12, 4, 8
"""Least width of a frame, where words begin, the width of the rim in the seat's colour, and space below words [px]."""
_SAID_LINES = 3
"""Lines at most of what is said."""
_PAPER = 255


def film_ticks(record: TrialRecord) -> list[int]:
    """The ticks that the video shows: those of the logged poses, and the last."""
    return sorted({*range(0, record.ticks, rules.LOG_EVERY_TICKS), record.ticks})


def write_film(path: Path, views: SeatViews) -> None:
    """Write the WebM video of views at `film_ticks`.

    Raises:
        HthorError: if the OpenCV on this machine cannot write such a video to ``path``.
    """
    ticks = film_ticks(views.record)
    first = draw_frame(views, ticks[0])
    high, wide = first.shape[:2]
    frames: Iterator[Any] = (draw_frame(views, tick) for tick in ticks)
    webm_file.write_webm(path, frames, len(ticks), (wide, high), trial_video.frame_rate())


def draw_frame(views: SeatViews, tick: int) -> Any:
    """One frame, (H, W, 3) uint8, blue first: the instruction, the view, the clock, and what is said, never over it."""
    view = views.picture(tick)
    high, width = view.shape[:2]
    wide = max(_WIDE_PX, width + 2 * _RIM_PX)
    title = frame_words.lines(_title(views), wide - 2 * _LEFT_PX)
    top = LINE_PX * len(title) + _BASE_PX
    frame = np.full(
        (_even(top + high + 2 * _RIM_PX + (1 + _SAID_LINES) * LINE_PX + _BASE_PX), wide, 3), _PAPER, np.uint8
    )
    for number, line in enumerate(title, 1):
        frame_words.write_words(frame, line, (_LEFT_PX, number * LINE_PX - _BASE_PX // 2), trial_trace.INK)
    left = (wide - width) // 2
    rim = (slice(top, top + high + 2 * _RIM_PX), slice(left - _RIM_PX, left + width + _RIM_PX))
    frame[rim] = frame_words.bgr(trial_trace.seat_colour(views.seat))
    frame[top + _RIM_PX : top + _RIM_PX + high, left : left + width] = view[:, :, ::-1]
    _write_captions(frame, views, tick, top + high + 2 * _RIM_PX)
    return frame


def _title(views: SeatViews) -> str:
    return f"“{views.record.spec.task.instruction}” seen by {views.name}"


def _write_captions(frame: Any, views: SeatViews, tick: int, top: int) -> None:
    x = _LEFT_PX
    for words, shade in captions.status(views.record.log, tick):
        x += frame_words.write_words(frame, words, (x, top + LINE_PX - _BASE_PX // 2), shade) + _LEFT_PX
    message = captions.newest_message(views.record.log, tick, views.seat)
    if message is None:
        return
    lines = frame_words.lines(captions.message_words(message), frame.shape[1] - 2 * _LEFT_PX)
    shown = [*lines[: _SAID_LINES - 1], " ".join(lines[_SAID_LINES - 1 :])]  # what does not fit ends in an ellipsis
    for number, line in enumerate(filter(None, shown), 2):
        frame_words.write_words(frame, line, (_LEFT_PX, top + number * LINE_PX - _BASE_PX // 2), trial_trace.MESSAGE)


def _even(length: int) -> int:
    """A video's sides have to be even."""
    return length + length % 2
