"""Draws what a person's display showed at a moment of a logged trial, below their view or beside a film."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
from matplotlib.colors import to_rgb

from hthor import rules
from hthor.comms import display, map_picture
from hthor.comms.display_contents import relative_map
from hthor.episode import EpisodeLog
from hthor.report.drawing import trial_trace
from hthor.report.drawing.person_display.panel_picture import draw_panel
from hthor.types import Pose, is_person
from hthor.types.events import Accepted, Answered, Declined

_BARE, _FAINT, _LINE = (243, 244, 246), (150, 154, 162), (205, 208, 214)
"""Colours of the place of a part that is hidden, of its name, and of the line around it."""
_GAP_PX = 6
_COLUMN_PX = 240
"""Width of a film's column for displays [px]."""


class DisplayPictures:
    """The displays of a trial's people, as they saw them.

    Args:
        log: the trial's.
        images: pictures of messages by their number, (H, W, 3) uint8; a panel without its picture shows the words.
    """

    def __init__(self, log: EpisodeLog, images: Mapping[int, Any] | None = None) -> None:
        self.log, self.images = log, images or {}
        self.people = tuple(seat for seat in log.paths if is_person(seat) and _is_used(log, seat))

    def panel(self, seat: str, tick: int, wide: int, high: int) -> Any:
        """The panel, (high, wide, 3) uint8; None while it was hidden."""
        state = display.state_at(self.log.events, seat, tick)
        if state.message is None or not state.on["panel"]:
            return None
        number = state.message.message
        return draw_panel(
            state.message, wide, high, self.images.get(number), answered=_is_answered(self.log, seat, number, tick)
        )

    def map(self, seat: str, tick: int, size: int) -> Any:
        """The map, (size, size, 3) uint8; None while it was hidden."""
        state = display.state_at(self.log.events, seat, tick)
        if not state.on["map"]:
            return None
        shown = relative_map(_pose(self.log, seat, tick), state.confirmed, lambda other: _pose(self.log, other, tick))
        colours = {body.seat: _rgb(trial_trace.seat_colour(body.seat)) for body in shown.bodies}
        return map_picture.draw_map(shown, size, colours, _rgb(trial_trace.seat_colour(seat)))

    def strip(self, seat: str, tick: int, wide: int, high: int) -> Any:
        """Panel and map side by side, (high, wide, 3) uint8; the place of a hidden part is bare."""
        sheet = np.full((high, wide, 3), 255, dtype=np.uint8)
        place = wide - high - _GAP_PX
        parts = (
            ("panel", self.panel(seat, tick, place, high), 0, place),
            ("map", self.map(seat, tick, high), wide - high, high),
        )
        for name, picture, left, across in parts:
            sheet[:, left : left + across] = _part(name, picture, across, high)
        return sheet

    def beside(self, frame: Any, tick: int) -> Any:
        """A film's frame (H, W, 3), in OpenCV's order of colours, with a column for the displays at its right.

        Nothing is added in a trial in which nobody's display showed anything.
        """
        if not self.people:
            return frame
        high, each = len(frame), len(frame) // len(self.people)
        column = np.full((high, _COLUMN_PX + 2 * _GAP_PX, 3), 255, dtype=np.uint8)
        for number, seat in enumerate(self.people):
            self._stack(column[number * each : (number + 1) * each], seat, tick)
        return np.hstack([frame, column[:, :, ::-1]])

    def _stack(self, column: Any, seat: str, tick: int) -> None:
        """Draw one person's panel above their map, in the middle of a column."""
        side = min(_COLUMN_PX, (len(column) - 3 * _GAP_PX) // 2)
        top, left = (len(column) - 2 * side - _GAP_PX) // 2, _GAP_PX
        parts = (
            ("panel", self.panel(seat, tick, _COLUMN_PX, side), _COLUMN_PX),
            ("map", self.map(seat, tick, side), side),
        )
        for name, picture, across in parts:
            column[top : top + side, left : left + across] = _part(name, picture, across, side)
            top += side + _GAP_PX


def _is_used(log: EpisodeLog, seat: str) -> bool:
    """Whether the person's display showed anything in the trial."""
    return any(display.shown_spans(log.events, seat, log.ticks).values())


def _is_answered(log: EpisodeLog, seat: str, number: int, tick: int) -> bool:
    answers = (event for event in log.events if isinstance(event, (Accepted, Declined, Answered)))
    return any(event.seat == seat and event.message == number and event.tick <= tick for event in answers)


def _pose(log: EpisodeLog, seat: str, tick: int) -> Pose:
    """The seat's pose at a tick, taken from the nearest logged pose; its yaw is that of the head."""
    x, y = trial_trace.position_at(log, seat, tick)
    path = log.paths[seat]
    return Pose(x=x, y=y, yaw=path[min(tick // rules.LOG_EVERY_TICKS, len(path) - 1)][2] / 1000.0)


def _part(name: str, picture: Any, wide: int, high: int) -> Any:
    """A part of the display with a thin line around it; where it is hidden, its name on a bare field."""
    if picture is None:
        part = np.full((high, wide, 3), _BARE, dtype=np.uint8)
        cv2.putText(part, f"no {name}", (8, 20), cv2.FONT_HERSHEY_SIMPLEX, 0.45, _FAINT, 1, cv2.LINE_AA)
    else:
        part = picture.copy()
    part[[0, -1]] = part[:, [0, -1]] = _LINE
    return part


def _rgb(shade: str) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in to_rgb(shade))
    return red, green, blue
