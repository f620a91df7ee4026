"""Changes the scene at once, between motions: bodies, objects and doors go where a program wants them."""

from collections.abc import Sequence

from hthor.errors import HthorError
from hthor.types import Placement, Pose
from hthor.world import numbers
from hthor.world.motion import spawn
from hthor.world.simulation import Simulation

_AT_REST = (0.0, 0.0, 0.0)


class SceneSetup:
    """Puts the bodies, objects and doors of one simulation somewhere; see `World` for each call."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def teleport(self, seat: str, pose: Pose) -> None:
        """See `World.teleport`."""
        parts, body, pose = self._simulation.parts, self._simulation.parts.seats[seat], numbers.pose(pose)
        spawn.check_fits(body, pose, parts.seats.values())
        body.pose, body.activity = pose, None
        parts.driven.stop(body)
        parts.loose_things.make_way(body, (0.0, 0.0))
        parts.door_handling.release(seat)
        parts.joint_carrying.release(body, self._simulation.tick)
        if body.holding:
            parts.objects.follow(body.holding)
        parts.mocap.write()

    def put_object(
        self,
        id: str,
        position: Sequence[float] | None = None,
        *,
        on: str = "",
        yaw: float = 0.0,
        velocity: Sequence[float] = _AT_REST,
    ) -> None:
        """See `World.put_object`."""
        self._simulation.parts.editor.put(id, position, on, yaw, velocity)

    def remove_object(self, id: str) -> None:
        """See `World.remove_object`."""
        self._simulation.parts.editor.remove(id)

    def set_open(self, thing: str, wanted: bool = True) -> None:
        """See `World.set_open`."""
        self._simulation.parts.door_handling.put(thing, wanted)

    def rearrange(self, before: Sequence[Placement], after: Sequence[Placement]) -> None:
        """See `World.rearrange`."""
        was = {placement.id: (placement.position, placement.yaw) for placement in before}
        moved = [one for one in after if was.get(one.id) != (one.position, one.yaw)]
        gone = was.keys() - {placement.id for placement in after}
        for id in sorted(gone | {placement.id for placement in moved}):
            self._take_away(id)
        for placement in moved:
            try:
                self.put_object(placement.id, placement.position, yaw=placement.yaw)
            except HthorError:
                if not placement.support:
                    raise
                self.put_object(placement.id, placement.position, on=placement.support)

    def _take_away(self, id: str) -> None:
        """Take an object out of the episode, and out of the hands that hold it; what these hands do ends."""
        objects = self._simulation.parts.objects
        for body in self._simulation.parts.seats.values():
            if body.holding == id:
                if body.activity is not None and body.activity.of_hands:
                    body.activity = None
                self._simulation.parts.joint_carrying.release(body, self._simulation.tick)
                if body.holding:
                    body.holding = ""
                    objects.put(id, objects.pose(id), "")
        self._simulation.parts.editor.remove(id)
