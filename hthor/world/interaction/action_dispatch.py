"""Which rules decide on an action, and which activity carries it out."""

from collections.abc import Sequence

from hthor.types import Close, Drop, HouseSpec, Motion, Move, Open, Pick, Place, Rotate, Vec2, Wait
from hthor.world.carrying import carry_motion
from hthor.world.interaction.manipulation import HandMotion, Manipulation
from hthor.world.motion import locomotion
from hthor.world.motion.blocking_object import ObstacleFootprints
from hthor.world.state.body_state import Activity, BodyState
from hthor.world.state.doors import Doors


class ActionDispatch:
    """Checks actions of one world's bodies and starts them."""

    def __init__(self, house: HouseSpec, manipulation: Manipulation, doors: Doors, seats: Sequence[BodyState]) -> None:
        self._manipulation, self._doors, self._obstacles = manipulation, doors, ObstacleFootprints(house)
        self._joint_carrying = manipulation.joint_carrying
        self._others = {seat.name: tuple(other for other in seats if other is not seat) for seat in seats}

    def refusal(self, seat: BodyState, action: object) -> str:
        """Why the motion cannot be started, empty when it can."""
        if isinstance(action, (Move, Rotate, Wait)):
            reason = locomotion.refusal(seat, action)
            return reason or (self._joint_carrying.stuck(seat) if seat.holding and isinstance(action, Move) else "")
        if isinstance(action, (Pick, Place, Drop, Open, Close)):
            return self._manipulation.refusal(seat, action)
        return f"{type(action).__name__} is not a motion; valid: Move, Rotate, Pick, Place, Drop, Open, Close, Wait"

    def activity(self, seat: BodyState, action: Motion) -> Activity:
        """The motion under way."""
        load = self._joint_carrying.of(seat) if seat.holding else None
        if load is not None and isinstance(action, Move):
            return carry_motion.CarryMotion(seat, action, load, self._culprit)
        if load is not None and isinstance(action, Rotate):
            return carry_motion.CarryRotation(seat, action)
        if isinstance(action, Move):
            return locomotion.MoveMotion(seat, action, self._others[seat.name], self._culprit)
        if isinstance(action, Rotate):
            return locomotion.RotateMotion(seat, action)
        if isinstance(action, Wait):
            return locomotion.WaitMotion(action)
        return HandMotion(seat, action, self._manipulation)

    def _culprit(self, seat: BodyState, step: Vec2) -> str:
        """What the body would have run into: the nearest thing's id, or "wall"."""
        shut = [leaf.opening for leaf in self._doors if leaf.opening is not None and not leaf.open]
        return self._obstacles.nearest((seat.pose.x + step[0], seat.pose.y + step[1]), seat.spec.height, shut)
