"""Getting past people: round them where there is room, else out of their way until they are past."""

import itertools
import math
from collections.abc import Mapping, Sequence

from msgspec import Struct

from hthor.agents.skills.right_of_way.yielding import Yielding, seat_bumped
from hthor.agents.skills.viewpoints import Routes, keeps_clear, path_length
from hthor.navigation.detours import Disc
from hthor.navigation.path_follower import Follower, shift
from hthor.types import Briefing, Motion, Observation, Vec2, Wait, is_person

_AHEAD_M = 1.2
"""How much of the path ahead is checked for people [m]."""
_CLEAR_M = 2.5
"""How much of it has to be free before a robot that has made way goes on [m]."""
_MARGIN_M = 0.05
"""Room left between the bodies [m]."""
_DETOUR_M = 2.0
"""A path round people may be this much longer than the way ahead [m]."""
_NEAR_M = 3.0
"""People within this distance count as obstacles of a detour [m]."""
_RECENT_S = 3.0
"""How long a person who is out of view is expected to be where they were [s]."""
_LET_BY_S, _AGAIN_S = 4.0, 2.0
"""How long to make way for somebody in a passage at most, and then not to do so again [s]."""
_APART_M = 1.2
"""How far from the person to wait [m]."""
_ELBOW_M = 0.3
"""Whoever comes closer than this makes the waiting robot step away [m]."""
_PIECE_S = 0.3


class _Person(Struct, frozen=True):
    """Where a person was seen last [m], and at which tick."""

    spot: Vec2
    tick: int


class Passing:
    """Checks the path ahead for people before every motion; people who are not in the way are no reason to stop.

    In a passage without room for two the person has the right of way: the robot goes where it blocks nobody, waits
    until the person is past, and takes its path again.
    """

    def __init__(self, briefing: Briefing, routes: Routes, yielding: Yielding) -> None:
        self.routes, self.yielding, self.tick_s = routes, yielding, briefing.tick_s
        self.touching = yielding.touching
        self._seen: dict[str, _Person] = {}
        self._until = self._rest = -1.0
        self._passes = False
        self._around, self._retreat = Follower(turn_rad=math.pi), Follower(turn_rad=math.pi)

    def motion(self, observation: Observation, follower: Follower, is_free: bool) -> Motion | None:
        """A motion that lets a person by, or None to carry on, perhaps on another path, which ``follower`` then has.

        Args:
            is_free: whether the robot has nothing to do where it stands.
        """
        self._see(observation)
        here, goal = (observation.pose.x, observation.pose.y), follower.goal
        people, seconds = self._people(observation, here), observation.tick * self.tick_s
        if goal is None or follower.done:
            self._until, self._passes = -1.0, False
            return self._step_away(observation, people) if is_free else None
        by = seat_bumped(observation)
        if by:
            self._retreat.take(())
            self._around.take(())
            if is_person(by):
                return Wait(seconds=_PIECE_S)
            self._passes = False
            return None  # another robot stands where the robot would pass
        if seconds >= self._until and not self._passes and not self._is_blocked((here, *follower.rest), people):
            return None
        way = self.routes.way(here, goal)
        if not self._is_blocked(way, people, _AHEAD_M if seconds >= self._until else _CLEAR_M):
            self._until, self._passes = -1.0, False
            follower.take(way)
            return None
        if seconds < self._until:
            return self._make_way(observation, people)
        motion = self._pass(observation, people, goal, path_length(way) + _DETOUR_M)
        if motion is not None:
            return motion
        if seconds < self._rest:
            return None
        self._until, self._rest = seconds + _LET_BY_S, seconds + _LET_BY_S + _AGAIN_S
        self._retreat.take(() if self._is_taken(goal, people) else self._refuge(here, people))
        return self._make_way(observation, people)

    def _pass(self, observation: Observation, people: Mapping[str, Vec2], goal: Vec2, most_m: float) -> Motion | None:
        """The next motion round people, without turning; None when there is no path of at most ``most_m`` [m]."""
        here, outcome = (observation.pose.x, observation.pose.y), observation.outcome
        stopped = outcome is not None and not outcome.ok and outcome.motion == "move"  # by furniture, at a tight corner
        if stopped or self._around.done or self._is_blocked((here, *self._around.rest), people):
            start = self.routes.loose(here) if stopped else here
            way = self.routes.past(start, goal, self._discs(people), most_m)
            self._around.take((start, *way) if way and stopped else way)
        motion = self._around.next(observation.pose)
        self._passes = motion is not None
        return motion

    def _is_taken(self, goal: Vec2, people: Mapping[str, Vec2]) -> bool:
        """Whether somebody stands where the robot wants to stand."""
        return any(math.dist(person, goal) < self.touching(seat) for seat, person in people.items())

    def _refuge(self, here: Vec2, people: Mapping[str, Vec2]) -> tuple[Vec2, ...]:
        """A path to a place where the robot blocks nobody; () for none."""
        nearest = min(people.values(), key=lambda person: math.dist(person, here))
        return self.routes.refuge(here, nearest, _APART_M, self._discs(people))

    def _make_way(self, observation: Observation, people: Mapping[str, Vec2]) -> Motion:
        """On to where the robot blocks nobody, or a step away from the nearest person, or else a pause."""
        step = self._retreat.next(observation.pose)
        if step is not None:
            return step
        aside = None if self._retreat.path else self._step_away(observation, people)
        return aside or Wait(seconds=_PIECE_S)

    def _step_away(self, observation: Observation, people: Mapping[str, Vec2]) -> Motion | None:
        """A step away from the nearest person, if they are very close."""
        here = (observation.pose.x, observation.pose.y)
        seat = min(people, key=lambda seat: math.dist(people[seat], here), default="")
        if not seat or math.dist(people[seat], here) > self.touching(seat) + _ELBOW_M:
            return None
        aside = self.yielding.aside(here, people[seat])
        return None if aside is None else shift(observation.pose, aside)

    def _discs(self, people: Mapping[str, Vec2]) -> list[Disc]:
        return [(*person, self.touching(seat) + _MARGIN_M) for seat, person in people.items()]

    def _see(self, observation: Observation) -> None:
        for seen in observation.detections:
            if seen.family == "person":
                self._seen[seen.id] = _Person(seen.position[:2], observation.tick)
        by = seat_bumped(observation)
        if is_person(by):
            place = self.yielding.place(observation, by)
            if place is not None:
                self._seen[by] = _Person(place, observation.tick)

    def _people(self, observation: Observation, here: Vec2) -> dict[str, Vec2]:
        """The people close by, by seat."""
        least = observation.tick - round(_RECENT_S / self.tick_s)
        return {
            seat: one.spot
            for seat, one in self._seen.items()
            if one.tick >= least and math.dist(one.spot, here) < _NEAR_M
        }

    def _is_blocked(self, path: Sequence[Vec2], people: Mapping[str, Vec2], ahead_m: float = _AHEAD_M) -> bool:
        """Whether somebody stands on the next ``ahead_m`` [m] of the path."""
        return any(self._is_in_way(seat, path, person, ahead_m) for seat, person in people.items())

    def _is_in_way(self, seat: str, path: Sequence[Vec2], person: Vec2, ahead_m: float) -> bool:
        """Whether a person stands on the next ``ahead_m`` [m] of the path."""
        left = ahead_m
        for a, b in itertools.pairwise(path):
            apart = math.dist(a, b)
            if apart == 0.0:
                continue
            share = min(1.0, left / apart)
            end = (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
            if not keeps_clear(a, end, person, self.touching(seat)):
                return True
            left -= apart
            if left <= 0.0:
                return False
        return False
