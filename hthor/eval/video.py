"""One trial as a film, seen from above, at several times real speed; simulates nothing."""

from __future__ import annotations

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
from hthor.eval import plan, trace
from hthor.types import HouseSpec, TrialSpec

SPEED = 4
"""Seconds of the trial in a second of film."""
HOLD_S = 2
"""Seconds that the last picture stays."""
_TAKEN = ("picked", "lifted")
_SHIFT = 4  # cv2 draws at 1/16 pixel


def write(path: Path, spec: TrialSpec, log: EpisodeLog, house: HouseSpec) -> None:
    """Write an MP4 of the trial.

    Raises:
        HthorError: when this machine's OpenCV cannot write MP4 files there.
    """
    stage = _Stage(spec, house)
    height, width = stage.empty.shape[:2]
    rate = SPEED / (rules.TICK_S * rules.LOG_EVERY_TICKS)
    film = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), rate, (width, height))
    if not film.isOpened():
        raise HthorError(f"{path}: cannot write a film there; is the folder writable, and does the name end in .mp4?")
    count = max(len(way) for way in log.paths.values())
    for index in tqdm(range(count), desc=path.name, unit="frame", disable=None, leave=False):
        frame = stage.draw(log, index)
        film.write(frame)
    for _ in range(round(HOLD_S * rate)):
        film.write(frame)
    film.release()


class _Stage:
    """The empty house as pixels, and where its metres fall on them."""

    def __init__(self, spec: TrialSpec, house: HouseSpec) -> None:
        sheet = Figure(figsize=(9.6, 7.2), dpi=100, layout="constrained")
        canvas = FigureCanvasAgg(sheet)
        ax = sheet.subplots()
        plan.draw_house(ax, house, marked=trace.destinations(spec, house))
        ax.set_title(f"“{spec.task.instruction}”", fontsize=13, color=trace.INK)
        canvas.draw()
        self.empty: Any = cv2.cvtColor(np.asarray(canvas.buffer_rgba()), cv2.COLOR_RGBA2BGR)
        self._to_pixels = ax.transData
        self.targets = {job.target: start.position[:2] for job, start in trace.targets(spec, house)}
        self.robots = spec.robots

    def draw(self, log: EpisodeLog, index: int) -> Any:
        """The frame of logged pose number ``index``."""
        frame = self.empty.copy()
        tick = index * rules.LOG_EVERY_TICKS
        taken = {event.data["object"] for event in log.events if event.kind in _TAKEN and event.tick <= tick}
        for object_, place in self.targets.items():
            if object_ not in taken:
                cv2.drawMarker(frame, self._pixel(place), _bgr(trace.TARGET), cv2.MARKER_STAR, 18, 2, cv2.LINE_AA)
        for seat, way in log.paths.items():
            self._draw_seat(frame, trace.points(log, seat)[: index + 1], way[min(index, len(way) - 1)][2], seat)
        self._draw_message(frame, log, tick)
        self._write(frame, f"{tick * rules.TICK_S:5.1f} s", (18, 34), trace.INK)
        if log.progress is not None:
            steps = [event.data["value"] for event in log.events if event.kind == "progress" and event.tick <= tick]
            self._write(frame, f"{100.0 * (steps or [0.0])[-1]:.0f} %", (18, 62), trace.TARGET)
        for row, robot in enumerate(self.robots if len(self.robots) > 1 else ()):
            self._write(frame, trace.who(robot), (18, 92 + 24 * row), trace.colour(robot.seat))
        return frame

    def _draw_seat(self, frame: Any, way: np.ndarray, yaw_mrad: int, seat: str) -> None:
        shade = _bgr(trace.colour(seat))
        pixels = self._pixels(way)
        cv2.polylines(frame, [np.round(pixels * (1 << _SHIFT)).astype(np.int32)], False, shade, 2, cv2.LINE_AA, _SHIFT)
        x, y = pixels[-1]
        cv2.circle(frame, (round(x), round(y)), 9, shade, -1, cv2.LINE_AA)
        nose = (round(x + 16 * np.cos(yaw_mrad / 1000)), round(y - 16 * np.sin(yaw_mrad / 1000)))
        cv2.line(frame, (round(x), round(y)), nose, shade, 3, cv2.LINE_AA)

    def _draw_message(self, frame: Any, log: EpisodeLog, tick: int) -> None:
        """The newest message stays for five seconds after it was sent or answered."""
        recent = [event for event in trace.messages(log) if 0 <= tick - event.tick <= 5.0 / rules.TICK_S]
        if recent:
            event = recent[-1]
            text = f"{event.seat}: {event.data['text']}"
            self._write(frame, text, (18, frame.shape[0] - 18), trace.MESSAGE)
            if event.data.get("position") is not None:
                claim = self._pixel(event.data["position"][:2])
                cv2.circle(frame, claim, 14, _bgr(trace.MESSAGE), 2, cv2.LINE_AA)
        answers = ("confirmed", "declined")
        for event in log.events:
            if event.kind in answers and 0 <= tick - event.tick <= 3.0 / rules.TICK_S:
                self._write(frame, f"person: {event.kind}", (frame.shape[1] - 230, 34), trace.PERSON)
        if log.events[-1].tick <= tick:
            self._write(frame, "done" if log.met else "time is up", (130, 34), trace.TARGET if log.met else "#b00020")

    def _pixels(self, way: np.ndarray) -> np.ndarray:
        flat = self._to_pixels.transform(way)
        return np.stack([flat[:, 0], self.empty.shape[0] - flat[:, 1]], axis=1)

    def _pixel(self, point: Any) -> tuple[int, int]:
        x, y = self._pixels(np.array([point], dtype=float))[0]
        return (round(x), round(y))

    @staticmethod
    def _write(frame: Any, text: str, corner: tuple[int, int], shade: str) -> None:
        plain = text.encode("ascii", "replace").decode()
        cv2.putText(frame, plain, corner, cv2.FONT_HERSHEY_SIMPLEX, 0.62, _bgr(shade), 2, cv2.LINE_AA)


def _bgr(shade: str) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in to_rgb(shade))
    return (blue, green, red)
