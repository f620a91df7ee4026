"""Turns a path into motions of a body, and makes room for people."""

import math
from collections.abc import Callable, Sequence

from hthor.geometry.plane import turn, wrap
from hthor.types import BodySpec, Detection, Motion, Move, Observation, Pose, Rotate, Vec2, Vec3, Wait, is_person

TURN_RAD = math.radians(25.0)
"""[rad] Heading error above which a body turns before it moves."""
_ARRIVED_M = 0.04
NEAR_M = 0.9
"""[m] A person in front who is closer than this has the right of way."""
PATIENCE_S = 2.0
"""[s] How long a body stands aside before it goes on."""
_PAUSE_S = 0.5
_STEP_M = 0.5
_FRONT_RAD = math.radians(70.0)
_DIRECTIONS = 16


class Follower:
    """Walks a path one motion at a time: turns towards the next way point, then moves.

    Args:
        step: longest move [m]. turn_rad: heading error above which it turns first [rad].
        arrived_m: distance at which a way point counts as reached [m].
        sidestep_m: a way point nearer than this is reached sideways or backwards, without turning first [m].
    """

    def __init__(
        self, step: float = 0.5, turn_rad: float = TURN_RAD, arrived_m: float = _ARRIVED_M, sidestep_m: float = 0.0
    ) -> None:
        self.step, self.turn_rad, self.arrived_m, self.sidestep_m = step, turn_rad, arrived_m, sidestep_m
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
        """The way point [m] that the body is heading for."""
        return None if self.done else self.path[self._next]

    @property
    def rest(self) -> tuple[Vec2, ...]:
        """The way points [m] that are still to be reached."""
        return self.path[self._next :]

    def next(self, pose: Pose) -> Motion | None:
        """The next motion from ``pose``, or None when the whole path was walked."""
        while not self.done and math.dist(self.path[self._next], (pose.x, pose.y)) <= self.arrived_m:
            self._next += 1
        if self.done:
            return None
        point = self.path[self._next]
        near = math.dist(point, (pose.x, pose.y)) < self.sidestep_m
        return toward(pose, point, self.step, math.pi if near else self.turn_rad)


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

    The body turns by as much as the head, which keeps its angle to the body.

    Args:
        eye_height: height of the camera [m]. pitch_limit: largest pitch of the camera either way [rad].
    """
    dx, dy = point[0] - pose.x, point[1] - pose.y
    apart = math.hypot(dx, dy)
    yaw = wrap(math.atan2(dy, dx) - pose.gaze) if apart > 1e-6 else 0.0
    aim = math.atan2(point[2] - eye_height, max(apart, 1e-6))
    pitch = max(-pitch_limit, min(pitch_limit, aim)) - pose.pitch
    if abs(yaw) < math.radians(2.0) and abs(pitch) < math.radians(2.0):
        return None
    return Rotate(yaw=yaw, pitch=pitch)


class Courtesy:
    """Makes room when a person is in the way, for up to `PATIENCE_S` at a time, then lets the body go on.

    Args:
        fits: ``fits(a, b)`` says whether the body can go straight from ``a`` to ``b`` [m].
    """

    def __init__(self, body: BodySpec, fits: Callable[[Vec2, Vec2], bool]) -> None:
        self.body, self.fits = body, fits
        self._seen, self._stepped = False, False
        self._until = -1.0
        self._rest = -1.0

    def motion(self, observation: Observation, seconds: float) -> Motion | None:
        """A motion that makes room, or None if the body can go on.

        Args:
            observation: of this body; its detections are read.
            seconds: time since the trial began.
        """
        person = self._look(observation)
        bumped = observation.outcome is not None and is_person(observation.outcome.by)
        if seconds < self._until:
            if person is None and self._seen:
                self._until = -1.0
                return None
            self._seen = self._seen or person is not None
            return self._make_room(observation, person)
        if seconds < self._rest and not bumped:
            return None
        if not bumped and not self._in_front(observation, person):
            return None
        self._until, self._rest = seconds + PATIENCE_S, seconds + 2.0 * PATIENCE_S
        self._seen, self._stepped = person is not None, False
        return self._make_room(observation, person)

    def _make_room(self, observation: Observation, person: Vec2 | None) -> Motion:
        """A step away while the person is near or has not been seen yet; else a wait.

        In a passage it steps back ahead of a person who follows, until there is room to pass.
        """
        pose = observation.pose
        aside = self._aside((pose.x, pose.y), person) if person is not None or not self._stepped else None
        self._stepped = True
        return Wait(seconds=_PAUSE_S) if aside is None else shift(pose, aside, _STEP_M)

    def _look(self, observation: Observation) -> Vec2 | None:
        """Position [m] of the nearest person close by; None when nobody is near."""
        nearest, best = None, NEAR_M + self.body.radius
        for seen in observation.detections:
            if seen.family == "person" and _apart(observation, seen) < best:
                nearest, best = (seen.position[0], seen.position[1]), _apart(observation, seen)
        return nearest

    def _in_front(self, observation: Observation, person: Vec2 | None) -> bool:
        if person is None:
            return False
        pose = observation.pose
        return abs(wrap(math.atan2(person[1] - pose.y, person[0] - pose.x) - pose.yaw)) < _FRONT_RAD

    def _aside(self, here: Vec2, person: Vec2 | None) -> Vec2 | None:
        """The place, half a metre straight away, that leaves the person most room; None if the body can go to none."""
        best, most = None, 0.0 if person is None else math.dist(here, person) + 0.05
        for k in range(_DIRECTIONS):
            angle = 2.0 * math.pi * k / _DIRECTIONS
            spot = (here[0] + _STEP_M * math.cos(angle), here[1] + _STEP_M * math.sin(angle))
            if not self.fits(here, spot):
                continue
            room = self._room(here, angle) if person is None else math.dist(spot, person)
            if room > most + 1e-9:
                best, most = spot, room
        return best

    def _room(self, here: Vec2, angle: float) -> float:
        """How far [m] the body can go in the direction ``angle``, up to 1.5 m."""
        for k in (3, 2, 1):
            spot = (here[0] + 0.5 * k * math.cos(angle), here[1] + 0.5 * k * math.sin(angle))
            if self.fits(here, spot):
                return 0.5 * k
        return 0.0


def _apart(observation: Observation, seen: Detection) -> float:
    return math.hypot(seen.position[0] - observation.pose.x, seen.position[1] - observation.pose.y)
