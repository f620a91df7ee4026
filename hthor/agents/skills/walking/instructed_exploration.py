"""Exploration that goes first where an instruction points."""

import math

from hthor.agents.skills.explorer import Explorer
from hthor.errors import HthorError
from hthor.geometry.plane import turn, wrap
from hthor.navigation import directions
from hthor.navigation.directions import BEARINGS, Direction, off_side
from hthor.types import BodySpec, Detection, Observation, Pose, Vec2

_AHEAD_M = 3.0
"""How far away [m] a passage is assumed that was not seen yet. Our choice: half a room."""
_BEYOND_M = 0.8
"""How far [m] behind a doorway the robot aims. Our choice."""
_OFF_RAD = math.radians(60.0)
"""By how much [rad] a doorway may be off the side that the instruction names. Our choice."""
_PULL = 2.0
"""Cost of a metre between a place to explore and the aim, in metres of walking. Our choice."""
_NEAR_DOOR_M = 1.0


class InstructedExplorer(Explorer):
    """An explorer that reads an instruction step by step; a step through a passage is done when the room changes.

    The rooms' kinds and the landmarks on the way are not checked: a robot that got lost explores on.
    """

    def __init__(self, body: BodySpec, instruction: str) -> None:
        super().__init__(body)
        self.steps = [step for step in _read(instruction) if step.act in ("door", "opening")]
        self.aim: Vec2 | None = None
        self._doors: dict[str, Detection] = {}
        self._room = ""
        self._entry: Pose | None = None
        self._came = ""

    def see(self, observation: Observation) -> None:
        """Bring the map and the place in the instruction up to date; call at every act."""
        super().see(observation)
        for seen in observation.detections:
            if seen.family == "doorway":
                self._doors[seen.id] = seen
        if observation.room != self._room:
            self._enter(observation)
        aim = self._next_aim()
        if aim != self.aim:
            self.aim = aim
            self.drop()

    def extra_cost(self, pose: Pose, centre: Vec2) -> float:
        """Besides turning, the distance to the aim."""
        pull = 0.0 if self.aim is None else _PULL * math.dist(centre, self.aim)
        return super().extra_cost(pose, centre) + pull

    def _enter(self, observation: Observation) -> None:
        """A new room: the step is done, and sides are relative to how the robot came in."""
        pose = observation.pose
        if self._room:
            self.steps = self.steps[1:]
        self._room, self._entry, self._came = observation.room, pose, ""
        door = min(self._doors.values(), key=lambda one: (math.dist(one.position[:2], _at(pose)), one.id), default=None)
        if door is not None and math.dist(door.position[:2], _at(pose)) <= _NEAR_DOOR_M:
            self._came = door.id
            x, y = _across(door, pose.yaw)
            self._entry = Pose(x=door.position[0], y=door.position[1], yaw=math.atan2(y, x))

    def _next_aim(self) -> Vec2 | None:
        """Where the present step leads [m], None when all are done."""
        if not self.steps or self._entry is None:
            return None
        step, entry = self.steps[0], self._entry
        doors = [door for door in self._doors.values() if door.id != self._came and self._off(step, door) <= _OFF_RAD]
        best = min(doors, key=lambda door: (self._off(step, door), door.id), default=None)
        if best is not None and step.act == "door":
            away = math.atan2(best.position[1] - entry.y, best.position[0] - entry.x)
            x, y = _across(best, away)
            return best.position[0] + _BEYOND_M * x, best.position[1] + _BEYOND_M * y
        angle = entry.yaw + BEARINGS[step.side or "ahead"]
        return entry.x + _AHEAD_M * math.cos(angle), entry.y + _AHEAD_M * math.sin(angle)

    def _off(self, step: Direction, door: Detection) -> float:
        assert self._entry is not None
        away = math.atan2(door.position[1] - self._entry.y, door.position[0] - self._entry.x)
        return off_side(step.side or "ahead", wrap(away - self._entry.yaw))


def _read(instruction: str) -> tuple[Direction, ...]:
    """The steps of an instruction; none of one in other words, which is no reason to stand still."""
    try:
        return directions.read(instruction)
    except HthorError:
        return ()


def _at(pose: Pose) -> Vec2:
    return pose.x, pose.y


def _across(door: Detection, heading: float) -> Vec2:
    """The unit vector through a doorway that is nearer to a heading [rad]."""
    x, y = turn((0.0, 1.0), door.yaw)
    sign = 1.0 if x * math.cos(heading) + y * math.sin(heading) >= 0.0 else -1.0
    return sign * x, sign * y
