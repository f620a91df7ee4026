"""Turns a path into motions of a body."""

import math
from collections.abc import Sequence

from hthor.geometry.plane import turn, wrap
from hthor.types import Motion, Move, Pose, Rotate, Vec2, Vec3

TURN_RAD = math.radians(25.0)
"""Heading error above which a body turns before it moves [rad]."""
_ARRIVED_M = 0.04


class Follower:
    """Walks a path one motion at a time: turns towards the next way point, then moves.

    Args:
        step: longest move [m]. turn_rad: heading error above which it turns first [rad].
        arrived_m: distance at which a way point counts as reached [m].
    """

    def __init__(self, step: float = 0.5, turn_rad: float = TURN_RAD, arrived_m: float = _ARRIVED_M) -> None:
        self.step, self.turn_rad, self.arrived_m = step, turn_rad, arrived_m
        self.path: tuple[Vec2, ...] = ()
        self._next = 0

    def take(self, path: Sequence[Vec2] | None) -> None:
        """Follow ``path`` [m] from its beginning; None or an empty path means to stay."""
        self.path, self._next = tuple(path or ()), 0

    @property
    def done(self) -> bool:
        """Whether every way point was reached."""
        return self._next >= len(self.path)

    @property
    def goal(self) -> Vec2 | None:
        """The last way point [m]."""
        return self.path[-1] if self.path else None

    @property
    def ahead(self) -> Vec2 | None:
        """The way point [m] that it is heading for."""
        return None if self.done else self.path[self._next]

    def next(self, pose: Pose) -> Motion | None:
        """The next motion from ``pose``, or None when the path is done."""
        while not self.done and math.dist(self.path[self._next], (pose.x, pose.y)) <= self.arrived_m:
            self._next += 1
        if self.done:
            return None
        return toward(pose, self.path[self._next], self.step, self.turn_rad)


def toward(pose: Pose, point: Vec2, step: float = 0.5, turn_rad: float = TURN_RAD) -> Motion:
    """Turn to ``point`` [m] if the heading error is above ``turn_rad``, else move there, at most ``step`` metres."""
    dx, dy = point[0] - pose.x, point[1] - pose.y
    apart = math.hypot(dx, dy)
    error = wrap(math.atan2(dy, dx) - pose.yaw) if apart > 1e-9 else 0.0
    if abs(error) > turn_rad:
        return Rotate(yaw=error)
    return shift(pose, point, step)


def shift(pose: Pose, point: Vec2, step: float = 0.5) -> Move:
    """Move straight to ``point`` [m] without turning, at most ``step`` metres."""
    dx, dy = point[0] - pose.x, point[1] - pose.y
    apart = math.hypot(dx, dy)
    share = min(1.0, step / apart) if apart > 0.0 else 0.0
    forward, left = turn((dx * share, dy * share), -pose.yaw)
    return Move(forward=forward, left=left)


def face(pose: Pose, point: Vec3, eye_height: float, pitch_limit: float = math.pi / 2.0) -> Rotate | None:
    """The turn that centres ``point`` [m] in the picture; None when it is centred within 2 degrees.

    Args:
        eye_height: height of the camera [m]. pitch_limit: largest pitch of the camera either way [rad].
    """
    dx, dy = point[0] - pose.x, point[1] - pose.y
    apart = math.hypot(dx, dy)
    yaw = wrap(math.atan2(dy, dx) - pose.yaw) if apart > 1e-6 else 0.0
    aim = math.atan2(point[2] - eye_height, max(apart, 1e-6))
    pitch = max(-pitch_limit, min(pitch_limit, aim)) - pose.pitch
    if abs(yaw) < math.radians(2.0) and abs(pitch) < math.radians(2.0):
        return None
    return Rotate(yaw=yaw, pitch=pitch)
