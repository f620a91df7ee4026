"""A simulation whose scene can be changed at once, between motions: bodies, objects and doors."""

import math
from collections.abc import Sequence

from hthor.types import Pose, Vec2
from hthor.world import numbers
from hthor.world.motion import spawn
from hthor.world.simulation import Simulation
from hthor.world.state.body_state import BodyState


class EditableSimulation(Simulation):
    """A `Simulation` in which a program can put bodies, objects and doors where it wants them."""

    def out_of_hand(self, seat: str, id: str, place: Vec2 | None = None) -> str:
        """Why a body could not pick an object up or reach a thing's door with an empty hand; empty when it could.

        Args:
            seat: the body's seat. id: the object or thing; the result is also "" if it can be neither picked up nor
                opened, or if the body can do neither.
            place: (x, y) [m] where the body would stand, facing the thing; None for its present pose.
        """
        body = self._seats[seat]
        return self._manipulation.out_of_hand(body if place is None else self._imagined(body, id, place), id)

    def _imagined(self, body: BodyState, id: str, place: Vec2) -> BodyState:
        """A copy of a body that stands at a place and faces an object or a thing that opens."""
        item, door = self._objects.get(id), self._doors.get(id)
        x, y, _ = item.position if item is not None else door.thing.centre if door is not None else (*place, 0.0)
        copy = BodyState(body.name, body.spec, body.space)
        copy.pose = Pose(x=place[0], y=place[1], yaw=math.atan2(y - place[1], x - place[0]))
        return copy

    def teleport(self, seat: str, pose: Pose) -> None:
        """Put a body somewhere at once; its motion under way, and its drive, end.

        Raises:
            HthorError: when the body does not fit there, another is there, a number is not finite or out of range, or
                the head of a robot is turned.
        """
        body, pose = self._seats[seat], numbers.pose(pose)
        spawn.check_fits(body, pose, self._seats.values())
        body.pose, body.activity = pose, None
        self._driven.stop(body)
        self._door_handling.release(seat)
        self._joint_carrying.release(body, self.tick)
        if body.holding:
            self._objects.follow(body.holding)

    def put_object(
        self,
        id: str,
        position: Sequence[float] | None = None,
        *,
        on: str = "",
        yaw: float = 0.0,
        velocity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Put one of this world's objects somewhere at once; from then on the engine moves it.

        Args:
            id: an object of the house or of ``objects``; it need not be in the episode yet.
            position: [m] of its centre; with ``on``, it is put as near to this point as there is room.
            on: id of a thing to put it on (or in, if the thing has no top), along the thing's edges when ``yaw`` is 0.
            yaw: [rad] its heading; with ``on``, relative to the thing.
            velocity: [m/s] its initial velocity.

        Raises:
            UnknownName: when there is no object with this id, or nothing can be put on the thing ``on``.
            HthorError: when the object is in someone's hand, would be outdoors or inside something, has no room there,
                or its velocity is too high.
        """
        self._editor.put(id, position, on, yaw, velocity)

    def remove_object(self, id: str) -> None:
        """Take an object out of the episode; `put_object` brings it back.

        Raises:
            UnknownName: when there is no object with this id. HthorError: when it is in a hand.
        """
        self._editor.remove(id)

    def set_open(self, thing: str, wanted: bool = True) -> None:
        """Open or close a fridge, a drawer or a door at once.

        Raises:
            UnknownName: when no thing with this id opens. HthorError: when something is in its way.
        """
        self._door_handling.put(thing, wanted)
