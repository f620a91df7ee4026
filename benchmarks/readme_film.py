"""The film of the README: one trial in eight seconds, with the house from above, the person's eyes and their display.

The trial is played once with cameras. Time runs faster than in the house, and slower while a message is read; the clock
at the top says the trial's time and how much faster it runs. The ray renderer draws everything, so the film needs no
OpenGL, and the same trial gives the same bytes with the same version of the encoder.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from PIL import Image

from hthor import houses, rules
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import session_runner
from hthor.report.drawing import floor_plan, text_fit, trial_trace
from hthor.report.drawing.film import frame_words
from hthor.report.drawing.film.frame_words import bgr
from hthor.report.drawing.overviews import framing
from hthor.report.drawing.person_display.display_pictures import DisplayPictures
from hthor.report.page.camera_frames import CameraFrames
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session
from hthor.types import HUMAN, Vec3, is_person
from hthor.types.events import Accepted, Event, Opened, Picked, Placed, Sent
from hthor.world.rendering.viewpoint import Viewpoint

LENGTH_S, FRAME_S = 8.0, 0.05
"""Length of the film and of one frame [s]."""
SIZE = (800, 478)
"""Width and height of the film [pixels]."""
_QUALITY = 80
_SHOWS = (Sent, Accepted, Picked, Opened, Placed)
_READ_S, _CALM_S, _HOLD_S = 1.1, 0.5, 1.1
"""Seconds of the film for a message to be read, after any other event, and at the end."""
_READ_OF_S, _CALM_OF_S = 1.4, 1.0
"""Seconds of the trial that pass meanwhile."""
_HEAD_PX, _FOOT_PX, _EDGE_PX, _GAP_PX = 46, 34, 12, 8
_SIDE_PX, _EYES_PX = 280, 207
"""Width of the column with the person's eyes and display, and height of the eyes' view [pixels]."""
_SAID_PX, _LINE_PX = 66, 27
"""Height of the words below the house, and distance of their lines [pixels]."""
_BESIDE_PX, _ABOVE_PX = 12, 34
"""How far from a body its name is, and how far above a thing the upper edge of its name [pixels]."""
_FINER, _SHIFT = 2, 4
_BIG_PT, _SMALL_PT = 14.0, 10.0
_CAPITAL, _LABEL_PX = 0.73, 23
"""Height of a capital letter, in parts of the letters' size, and of a name's field [pixels]."""
_AZIMUTH = -math.pi / 2
_PAPER, _FAINT, _LINE = "#ffffff", "#7d838c", "#d5d8dd"
ROBOT = "robot"
"""The seat of the only robot."""


class _Cameras(CameraFrames):
    """A world that keeps, at some ticks, what person and robot see, and the house from above as it is then."""

    def __init__(self, world: Any, ticks: Sequence[int], viewpoint: Viewpoint, size: tuple[int, int]) -> None:
        super().__init__(world, ticks, "fast", (HUMAN, ROBOT))
        self._above = functools.partial(world.overview, viewpoint, "rgb", (_FINER * size[0], _FINER * size[1]), "fast")
        self._at = frozenset(ticks)
        self.above: dict[int, Any] = {}

    def advance(self) -> tuple[Event, ...]:
        events = super().advance()
        if self._world.tick in self._at:
            self.above[self._world.tick] = _smaller(self._above(), _FINER)
        return events

    def reset(self, task: Any, seed: int = 0) -> None:
        super().reset(task, seed=seed)
        self.above[0] = _smaller(self._above(), _FINER)


def write_film(path: Path, session: Session) -> None:
    """Write the film of the last trial of a session as an animated WebP that begins anew for ever."""
    write_frames(path, Film(session).frames())


def write_frames(path: Path, shown: Sequence[Any]) -> None:
    """Write frames of `FRAME_S` each, (H, W, 3) uint8 in the order of colours of OpenCV, as an animated WebP."""
    frames, lasts = _joined(shown)
    first, *others = (Image.fromarray(cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)) for frame in frames)
    first.save(
        path,
        save_all=True,
        append_images=others,
        duration=lasts,
        loop=0,
        quality=_QUALITY,
        method=6,
        minimize_size=True,
    )


def _joined(frames: Sequence[Any]) -> tuple[list[Any], list[int]]:
    """The frames without those that equal the one before, and how long each is shown [ms]."""
    kept: list[Any] = []
    lasts: list[int] = []
    for frame in frames:
        if kept and np.array_equal(kept[-1], frame):
            lasts[-1] += round(1000 * FRAME_S)
        else:
            kept.append(frame)
            lasts.append(round(1000 * FRAME_S))
    return kept, lasts


def shown_ticks(record: TrialRecord) -> list[int]:
    """The tick of each frame: slow after a message, a little slow after other events, evenly fast between them."""
    whole, some = record.ticks * rules.TICK_S, _milestones(record)
    slow: list[tuple[float, float, float]] = []
    for event, (begin, after) in zip(some, pairwise([*(one.tick * rules.TICK_S for one in some), whole]), strict=True):
        lasts, of = (_READ_S, _READ_OF_S) if isinstance(event, Sent) else (_CALM_S, _CALM_OF_S)
        span = min(of, after - begin)
        slow.append((begin, begin + span, lasts * span / of))
    left = LENGTH_S - _HOLD_S - sum(lasts for _, _, lasts in slow)
    pace = left / (whole - sum(end - begin for begin, end, _ in slow))
    film, trial = [0.0], [0.0]
    for begin, end, lasts in slow:
        film += [film[-1] + (begin - trial[-1]) * pace]
        film += [film[-1] + lasts]
        trial += [begin, end]
    film += [film[-1] + (whole - trial[-1]) * pace]
    at = np.arange(round(LENGTH_S / FRAME_S)) * FRAME_S
    return [int(tick) for tick in np.round(np.interp(at, film, [*trial, whole]) / rules.TICK_S)]


def _milestones(record: TrialRecord) -> list[Event]:
    """The events that the film is about: messages, answers, and what is done with the target and its destination."""
    return [event for event in record.log.events if isinstance(event, _SHOWS)]


class Film:
    """The frames of a trial, which is played for them."""

    def __init__(self, session: Session) -> None:
        trial = session.trials[-1]
        self.house = houses.load(trial.task.house)
        self.size = (SIZE[0] - _SIDE_PX - 2 * _EDGE_PX - _GAP_PX, SIZE[1] - _HEAD_PX - _FOOT_PX - _SAID_PX)
        self.viewpoint = framing.frame_house(self.house, _AZIMUTH, self.size)
        self.record = _play(session, lambda world: world)
        self.ticks = shown_ticks(self.record)
        cameras: list[_Cameras] = []

        def watched(world: Any) -> _Cameras:
            cameras.append(_Cameras(world, sorted(set(self.ticks)), self.viewpoint, self.size))
            return cameras[-1]

        _play(session, watched)
        (self.cameras,) = cameras
        self.log = self.record.log
        self.displays = DisplayPictures(self.log, self.cameras.images(trial_trace.messages(self.log)))

    def frames(self) -> list[Any]:
        """All frames, (H, W, 3) uint8 each, blue first."""
        speeds = [(after - tick) * rules.TICK_S / FRAME_S for tick, after in pairwise([*self.ticks, self.ticks[-1]])]
        return [self.draw(tick, speed) for tick, speed in zip(self.ticks, _even(speeds), strict=True)]

    def draw(self, tick: int, speed: float) -> Any:
        """One frame."""
        frame = np.full((SIZE[1], SIZE[0], 3), 255, np.uint8)
        self._draw_head(frame, tick, speed)
        high, wide = self.size[1], self.size[0]
        frame[_HEAD_PX : _HEAD_PX + high, _EDGE_PX : _EDGE_PX + wide] = self._from_above(tick)
        self._draw_said(frame, tick)
        self._draw_side(frame, tick)
        self._draw_foot(frame, tick)
        return frame

    def _draw_head(self, frame: Any, tick: int, speed: float) -> None:
        _write(frame, f"“{self.record.spec.task.instruction}”", (_EDGE_PX, _HEAD_PX // 2), _BIG_PT, trial_trace.INK)
        right = SIZE[0] - _EDGE_PX
        _write(frame, f"{tick * rules.TICK_S:.1f} s", (right, _HEAD_PX // 2), _BIG_PT, trial_trace.INK, side="right")
        if speed:
            _write(
                frame, f"speed {max(1.0, speed):.0f} ×", (right - 84, _HEAD_PX // 2), _SMALL_PT, _FAINT, side="right"
            )

    def _from_above(self, tick: int) -> Any:
        """The house with paths, names and the newest message."""
        picture = cv2.cvtColor(self.cameras.above[tick], cv2.COLOR_RGB2BGR)
        taken = any(isinstance(event, Picked) and event.tick <= tick for event in self.log.events)
        for seat in self.log.paths:
            self._draw_path(picture, seat, tick)
        for job, start in trial_trace.targets(self.record.spec, self.house):
            for thing in self.house.things:
                if {thing.id, thing.kind} & set(job.destinations):
                    x, y, z = thing.centre
                    self._name_thing(picture, (x, y, z + thing.size[2] / 2), floor_plan.title(thing.kind))
            if not taken:
                self._mark(picture, start.position)
                self._name_thing(picture, start.position, floor_plan.title(start.kind))
        for message in trial_trace.messages(self.log):
            if message.position is not None and self._is_news(message, tick):
                self._draw_claim(picture, message)
        for seat in self.log.paths:
            self._name_body(picture, seat, tick)
        return picture

    def _is_news(self, message: Sent, tick: int) -> bool:
        """Whether a message was sent and nothing happened since its answer that the film is about."""
        later = [
            one.tick for one in _milestones(self.record) if one.tick > message.tick and not isinstance(one, Accepted)
        ]
        return message.tick <= tick < min(later, default=self.record.ticks)

    def _draw_path(self, picture: Any, seat: str, tick: int) -> None:
        way = trial_trace.points(self.log, seat)[: tick // rules.LOG_EVERY_TICKS + 1]
        pixels = self._pixels([(x, y, 0.03) for x, y in way.tolist()])
        line = [np.round(pixels * (1 << _SHIFT)).astype(np.int32)]
        for shade, thick in ((_PAPER, 5), (trial_trace.seat_colour(seat), 3)):
            cv2.polylines(picture, line, False, bgr(shade), thick, cv2.LINE_AA, _SHIFT)

    def _name_body(self, picture: Any, seat: str, tick: int) -> None:
        x, y = trial_trace.position_at(self.log, seat, tick)
        column, row = self._pixel((x, y, 0.0))
        name, shade = trial_trace.seat_name(seat, self.log.paths), trial_trace.seat_colour(seat)
        side, step = ("left", _BESIDE_PX) if is_person(seat) else ("right", -_BESIDE_PX)
        _label(picture, name, (column + step, row - 4), shade, side=side)

    def _mark(self, picture: Any, place: Vec3) -> None:
        at = self._pixel(place)
        for shade, thick, size in ((_PAPER, 4, 15), (trial_trace.TARGET, 2, 13)):
            cv2.drawMarker(picture, at, bgr(shade), cv2.MARKER_STAR, size, thick, cv2.LINE_AA)

    def _name_thing(self, picture: Any, place: Vec3, name: str) -> None:
        x, y = self._pixel(place)
        _label(picture, name, (x, y - _ABOVE_PX), trial_trace.TARGET)

    def _draw_claim(self, picture: Any, message: Sent) -> None:
        """Draw a line from where the robot was to the place of its message."""
        assert message.position is not None
        x, y = trial_trace.position_at(self.log, message.seat, message.tick)
        begin, end = self._pixels([(x, y, 0.6), message.position])
        shade = bgr(trial_trace.MESSAGE)
        points = [np.round(begin + (end - begin) * part).astype(int) for part in np.linspace(0.0, 1.0, 9)]
        for one, other in list(pairwise(points))[::2]:
            cv2.line(picture, tuple(map(int, one)), tuple(map(int, other)), shade, 3, cv2.LINE_AA)
        cv2.circle(picture, self._pixel(message.position), 13, shade, 3, cv2.LINE_AA)

    def _pixels(self, points: Sequence[Vec3]) -> Any:
        """(N, 2) columns and rows of points of the house."""
        return self.viewpoint.project(np.array(points, float), self.size)[:, :2]

    def _pixel(self, point: Vec3) -> tuple[int, int]:
        column, row = self._pixels([point])[0].tolist()
        return (round(column), round(row))

    def _draw_said(self, frame: Any, tick: int) -> None:
        """Write what happened last below the house."""
        words, shade = self._said(tick)
        room = self.size[0] / frame_words.DPI
        top = _HEAD_PX + self.size[1] + _GAP_PX
        lines = text_fit.wrap(words, room, _BIG_PT, bold=True)[:2]
        for number, line in enumerate(lines):
            _write(frame, line, (_EDGE_PX, top + _LINE_PX // 2 + number * _LINE_PX), _BIG_PT, shade)

    def _said(self, tick: int) -> tuple[str, str]:
        """The last milestone in words, with its colour."""
        if tick >= self.record.ticks:
            end = trial_trace.end_word(self.log)
            words = f"{end} in {tick * rules.TICK_S:.1f} s" if self.log.met else end
            return words, trial_trace.TARGET if self.log.met else trial_trace.FAILED
        past = [event for event in _milestones(self.record) if event.tick <= tick]
        if not past:
            return "A person and a robot set out.", trial_trace.INK
        event = past[-1]
        if isinstance(event, Sent):
            return f"{event.seat}: “{event.text}”", trial_trace.MESSAGE
        who = trial_trace.seat_name(event.seat, self.log.paths)
        if isinstance(event, Accepted):
            return f"{who} accepts", trial_trace.seat_colour(event.seat)
        what = getattr(event, "object", "") or getattr(event, "thing", "")
        return f"{who} {trial_trace.ACTS[event.kind][1]} {what}".strip(), trial_trace.seat_colour(event.seat)

    def _draw_side(self, frame: Any, tick: int) -> None:
        """Draw what the person sees; below it their display, or, while it is empty, what the robot sees."""
        left, top = SIZE[0] - _EDGE_PX - _SIDE_PX, _HEAD_PX
        self._draw_view(frame, (left, top, _SIDE_PX, _EYES_PX), HUMAN, tick)
        top += _EYES_PX + _GAP_PX
        high = SIZE[1] - _FOOT_PX - top
        part = self.displays.panel(HUMAN, tick, _SIDE_PX, high)
        shown = self.displays.map(HUMAN, tick, high) if part is None else None
        if shown is not None:
            at = (_SIDE_PX - high) // 2
            part = np.full((high, _SIDE_PX, 3), shown[2, 2], np.uint8)
            part[:, at : at + high] = shown
        if part is None:
            self._draw_view(frame, (left, top, _SIDE_PX, high), ROBOT, tick)
            return
        frame[top : top + high, left : left + _SIDE_PX] = part[:, :, ::-1]
        _frame(frame, (left, top, _SIDE_PX, high), trial_trace.MESSAGE)

    def _draw_view(self, frame: Any, box: tuple[int, int, int, int], seat: str, tick: int) -> None:
        """Draw what somebody sees, cut above and below to the shape of the box."""
        left, top, wide, high = box
        view, shade = self.cameras.draw(tick, seat), trial_trace.seat_colour(seat)
        view = cv2.resize(view, (wide, round(len(view) * wide / view.shape[1])), interpolation=cv2.INTER_AREA)
        spare = (len(view) - high) // 2
        frame[top : top + high, left : left + wide] = view[spare : spare + high, :, ::-1]
        _frame(frame, box, shade)
        _label(frame, f"what the {trial_trace.seat_name(seat, self.log.paths)} sees", (left, top), shade, side="left")

    def _draw_foot(self, frame: Any, tick: int) -> None:
        """Draw the trial's time as a line, with its milestones."""
        y, left, right = SIZE[1] - _FOOT_PX // 2 + 2, _EDGE_PX + 8, SIZE[0] - _EDGE_PX - 8

        def across(at: int) -> int:
            return left + round((right - left) * at / self.record.ticks)

        cv2.line(frame, (left, y), (right, y), bgr(_LINE), 4, cv2.LINE_AA)
        cv2.line(frame, (left, y), (across(tick), y), bgr(trial_trace.INK), 4, cv2.LINE_AA)
        for event in _milestones(self.record):
            shade = trial_trace.MESSAGE if isinstance(event, Sent) else trial_trace.seat_colour(event.seat)
            shade = shade if event.tick <= tick else "#b9bec6"
            cv2.circle(frame, (across(event.tick), y), 8, bgr(_PAPER), -1, cv2.LINE_AA)
            cv2.circle(frame, (across(event.tick), y), 6, bgr(shade), -1, cv2.LINE_AA)


def _play(session: Session, watch: Callable[[Any], Any]) -> TrialRecord:
    """Play a session; the world of its last trial is watched."""
    stage = TrialRunner()
    with stage.enter(session) as company:
        for trial in session.trials[:-1]:
            stage.run(company, trial)
        last = session.trials[-1]
        return session_runner.run_trial(stage, company, last, watch(stage.world(last))).record


def _even(speeds: Sequence[float]) -> list[float]:
    """Speeds without the steps that come of whole ticks."""
    return [float(np.mean(speeds[max(0, at - 2) : at + 3])) for at in range(len(speeds))]


def _smaller(picture: Any, times: int) -> Any:
    high, wide, _ = picture.shape
    return cv2.resize(picture, (wide // times, high // times), interpolation=cv2.INTER_AREA)


def _frame(frame: Any, box: tuple[int, int, int, int], shade: str) -> None:
    left, top, wide, high = box
    cv2.rectangle(frame, (left, top), (left + wide - 1, top + high - 1), bgr(shade), 2)


def _label(frame: Any, words: str, at: tuple[int, int], shade: str, side: str = "middle") -> None:
    """Write white words on a field of a colour, whose upper left end, middle or right end is at a place."""
    wide = frame_words.words_width(words, _SMALL_PT) + 10
    left = min(max(at[0] - {"left": 0, "middle": wide // 2, "right": wide}[side], 0), frame.shape[1] - wide)
    top = min(max(at[1], 0), frame.shape[0] - _LABEL_PX)
    cv2.rectangle(frame, (left, top), (left + wide - 1, top + _LABEL_PX - 1), bgr(shade), -1)
    _write(frame, words, (left + 5, top + _LABEL_PX // 2), _SMALL_PT, _PAPER)


def _write(frame: Any, words: str, at: tuple[int, int], size: float, shade: str, side: str = "left") -> None:
    """Write words whose left or right end is at a column; the middle of their capitals is at a row."""
    left = at[0] - {"left": 0, "right": frame_words.words_width(words, size)}[side]
    baseline = at[1] + round(_CAPITAL * size / 72.0 * frame_words.DPI / 2)
    frame_words.write_words(frame, words, (left, baseline), shade, size=size)
