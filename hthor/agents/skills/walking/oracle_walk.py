"""The oracle where somebody has to go to a landmark: knows the way, walks it itself or tells the person who walks."""

import math

import numpy as np

from hthor.agents.skills.message_timing import ASIDE_M
from hthor.agents.skills.routes import HouseRoutes
from hthor.agents.skills.walking.landmark_messages import LandmarkMessages
from hthor.geometry.plane import distance_to_rectangle
from hthor.navigation.path_follower import Courtesy, Follower, face
from hthor.types import Action, Briefing, Motion, Observation, Thing, Vec2, Wait

_BESIDE_M = 0.8
"""How near [m] the robot goes to the landmark's edge. Our choice: well within the goal's 1 m."""


class OracleWalk:
    """One robot's policy for one trial; the landmark is the house's only thing of the destination's kind."""

    def __init__(self, briefing: Briefing) -> None:
        assert briefing.house is not None, "the oracle needs the privilege house_map"
        self.briefing, self.messages = briefing, LandmarkMessages(briefing)
        self.routes = HouseRoutes(briefing.house, briefing.body)
        self.courtesy = Courtesy(briefing.body, self.routes.fits)
        self.follower = Follower(step=0.5)
        self.end = next((thing for thing in briefing.house.things if thing.kind == briefing.destination), None)
        self._is_aside = False
        self._misses: list[Vec2] = []

    def act(self, observation: Observation) -> Action:
        """The next motion and message; as `hthor.types.Mind.act`."""
        self.messages.see(observation)
        say = self.messages.say(observation)
        if not observation.idle:
            return Action(say=say)
        return Action(motion=self._motion(observation, self.end) if self.end else Wait(seconds=1.0), say=say)

    def unfinished(self) -> list[str]:
        """What people may ask for."""
        return self.messages.unfinished()

    def _motion(self, observation: Observation, end: Thing) -> Motion:
        here = (observation.pose.x, observation.pose.y)
        own = self.messages.walks_itself
        if own and self.follower.done and self.follower.path and _edge_distance(end, here) <= 1.2 * _BESIDE_M:
            return Wait(seconds=1.0)
        aside = self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)
        if aside is not None:
            self.follower.take(None)
            return aside
        if self._is_stopped(observation):
            self._evade(observation, here)
        if self.follower.done:
            self.follower.take(self._way(observation, end, here))
        body = self.briefing.body
        step = self.follower.next(observation.pose)
        return step or face(observation.pose, end.centre, body.eye, body.pitch_limit) or Wait(seconds=0.5)

    def _is_stopped(self, observation: Observation) -> bool:
        outcome = observation.outcome
        return outcome is not None and not outcome.ok and outcome.motion == "move" and not self.follower.done

    def _evade(self, observation: Observation, here: Vec2) -> None:
        """After a stop: step off a wall; if a body was in the way, head for another spot."""
        by = observation.outcome.by if observation.outcome is not None else ""
        seats = (*self.briefing.teammates, self.briefing.seat)
        if by in seats:
            self._misses.append(self.follower.goal or here)
        self.follower.take(None if by in seats else (self.routes.loose(here),))

    def _way(self, observation: Observation, end: Thing, here: Vec2) -> tuple[Vec2, ...]:
        """To the landmark's edge, or to where it can be detected, or out of the way when all is said."""
        if self.messages.walks_itself:
            return self._beside(end, here)
        if not self.messages.is_due(observation):
            if self._is_aside:
                return ()
            self._is_aside = True
            return self.routes.retreat(here, (end.centre[0], end.centre[1]), ASIDE_M)
        self._is_aside = False
        return self.routes.to_view(self.routes.space.nearest_free(*here), end.centre, self._misses)

    def _beside(self, end: Thing, here: Vec2) -> tuple[Vec2, ...]:
        """The shortest way to a spot in the landmark's room, next to its edge; () when there is none."""
        space = self.routes.space
        room = next((room for room in self.routes.house.rooms if room.id == end.room), None)
        cells = space.centres(space.free & space.room_mask(room)) if room is not None else np.zeros((0, 2))
        spots = [
            (float(x), float(y))
            for x, y in cells
            if _edge_distance(end, (x, y)) <= _BESIDE_M
            and all(math.dist((x, y), miss) > 2 * self.briefing.body.radius for miss in self._misses)
        ]
        lengths = self.routes.lengths(here, spots) if spots else [math.inf]
        best = int(np.argmin(lengths))
        return self.routes.way(here, spots[best]) if math.isfinite(lengths[best]) else ()


def _edge_distance(thing: Thing, here: Vec2) -> float:
    """Distance [m] of a place from the thing's edge."""
    return distance_to_rectangle(here, thing.centre[:2], thing.size[:2], thing.yaw)
