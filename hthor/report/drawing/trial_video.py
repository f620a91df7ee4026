"""Draws one trial as a video from above, at several times real speed."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from hthor import rules
from hthor.episode import EpisodeLog, task_began
from hthor.report.drawing import floor_plan, lettering, text_fit, trial_figure, trial_legend, trial_trace
from hthor.report.drawing.film import captions, frame_words, webm_file
from hthor.report.drawing.film.frame_words import bgr
from hthor.report.drawing.person_display.display_pictures import DisplayPictures
from hthor.types import HouseSpec, TrialSpec
from hthor.types.events import Lifted, Picked

SPEED = 4
"""Seconds of the trial per second of the video."""
_TAKEN = (Picked, Lifted)
_SHIFT = 4  # cv2 draws at 1/16 pixel
_WIDE, _HIGH = 9.6, 8.0
"""Size of the picture [in]. From top to bottom: the title, the plan, the clock, the newest message, the legend."""
_TITLE_IN, _TITLE_PT, _TITLE_LINES = 9.3, 11.0, 3
"""Width of the title [in], size of its letters [pt], and its lines at most; a longer title has smaller letters."""
_LEFT_PX, _GAP_PX = 16, 8
"""Where lines of words begin, and free space around the plan [px]."""


def write_video(path: Path, spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> None:
    """Write a WebM video of the trial, with the displays of the people beside the plan.

    Raises:
        HthorError: if the OpenCV on this machine cannot write such a video to ``path``.
    """
    stage = _Stage(spec, log, house)
    displays = DisplayPictures(log)
    height, width = displays.beside(stage.empty, 0).shape[:2]
    count = max(len(way) for way in log.paths.values())
    frames: Iterator[Any] = (
        displays.beside(stage.draw(log, index), index * rules.LOG_EVERY_TICKS) for index in range(count)
    )
    webm_file.write_webm(path, frames, count, (width, height), frame_rate())


def frame_rate() -> float:
    """Frames per second of a video, one for every logged pose."""
    return SPEED / (rules.TICK_S * rules.LOG_EVERY_TICKS)


class _Stage:
    """The empty house as pixels, and the pixel position of each point of the house."""

    @lettering.plain_lettering()
    def __init__(self, spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> None:
        sheet = Figure(figsize=(_WIDE, _HIGH), dpi=frame_words.DPI)
        canvas = FigureCanvasAgg(sheet)
        words = trial_figure.headline(spec, log, _TITLE_IN, _TITLE_PT)
        size = _TITLE_PT * min(1.0, _TITLE_LINES / (words.count("\n") + 1))
        title = sheet.text(0.015, 0.985, words, fontsize=size, color=trial_trace.INK, va="top")
        handles = trial_legend.legend_entries(spec, log, house, moving=True)
        legend = text_fit.legend(sheet, handles, 6, size=8.0, loc="lower left", columnspacing=1.2)
        canvas.draw()  # only now the extent of words is known
        above, below = title.get_window_extent().y0, legend.get_window_extent().y1
        self.message_y = round(_HIGH * frame_words.DPI - below - _GAP_PX)
        self.clock_y = self.message_y - frame_words.LINE_PX
        low = below + 2 * frame_words.LINE_PX + 2 * _GAP_PX
        ax = sheet.add_axes(_share(Bbox.from_extents(_GAP_PX, low, _WIDE * frame_words.DPI - _GAP_PX, above - _GAP_PX)))
        floor_plan.draw_house(ax, house, marked=trial_trace.destinations(spec, house))
        canvas.draw()
        self.empty: Any = cv2.cvtColor(np.asarray(canvas.buffer_rgba()), cv2.COLOR_RGBA2BGR)
        self._to_pixels = ax.transData
        self.targets = {job.target: start.position[:2] for job, start in trial_trace.targets(spec, house)}
        began = task_began(log)
        self.began = log.ticks + 1 if began is None else began

    def draw(self, log: EpisodeLog, index: int) -> Any:
        """The frame of logged pose number ``index``."""
        frame = self.empty.copy()
        tick = index * rules.LOG_EVERY_TICKS
        acts = [event for event in log.events if isinstance(event, _TAKEN) and self.began <= event.tick <= tick]
        taken = {event.object for event in acts}
        for object_, place in self.targets.items():
            if object_ not in taken and tick >= self.began:
                cv2.drawMarker(frame, self._pixel(place), bgr(trial_trace.TARGET), cv2.MARKER_STAR, 18, 2, cv2.LINE_AA)
        for seat in log.paths:
            self._draw_seat(frame, log, index, seat)
        self._draw_message(frame, log, tick)
        x = _LEFT_PX
        for text, shade in captions.status(log, tick):
            x += frame_words.write_words(frame, text, (x, self.clock_y), shade) + _LEFT_PX
        return frame

    def _draw_seat(self, frame: Any, log: EpisodeLog, index: int, seat: str) -> None:
        """Draw a seat's path so far and its viewing direction; a robot whose agent failed is a cross."""
        fault = trial_trace.first_fault(log, seat)
        failed = fault is not None and fault.tick <= index * rules.LOG_EVERY_TICKS
        last = min(index, fault.tick // rules.LOG_EVERY_TICKS) if fault is not None else index
        way = trial_trace.points(log, seat)[: last + 1]
        shade = bgr(trial_trace.seat_colour(seat))
        pixels = self._pixels(way)
        cv2.polylines(frame, [np.round(pixels * (1 << _SHIFT)).astype(np.int32)], False, shade, 2, cv2.LINE_AA, _SHIFT)
        x, y = (round(part) for part in pixels[-1])
        if failed:
            cv2.circle(frame, (x, y), 9, bgr(trial_trace.GONE), -1, cv2.LINE_AA)
            cv2.drawMarker(frame, (x, y), bgr(trial_trace.FAILED), cv2.MARKER_TILTED_CROSS, 20, 4, cv2.LINE_AA)
            return
        cv2.circle(frame, (x, y), 9, shade, -1, cv2.LINE_AA)
        yaw = log.paths[seat][len(way) - 1][2] / 1000
        nose = (round(x + 16 * np.cos(yaw)), round(y - 16 * np.sin(yaw)))
        cv2.line(frame, (x, y), nose, shade, 3, cv2.LINE_AA)

    def _draw_message(self, frame: Any, log: EpisodeLog, tick: int) -> None:
        """Write the newest message; it stays for some seconds."""
        message = captions.newest_message(log, tick)
        if message is None:
            return
        words = captions.message_words(message)
        frame_words.write_words(frame, words, (_LEFT_PX, self.message_y), trial_trace.MESSAGE)
        if message.position is not None:
            claim = self._pixel(message.position[:2])
            cv2.circle(frame, claim, 14, bgr(trial_trace.MESSAGE), 2, cv2.LINE_AA)

    def _pixels(self, way: np.ndarray) -> np.ndarray:
        flat = self._to_pixels.transform(way)
        return np.stack([flat[:, 0], self.empty.shape[0] - flat[:, 1]], axis=1)

    def _pixel(self, point: Any) -> tuple[int, int]:
        x, y = self._pixels(np.array([point], dtype=float))[0]
        return (round(x), round(y))


def _share(pixels: Bbox) -> tuple[float, float, float, float]:
    """Left, bottom, width and height of a part of the picture, as shares of the picture."""
    wide, high = _WIDE * frame_words.DPI, _HIGH * frame_words.DPI
    return (pixels.x0 / wide, pixels.y0 / high, pixels.width / wide, pixels.height / high)
