"""A simulation whose scene can be changed at once, between motions: bodies, objects and doors."""

from collections.abc import Sequence

from hthor.errors import HthorError
from hthor.types import Placement, Pose, TaskSpec
from hthor.world import numbers
from hthor.world.motion import spawn
from hthor.world.simulation import Simulation

_AT_REST = (0.0, 0.0, 0.0)


class EditableSimulation(Simulation):
    """A `Simulation` in which a program can put bodies, objects and doors where it wants them."""

    def restart(self, task: TaskSpec) -> None:
        """Begin a task as `reset` does, but between two ticks: the ticks and the random draws go on.

        Raises:
            TaskError: as `reset`.
        """
        spawn.check_task(task, self.house)
        tick, seed = self.tick, self._seed
        self._begin({placement.id: placement for placement in task.objects}, task.id)
        self._seed = seed
        people = (task.human_start, *task.other_human_starts)
        spawn.place_bodies(tuple(self._seats.values()), people, task.robot_starts)
        self._begin_moment(tick)

    def rearrange(self, before: Sequence[Placement], after: Sequence[Placement]) -> None:
        """Move the objects whose places differ between two arrangements, also out of hands, and let them rest there.

        Everything else stays as it is: bodies, doors, and objects that have the same place in both arrangements, even
        if they were carried elsewhere. An object that ``after`` leaves out leaves the house. Where somebody has put
        something in the meantime, an object gets the free place nearest to its own on the same support.

        Raises:
            UnknownName: when there is no object with this id. HthorError: when there is no room for an object.
        """
        was = {placement.id: (placement.position, placement.yaw) for placement in before}
        moved = [one for one in after if was.get(one.id) != (one.position, one.yaw)]
        gone = was.keys() - {placement.id for placement in after}
        for id in sorted(gone | {placement.id for placement in moved}):
            self._take_away(id)
        for placement in moved:
            try:
                self._editor.put(placement.id, placement.position, "", placement.yaw, _AT_REST)
            except HthorError:
                if not placement.support:
                    raise
                self._editor.put(placement.id, placement.position, placement.support, 0.0, _AT_REST)

    def _take_away(self, id: str) -> None:
        """Take an object out of the episode, and out of the hands that hold it; what these hands do ends."""
        for body in self._seats.values():
            if body.holding == id:
                if body.activity is not None and body.activity.of_hands:
                    body.activity = None
                self._joint_carrying.release(body, self.tick)
                if body.holding:
                    body.holding = ""
                    self._objects.put(id, self._objects.pose(id), "")
        self._editor.remove(id)

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
        self._loose_things.make_way(body, (0.0, 0.0))
        self._door_handling.release(seat)
        self._joint_carrying.release(body, self.tick)
        if body.holding:
            self._objects.follow(body.holding)
        self._mocap.write()

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
