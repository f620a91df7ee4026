"""Control of one body by hand, for notebooks and scripts: motions, perception and messages.

Each call starts motions and lets ticks pass until the body is free again; the other bodies start no motions during the
call. A trial, in which all bodies act at once, starts motions with `World.start` instead.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hthor import rules
from hthor.geometry import plane
from hthor.types import (
    BodySpec,
    Close,
    Detection,
    Drop,
    Motion,
    Move,
    Open,
    Outcome,
    Pick,
    Place,
    Pose,
    Rotate,
    Scan,
    Vec2,
    Vec3,
    View,
    Wait,
)
from hthor.world import numbers
from hthor.world.actor.seat_messages import SeatMessages
from hthor.world.perception import view_frustum
from hthor.world.rendering.lazy_images import Size

_EPS = 1e-9
_LENGTH_MIN_M, _TURN_MIN_RAD = 1e-6, 1e-3
"""On a route, no turn is made for a leg shorter than the first [m], nor a turn smaller than the second [rad]."""
MOVE_CALL_MAX_M = 1000.0
"""[m] The longest distance of one call of `Actor.move`."""


class Actor(SeatMessages):
    """One seat of a `World`: the person, or a robot.

    Calls that move return the `Outcome`: ``ok``, or the ``reason`` of the failure. A motion that the house or a rule
    forbids never raises; wrong arguments do, such as a name that does not exist.
    """

    def __repr__(self) -> str:
        pose = self.pose
        return f"<{self.body.title} '{self.seat}' at ({pose.x:.2f}, {pose.y:.2f}) in {self.room}>"

    # ------------------------------------------------------------------------------------------------------- state

    @property
    def body(self) -> BodySpec:
        """The abilities of the body."""
        return self._world.bodies[self.seat]

    @property
    def pose(self) -> Pose:
        """The body's pose, house frame."""
        return self._world.pose(self.seat)

    @property
    def room(self) -> str:
        """Id of the room that the body is in."""
        return self._world.room(self.seat)

    @property
    def holding(self) -> str:
        """Id of the object in its hand, empty for none."""
        return self._world.holding(self.seat)

    # ----------------------------------------------------------------------------------------------------- control

    def do(self, motion: Motion) -> Outcome:
        """Carry out a motion of any type and wait for its end."""
        return self._world.run(self.seat, motion)

    def move(self, forward: float, left: float = 0.0) -> Outcome:
        """Move by the vector (``forward``, ``left``) [m] in the body's own frame, in steps of at most 0.5 m.

        Returns:
            the outcome of the last step; the call ends at the first step that is blocked.
        """
        if not (numbers.is_finite(forward) and numbers.is_finite(left)):
            return self.do(Move(forward=forward, left=left))  # its outcome says what is wrong with the numbers
        length = math.hypot(forward, left)
        if length > MOVE_CALL_MAX_M:
            reason = f"move is {numbers.format_number(length)} m long; at most {MOVE_CALL_MAX_M:.0f} m at once"
            return Outcome(motion="move", ok=False, reason=reason)
        steps = max(1, math.ceil(length / rules.MOVE_MAX_M - _EPS))
        outcome = Outcome(motion="move", ok=True)
        for _ in range(steps):
            outcome = self.do(Move(forward=forward / steps, left=left / steps))
            if not outcome.ok:
                break
        return outcome

    def rotate(self, yaw: float, pitch: float = 0.0) -> Outcome:
        """Turn the body to the left by ``yaw`` and tilt the camera up by ``pitch`` [rad]."""
        return self.do(Rotate(yaw=yaw, pitch=pitch))

    def look_at(self, target: str | Vec3) -> Outcome:
        """Turn body and camera towards a thing, an object, a seat or a point [m] of the house frame."""
        point = self._world.position(target) if isinstance(target, str) else numbers.point3("target", target)
        return self.do(view_frustum.rotation_towards(self.pose, self.body, point))

    def go_to(self, target: str | Vec2) -> Outcome:
        """Walk the shortest way to the free floor nearest to a point (x, y) [m], or to a place from which a thing, an
        object or a body is in reach, in sight and can be used: an object be picked up, what the hand holds be placed on
        furniture, or else its door be opened or closed. The outcome is ok only at such a place.

        The way is planned on the house's true floor plan. A walk to a thing ends with the body facing it.

        Raises:
            UnknownName: when no thing, object or seat has this name. HthorError: when the point is in no room.
        """
        world, seat = self._world, self.seat
        target = target if isinstance(target, str) else numbers.point2("target", target)
        stopped = self._walk(world.walks.route(seat, target))
        other = world.walks.body_in_the_way(seat, target) if stopped.ok else ""
        if other:
            stopped = Outcome(motion="move", ok=False, reason=f"{other} is in the way", by=other)
        if not isinstance(target, str) or (not stopped.ok and world.walks.hindrance(seat, target)):
            return stopped
        facing = self.look_at(target)  # whoever is stopped where nothing hinders has arrived
        reason = world.walks.hindrance(seat, target)
        return Outcome(motion="move", ok=False, reason=reason) if facing.ok and reason else facing

    def _walk(self, route: Sequence[Vec2]) -> Outcome:
        """Walk along a route up to where something stops the body."""
        for point in route:
            outcome = self._walk_straight(point)
            if not outcome.ok:
                return outcome
        return Outcome(motion="move", ok=True)

    def _walk_straight(self, point: Vec2) -> Outcome:
        pose = self.pose
        length = math.dist((pose.x, pose.y), point)
        turn = plane.wrap(math.atan2(point[1] - pose.y, point[0] - pose.x) - pose.yaw)
        if length > _LENGTH_MIN_M and abs(turn) > _TURN_MIN_RAD:
            self.rotate(turn)
        return self.move(length)

    def teleport(self, x: float, y: float, yaw: float | None = None, pitch: float | None = None) -> Pose:
        """Put the body at (x, y) [m] at once, with heading ``yaw`` and camera pitch ``pitch`` [rad]; None keeps either.

        Raises:
            HthorError: when the body does not fit there, another is there, or a number is not finite or out of range.
        """
        now = self.pose
        self._world.teleport(
            self.seat, Pose(x=x, y=y, yaw=now.yaw if yaw is None else yaw, pitch=now.pitch if pitch is None else pitch)
        )
        return self.pose

    def pick(self, object: str) -> Outcome:
        """Pick up an object."""
        return self.do(Pick(object=object))

    def place(self, on: str, position: Vec3 | None = None) -> Outcome:
        """Put the held object on or in a thing, near ``position`` [m] if given."""
        return self.do(Place(on=on, position=position))

    def drop(self) -> Outcome:
        """Let go of the held object, which falls."""
        return self.do(Drop())

    def open(self, thing: str) -> Outcome:
        """Open a fridge, a drawer or a door."""
        return self.do(Open(thing=thing))

    def close(self, thing: str) -> Outcome:
        """Close a fridge, a drawer or a door."""
        return self.do(Close(thing=thing))

    def wait(self, seconds: float = rules.TICK_S) -> Outcome:
        """Stand still; the rest of the world goes on."""
        return self.do(Wait(seconds=seconds))

    # -------------------------------------------------------------------------------------------------- perception

    def look(self, size: Size = None, profile: str | None = None) -> View:
        """Colour, depth and segmentation of this moment, and the camera that took them.

        Args:
            size: (width, height) [pixels], None for the camera's own. profile: "fast", "nice", or None for the world's.
        """
        return self._world.look(self.seat, size, profile)

    def rgb(self, size: Size = None, profile: str | None = None) -> NDArray[np.uint8]:
        """The camera's picture, (H, W, 3) uint8; arguments as in `look`."""
        return self._world.picture(self.seat, "rgb", size, profile)

    def depth(self, size: Size = None, profile: str | None = None) -> NDArray[np.float32]:
        """(H, W) float32 [m] along the optical axis."""
        return self._world.picture(self.seat, "depth", size, profile)

    def segmentation(self, size: Size = None, profile: str | None = None) -> NDArray[np.int32]:
        """(H, W) int32, indices into ``World.names``, -1 for nothing."""
        return self._world.picture(self.seat, "segmentation", size, profile)

    def detections(self) -> tuple[Detection, ...]:
        """Detections of the body's detector now, by id."""
        return self._world.detections(self.seat)

    def sees(self, id: str) -> bool:
        """Whether the body's detector reports this object, thing or seat now.

        Raises:
            UnknownName: when nothing with this id is in the house now.
        """
        self._world.position(id)  # raises when it is not in the house
        return any(seen.id == id for seen in self.detections())

    def scan(self) -> Scan:
        """Ranges to walls, furniture and shut doors, which would stop this body."""
        return self._world.scan(self.seat)
