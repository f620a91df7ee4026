"""Draws one trial as a video from above, at several times real speed.

Videos are VP8 in WebM, which browsers play and OpenCV's own FFmpeg writes. The same trial gives the same bytes.
"""

import contextlib
import os
import sys
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from tqdm import tqdm

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.errors import HthorError
from hthor.report.drawing import floor_plan, lettering, text_fit, trial_figure, trial_legend, trial_trace
from hthor.types import HouseSpec, TrialSpec
from hthor.types.events import Accepted, Answered, Declined, Lifted, Picked, Progress

SPEED = 4
"""Seconds of the trial per second of the video."""
HOLD_S = 2
"""How long the last picture stays [s]."""
_TAKEN = (Picked, Lifted)
_SHIFT = 4  # cv2 draws at 1/16 pixel
_WIDE, _HIGH, _DPI = 9.6, 8.0, 100
_PLAN = (0.01, 0.165, 0.98, 0.755)
"""The plan's place in the picture; the title is above it; the clock, the messages and the legend are below it."""
_TITLE_IN, _TITLE_PT, _TITLE_LINES = 9.3, 11.0, 3
"""Width of the title [in], size of its letters [pt], and its lines at most; a longer title has smaller letters."""
_CLOCK_Y, _MESSAGE_Y = 676, 706
"""Distances of the clock's line and of the newest message's line from the top [px]."""
_WORDS_MAX = 110
_TRACK_UID, _TAG_UID, _FIXED_UID = b"\x73\xc5\x88", b"\x63\xc5\x88", bytes(range(1, 9))


def write_video(path: Path, spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> None:
    """Write a WebM video of the trial.

    Raises:
        HthorError: if the OpenCV on this machine cannot write such a video to ``path``.
    """
    stage = _Stage(spec, log, house)
    height, width = stage.empty.shape[:2]
    rate = SPEED / (rules.TICK_S * rules.LOG_EVERY_TICKS)
    with _hushed():
        film = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*"VP80"), rate, (width, height))
    if not film.isOpened():
        raise HthorError(f"{path}: cannot write a film there; is the folder writable, and does the name end in .webm?")
    count = max(len(way) for way in log.paths.values())
    for index in tqdm(range(count), desc=path.name, unit="frame", disable=None, leave=False):
        frame = stage.draw(log, index)
        film.write(frame)
    for _ in range(round(HOLD_S * rate)):
        film.write(frame)
    film.release()
    _steady(path)


@contextlib.contextmanager
def _hushed() -> Iterator[None]:
    """Suppress FFmpeg's text on standard error: FFmpeg reports every codec name in WebM as a mistake."""
    sys.stderr.flush()
    kept = os.dup(2)
    try:
        with open(os.devnull, "wb") as null:
            os.dup2(null.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _steady(path: Path) -> None:
    """Replace the random number that FFmpeg gives to a video's track, in the track's header and in references to it."""
    data = path.read_bytes()
    at = data.find(_TRACK_UID)
    if at < 0:
        return
    drawn = data[at + len(_TRACK_UID) :][: len(_FIXED_UID)]
    for name in (_TRACK_UID, _TAG_UID):
        data = data.replace(name + drawn, name + _FIXED_UID, 1)
    path.write_bytes(data)


class _Stage:
    """The empty house as pixels, and the pixel position of each point of the house."""

    @lettering.plain_lettering()
    def __init__(self, spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> None:
        sheet = Figure(figsize=(_WIDE, _HIGH), dpi=_DPI)
        canvas = FigureCanvasAgg(sheet)
        ax = sheet.add_axes(_PLAN)
        floor_plan.draw_house(ax, house, marked=trial_trace.destinations(spec, house))
        words = trial_figure.headline(spec, log, _TITLE_IN, _TITLE_PT)
        size = _TITLE_PT * min(1.0, _TITLE_LINES / (words.count("\n") + 1))
        sheet.text(0.015, 0.985, words, fontsize=size, color=trial_trace.INK, va="top")
        handles = trial_legend.legend_entries(spec, log, house, moving=True)
        text_fit.legend(sheet, handles, 6, size=8.0, loc="lower left", columnspacing=1.2)
        canvas.draw()
        self.empty: Any = cv2.cvtColor(np.asarray(canvas.buffer_rgba()), cv2.COLOR_RGBA2BGR)
        self._to_pixels = ax.transData
        self.targets = {job.target: start.position[:2] for job, start in trial_trace.targets(spec, house)}

    def draw(self, log: EpisodeLog, index: int) -> Any:
        """The frame of logged pose number ``index``."""
        frame = self.empty.copy()
        tick = index * rules.LOG_EVERY_TICKS
        taken = {event.object for event in log.events if isinstance(event, _TAKEN) and event.tick <= tick}
        for object_, place in self.targets.items():
            if object_ not in taken:
                cv2.drawMarker(frame, self._pixel(place), _bgr(trial_trace.TARGET), cv2.MARKER_STAR, 18, 2, cv2.LINE_AA)
        for seat in log.paths:
            self._draw_seat(frame, log, index, seat)
        self._draw_message(frame, log, tick)
        said = [(f"{tick * rules.TICK_S:5.1f} s", trial_trace.INK)]
        if log.progress is not None:
            steps = [event.value for event in log.events if isinstance(event, Progress) and event.tick <= tick]
            said.append((f"{100.0 * (steps or [0.0])[-1]:.0f} %", trial_trace.TARGET))
        if log.ticks <= tick:
            said.append((trial_trace.end_word(log), trial_trace.TARGET if log.met else trial_trace.FAILED))
        for event in log.events:
            if isinstance(event, (Accepted, Declined, Answered)) and 0 <= tick - event.tick <= 3.0 / rules.TICK_S:
                name = trial_trace.seat_name(event.seat, log.paths)
                said.append((f"{name}: {event.kind}", trial_trace.seat_colour(event.seat)))
        for fault in log.faults:
            if fault.tick <= tick:
                said.append(
                    (f"{fault.seat} failed at {fault.tick * rules.TICK_S:.1f} s: {fault.kind}", trial_trace.FAILED)
                )
        x = 16
        for text, shade in said:
            x += _write(frame, text, (x, _CLOCK_Y), shade) + 18
        return frame

    def _draw_seat(self, frame: Any, log: EpisodeLog, index: int, seat: str) -> None:
        """Draw a seat's path so far and its viewing direction; a robot whose agent failed is a cross."""
        fault = trial_trace.first_fault(log, seat)
        failed = fault is not None and fault.tick <= index * rules.LOG_EVERY_TICKS
        last = min(index, fault.tick // rules.LOG_EVERY_TICKS) if fault is not None else index
        way = trial_trace.points(log, seat)[: last + 1]
        shade = _bgr(trial_trace.seat_colour(seat))
        pixels = self._pixels(way)
        cv2.polylines(frame, [np.round(pixels * (1 << _SHIFT)).astype(np.int32)], False, shade, 2, cv2.LINE_AA, _SHIFT)
        x, y = (round(part) for part in pixels[-1])
        if failed:
            cv2.circle(frame, (x, y), 9, _bgr(trial_trace.GONE), -1, cv2.LINE_AA)
            cv2.drawMarker(frame, (x, y), _bgr(trial_trace.FAILED), cv2.MARKER_TILTED_CROSS, 20, 4, cv2.LINE_AA)
            return
        cv2.circle(frame, (x, y), 9, shade, -1, cv2.LINE_AA)
        yaw = log.paths[seat][len(way) - 1][2] / 1000
        nose = (round(x + 16 * np.cos(yaw)), round(y - 16 * np.sin(yaw)))
        cv2.line(frame, (x, y), nose, shade, 3, cv2.LINE_AA)

    def _draw_message(self, frame: Any, log: EpisodeLog, tick: int) -> None:
        """Write the newest message; it stays for five seconds."""
        recent = [sent for sent in trial_trace.messages(log) if 0 <= tick - sent.tick <= 5.0 / rules.TICK_S]
        if not recent:
            return
        message = recent[-1]
        text = f"{message.seat}: “{message.text}”"
        _write(
            frame,
            text if len(text) <= _WORDS_MAX else f"{text[: _WORDS_MAX - 1]}…",
            (16, _MESSAGE_Y),
            trial_trace.MESSAGE,
        )
        if message.position is not None:
            claim = self._pixel(message.position[:2])
            cv2.circle(frame, claim, 14, _bgr(trial_trace.MESSAGE), 2, cv2.LINE_AA)

    def _pixels(self, way: np.ndarray) -> np.ndarray:
        flat = self._to_pixels.transform(way)
        return np.stack([flat[:, 0], self.empty.shape[0] - flat[:, 1]], axis=1)

    def _pixel(self, point: Any) -> tuple[int, int]:
        x, y = self._pixels(np.array([point], dtype=float))[0]
        return (round(x), round(y))


def _write(frame: Any, text: str, corner: tuple[int, int], shade: str) -> int:
    """Write words with their lower left corner at ``corner``; return their width [px]."""
    inked, shift = _lettered(text, shade)
    high, wide = inked.shape[:2]
    x, y = corner[0], corner[1] - high + shift
    part = frame[y : y + high, x : x + wide]
    cover = inked[: part.shape[0], : part.shape[1]]
    alpha = cover[:, :, 3:].astype(np.float32) / 255.0
    part[:] = np.round(part * (1.0 - alpha) + cover[:, :, 2::-1] * alpha).astype(np.uint8)
    return int(wide)


@lru_cache(maxsize=256)
def _lettered(text: str, shade: str) -> tuple[Any, int]:
    """Words as RGBA pixels in the font of all pictures, and how far they reach below their baseline [px]."""
    with lettering.plain_lettering():
        sheet = Figure(figsize=(_WIDE, 0.3), dpi=_DPI, facecolor="none")
        canvas = FigureCanvasAgg(sheet)
        drawn = sheet.text(0.0, 0.3, text, fontsize=10, color=shade, weight="bold")
        canvas.draw()
        wide = min(round(drawn.get_window_extent().x1) + 2, round(_WIDE * _DPI))
        return np.asarray(canvas.buffer_rgba()).copy()[:, :wide], round(0.3 * 0.3 * _DPI)


def _bgr(shade: str) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in to_rgb(shade))
    return (blue, green, red)
