"""Bodies and the loose things on the floor: what is light is pushed, what is not stops a body.

Loose things are the objects in no hand that lie on the floor, on one another there, or fall; a body does not touch what
lies on furniture, nor what is above its head. The bodies are not in the engine's contacts. Instead

- before a body makes a step, what its disc would sweep is shifted out of its way in short pieces, and gets the part of
  the body's speed that points along its shift (`make_way`); from then on the engine moves it;
- after the engine's step, what has rolled, slid or fallen into a body is put back to where it met the body, without the
  speed towards it (`keep_off`).

A step that would take a body into something that it cannot push, because it is heavy, jammed or held by another body,
is not taken. Where nothing is loose, nothing of this is computed.
"""

import math
from collections.abc import Sequence

from hthor import rules
from hthor.geometry import convex
from hthor.types import Vec2, Vec3
from hthor.world.motion.push_plan import DEEP_M, TOUCH_M, Floor, PushPlan
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject

_PIECE_M = 0.03
"""[m] A step is looked at in pieces of at most this length; our choice, less than the width of the smallest things."""
_STILL = (0.0,) * 6


class LooseThings:
    """What the bodies of one world push, and what stops them.

    Attributes:
        low: numbers of the loose things, as in `hthor.world.state.objects.Objects`.
    """

    def __init__(self, floor: Floor) -> None:
        self._floor, self._items, self.low = floor, tuple(floor.objects), floor.objects.low
        self._spans = [math.hypot(*item.size) / 2 for item in self._items]

    def make_way(self, seat: BodyState, step: Vec2, seconds: float = rules.TICK_S) -> bool:
        """Push what is in the way of a step [m] that lasts so long; False if a body cannot make the step."""
        if not self.low:
            return True
        near = self._near((seat.pose.x, seat.pose.y), seat.spec.radius + math.hypot(*step))
        if not near:
            return True
        plan = PushPlan(self._floor)
        if self._try(plan, seat, step, near):
            plan.undo()
            return False
        if plan.shifts:
            plan.commit({item: self._pushed(item, way, step, seconds) for item, way in plan.shifts.items()})
        return True

    def stops(self, seat: BodyState, step: Vec2) -> str:
        """Id of the loose thing that keeps a body from making a step [m]; empty for none."""
        near = self._near((seat.pose.x, seat.pose.y), seat.spec.radius + math.hypot(*step))
        plan = PushPlan(self._floor)
        found = self._try(plan, seat, step, near)
        plan.undo()
        return found

    def keep_off(self, moved: Sequence[tuple[MovableObject, Vec3]]) -> None:
        """Put what the engine has just moved into a body back to where it met it.

        Args:
            moved: the objects, each with its position [m] before the engine's step.
        """
        for item, before in moved:
            if item.number in self.low:
                far = self._spans[item.number] + math.dist(before[:2], item.position[:2])
                for seat in self._floor.seats:
                    apart = math.dist(item.position[:2], (seat.pose.x, seat.pose.y))
                    if apart < seat.spec.radius + far and self._stop(item, seat, before):
                        before = item.position

    def wedged(self, item: MovableObject) -> str:
        """The seat of a body that an object, where it is now, is in and could not be pushed out of; empty for none."""
        plan, found = PushPlan(self._floor), ""
        for seat in self._floor.seats:
            if plan.clear(seat, (seat.pose.x, seat.pose.y), [item], free=item):
                found = seat.name
                break
        plan.undo()
        return found

    def _near(self, place: Vec2, reach: float) -> list[MovableObject]:
        found = []
        for number in sorted(self.low):
            item = self._items[number]
            if math.dist(item.position[:2], place) < reach + self._spans[number]:
                found.append(item)
        return found

    def _try(self, plan: PushPlan, seat: BodyState, step: Vec2, items: Sequence[MovableObject]) -> str:
        """Plan a step; the id of what stops the body, empty for nothing."""
        pieces = max(1, math.ceil(math.hypot(*step) / _PIECE_M))
        for piece in range(1, pieces + 1):
            share = piece / pieces
            found = plan.clear(seat, (seat.pose.x + share * step[0], seat.pose.y + share * step[1]), items)
            if found:
                return found
        return ""

    def _pushed(self, item: MovableObject, way: Vec2, step: Vec2, seconds: float) -> tuple[float, ...]:
        """The velocity (6,) of an object after a body's step has shifted it by ``way`` [m]."""
        length = math.hypot(*way)
        _, _, rise, *spin = self._floor.env.data.qvel[item.dof : item.dof + 6].tolist()
        if length < 1e-12:
            return (0.0, 0.0, rise, *spin)
        speed = max(0.0, (step[0] * way[0] + step[1] * way[1]) / length / seconds)
        return (speed * way[0] / length, speed * way[1] / length, rise, *spin)

    def _stop(self, item: MovableObject, seat: BodyState, before: Vec3) -> bool:
        """Put an object that is in a body now, or was on its way, to where it met the body, or else to where it was.

        Returns:
            whether it was in the body.
        """
        plan, place = PushPlan(self._floor), (seat.pose.x, seat.pose.y)
        now = plan.where(item)
        if now.low >= seat.spec.height:
            return False
        back = (before[0] - item.position[0], before[1] - item.position[1])
        pieces = max(1, math.ceil(math.hypot(*back) / _PIECE_M))
        for piece in range(1, pieces + 1):
            share = 1.0 - piece / pieces
            by = (share * back[0], share * back[1])
            if now.moved(by).depth(place, seat.spec.radius) > TOUCH_M:
                break
        else:
            return False
        plan.shift(item, by)
        if plan.newly_met(item, by, seat) or plan.clear(seat, place, [item], free=item):
            plan.undo()
            self._put_back(item)
            return True
        x, y, z = self._floor.env.data.qvel[item.dof : item.dof + 3].tolist()
        _, away = convex.disc_overlap(place, seat.spec.radius, plan.where(item).outline)
        inward = min(0.0, x * away[0] + y * away[1])
        plan.commit(dict.fromkeys(plan.shifts, (x - inward * away[0], y - inward * away[1], z, 0.0, 0.0, 0.0)))
        return True

    def _put_back(self, item: MovableObject) -> None:
        """Put an object to where it was before the engine's step, and so whatever has come to that place meanwhile."""
        floor, back = self._floor, [item]
        for one in back:  # grows
            floor.objects.shove(one, floor.env.before(one.qpos), _STILL)
            floor.env.touch()
            met = (floor.objects.get(owner) for owner in sorted(floor.overlap.depths(one, DEEP_M)))
            back += [other for other in met if other is not None and other.number in self.low and other not in back]
