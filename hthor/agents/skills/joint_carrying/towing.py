"""Leading: pulls a thing that several bodies carry to its place, and says when it may be put down."""

import math
from typing import Protocol

from hthor.agents.skills.viewpoints import Routes
from hthor.navigation.path_follower import Follower, shift
from hthor.types import Drop, Motion, Observation, ThingState, Vec2, Vec3, Wait

_THERE_M = 0.45
"""The thing is put down this close to its place [m]."""
_ENOUGH_M = 0.7
"""The same distance [m] for a thing that does not get closer."""
_STILL_S = 3.0
"""How long a thing that does not get closer has not moved [s]."""
_PAST_M = (0.9, 0.6, 0.3, 0.0)
"""How far past the place the leader goes [m], so that the thing behind it ends up there."""
_AIMS = 24
_STUCK = 4
"""After so many blocked moves in a row, another body may lead for a while."""
_REST_S = 6.0


class TowingRoutes(Routes, Protocol):
    """Routes that also serve a body that pulls something along."""

    def broad(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]: ...


class Towing:
    """One body's motions while it leads.

    Args:
        step: longest move [m].
    """

    def __init__(self, routes: TowingRoutes, step: float, tick_s: float) -> None:
        self.routes, self.tick_s = routes, tick_s
        self.follower = Follower(step=step)
        self._place: Vec3 | None = None
        self._stuck, self._until, self._number = 0, -1, 0

    def rest(self) -> None:
        """Let another body lead."""
        self._place, self._until = None, -1

    @staticmethod
    def is_there(state: ThingState, place: Vec3, still_s: float) -> bool:
        """Whether the thing, which has not moved for ``still_s`` [s], may be put down."""
        apart = math.dist(state.position[:2], place[:2])
        return apart < _THERE_M or (apart < _ENOUGH_M and still_s > _STILL_S)

    def lead(self, observation: Observation, state: ThingState, place: Vec3) -> Motion:
        """Pull the thing to its place."""
        here, outcome = (observation.pose.x, observation.pose.y), observation.outcome
        if observation.tick < self._until:
            return Wait(seconds=0.3)
        stopped = outcome is not None and not outcome.ok and outcome.motion == "move"
        self._stuck = self._stuck + 1 if stopped else 0
        if self._place is None or math.dist(place, self._place) > _THERE_M:
            self._place, self._number = place, 0
            self.follower.take(self._course(here, state, place))
        elif stopped:
            return self._free(observation, state, place)
        step = self.follower.next(observation.pose)
        if step is not None:
            return step
        self._number += 1
        if math.dist(state.position[:2], place[:2]) < _ENOUGH_M or self._number > _AIMS:
            return Drop()
        self.follower.take(self._course(here, state, place))
        return self.follower.next(observation.pose) or Wait(seconds=0.3)

    def _course(self, here: Vec2, state: ThingState, place: Vec3) -> tuple[Vec2, ...]:
        """The path to the place and past it, in line with the thing at first, from other sides if that failed."""
        way = self.routes.broad(here, place[:2])
        before = way[-2] if len(way) > 1 and self._number == 0 else state.position[:2]
        angle = math.atan2(place[1] - before[1], place[0] - before[0]) + _swing(self._number)
        for past in _PAST_M:
            end = (place[0] + past * math.cos(angle), place[1] + past * math.sin(angle))
            if self.routes.stands(end) and (past == 0.0 or self.routes.fits(place[:2], end)):
                return self.routes.broad(here, end)
        return way

    def _free(self, observation: Observation, state: ThingState, place: Vec3) -> Motion:
        """After a blocked move: swing to a side; after several tries, let the others lead."""
        here = (observation.pose.x, observation.pose.y)
        if self._stuck >= _STUCK:
            self._stuck = 0
            self._until = observation.tick + round(_REST_S / self.tick_s)
            self.follower.take(self._course(here, state, place))
            return Wait(seconds=0.3)
        ahead = self.follower.ahead or place[:2]
        angle = math.atan2(ahead[1] - here[1], ahead[0] - here[0]) + (0.0, 1.0, -1.0, 2.2)[self._stuck % 4]
        spot = (here[0] + 0.3 * math.cos(angle), here[1] + 0.3 * math.sin(angle))
        self.follower.take((spot, *self._course(spot, state, place)) if self.routes.fits(here, spot) else None)
        return shift(observation.pose, spot, 0.3)


def _swing(number: int) -> float:
    """Angle of a try [rad]: 0 for the first, then to alternating sides, ever farther."""
    return (1 if number % 2 else -1) * 0.5 * ((number + 1) // 2)
