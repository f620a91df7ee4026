"""Looks at all furniture that a robot knows, piece by piece, from close by."""

import math
from collections.abc import Sequence

from hthor.agents.skills import viewpoints
from hthor.agents.skills.knowledge import Knowledge, has_door
from hthor.agents.skills.touring.surface_survey import SurfaceSurvey
from hthor.agents.skills.viewpoints import Routes, outline_distance
from hthor.navigation.path_follower import Follower, face
from hthor.types import BodySpec, Motion, Observation, Thing, Vec2, Vec3

_NEARER_M = 0.1
"""[m] How much nearer than necessary the robot comes. Our choice."""
_STOPS = 4
"""[count] Places from which one piece of furniture is looked at, at most. Our choice."""
_LOOKS = 4
"""[count] Turns at one place, at most. Our choice."""


class Inspection:
    """Goes to the nearest piece that was not looked at, and turns until all of it that is near was in view.

    Attributes:
        piece: the piece of furniture that it is at, or on the way to.
    """

    def __init__(self, body: BodySpec, routes: Routes, knowledge: Knowledge) -> None:
        self.body, self.routes, self.knowledge = body, routes, knowledge
        self.survey = SurfaceSurvey(body)
        self.follower = Follower(step=0.5)
        self.piece: Thing | None = None
        self._looks = 0
        self._stops: dict[str, list[Vec2]] = {}

    def see(self, observation: Observation) -> None:
        """Note what is in view; call at every act."""
        self.survey.add(self.knowledge.things.values())
        self.survey.see(observation.pose, self._bare(), self.routes.open_to)

    def motion(self, observation: Observation) -> Motion | None:
        """The next motion; None while nothing is left that can be reached."""
        outcome = observation.outcome
        if outcome is not None and not outcome.ok and outcome.motion == "move":
            self.follower.take(None)  # this stop counts as made: look from here, then try another
        for _ in range(2 * len(self.knowledge.things) + 1):
            if self.piece is None or not self._is_open(self.piece):
                self.piece = self._choose(observation)
                if self.piece is None:
                    return None
            motion = self.follower.next(observation.pose) or self._look(observation, self.piece)
            if motion is not None:
                return motion
            self._set_out(observation, self.piece)
        return None

    def give_up(self, thing: Thing) -> None:
        """Look at a piece no more."""
        self.survey.drop(thing.id)
        self.drop()

    def drop(self) -> None:
        """Do something else first."""
        self.piece = None
        self.follower.take(None)

    def _bare(self) -> list[Thing]:
        return [thing for thing in self.knowledge.things.values() if not self.knowledge.is_shut(thing.id)]

    def _is_open(self, thing: Thing) -> bool:
        return self.survey.is_left(thing.id) and not self.knowledge.is_shut(thing.id)

    def left(self) -> list[Thing]:
        """The furniture that is still to be looked at; the present piece alone until it is done."""
        if self.piece is not None and self._is_open(self.piece):
            return [self.piece]
        return [thing for thing in self._bare() if self.survey.is_left(thing.id)]

    def nearest(self, observation: Observation, things: Sequence[Thing]) -> Thing | None:
        """The nearest of these things, in a straight line."""
        here = (observation.pose.x, observation.pose.y)
        return min(things, key=lambda thing: (self._apart(here, thing), thing.id), default=None)

    def _choose(self, observation: Observation) -> Thing | None:
        """Set out for the nearest piece that is left."""
        left = self.left()
        while (thing := self.nearest(observation, left)) is not None:
            if self._set_out(observation, thing):
                return thing
            left.remove(thing)
        return None

    def _apart(self, here: Vec2, thing: Thing) -> float:
        """The distance [m] to a thing; those behind a wall are farther."""
        wall = not self.routes.open_to(here, viewpoints.nearest_outline_point(thing, here))
        return outline_distance(thing, here) + (2.0 if wall else 0.0) * self.body.sight_range

    def _set_out(self, observation: Observation, thing: Thing) -> bool:
        """Take the path to where more of a thing can be seen; False, and drop it, if there is none."""
        here, points = (observation.pose.x, observation.pose.y), self.survey.left(thing.id)
        stops = self._stops.setdefault(thing.id, [])
        way: tuple[Vec2, ...] = ()
        if points and len(stops) < _STOPS:
            reach, front = self._reach(points), has_door(thing)
            way = viewpoints.path_to_reach(self.routes, here, points, reach, thing, front=front, but=stops)
        if not way:
            self.survey.drop(thing.id)
            return False
        stops.append(way[-1])
        self._looks = 0
        self.follower.take(way)
        return True

    def _reach(self, points: tuple[Vec3, ...]) -> float:
        """How near [m] on the plan the robot has to come to have the points within its detector's range."""
        rise = max(abs(point[2] - self.body.eye) for point in points)
        return max(0.3, math.sqrt(max(0.0, self.body.sight_range**2 - rise**2)) - _NEARER_M)

    def _look(self, observation: Observation, thing: Thing) -> Motion | None:
        """Turn to the nearest part that was not in view and is within range; None when that was done."""
        pose, points = observation.pose, self.survey.left(thing.id)
        near = [point for point in points if math.dist((pose.x, pose.y, self.body.eye), point) < self.body.sight_range]
        if not near or self._looks >= _LOOKS:
            return None
        self._looks += 1
        point = viewpoints.nearest_point(near, (pose.x, pose.y))
        return face(pose, point, self.body.eye, self.body.pitch_limit)
