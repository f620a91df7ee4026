"""The oracle robot of the paper: knows where everything is and walks there; knows nothing of the person's plans."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hthor import geometry, rules
from hthor.agents._offers import APART_M, Offers, place, sighting, spot, title
from hthor.types import HUMAN, Action, Briefing, Motion, Observation, Send, Thing, ThingState, Vec2, Vec3, Wait

if TYPE_CHECKING:
    from hthor.agents._routes import Routes
    from hthor.navigation.courtesy import Courtesy
    from hthor.navigation.follow import Follower

_LOOKS = 3
"""Spots to look from before saying that the target must be in there: over the rim of a sink, a low eye sees nothing."""


class Agent:
    """Walks the shortest way to the target and speaks only when it is close enough to detect it.

    Behind a closed door it cannot detect, and says so from in front of the door. When the person has the target in
    hand it goes on to the destination, and tells where that is.
    """

    privileges = ("house_map", "ideal_detector", "object_poses")
    robots: tuple[str, ...] = ()

    def begin(self, briefing: Briefing) -> None:
        """Prepare the shortest ways of this house."""
        from hthor.agents._routes import Routes
        from hthor.navigation.courtesy import Courtesy
        from hthor.navigation.follow import Follower

        assert briefing.house is not None, "the oracle needs the privilege house_map"
        self.briefing, self.house = briefing, briefing.house
        self.routes: Routes = Routes(briefing.house, briefing.body)
        self.courtesy: Courtesy = Courtesy(briefing.body, self.routes.fits)
        self.follower: Follower = Follower(step=0.5)
        self.offers = {"target": Offers(briefing, most=3), "destination": Offers(briefing, most=1)}
        self.kinds = {thing.id: thing.kind for thing in briefing.house.things}
        self.goal: Vec3 | None = None
        self.misses: list[Vec2] = []
        self.spoken_about = self.aside = ""

    def act(self, observation: Observation) -> Action:
        """Tell when it is time, and go to where the errand is."""
        target = next((thing for thing in observation.truth if thing.id == self.briefing.target), None)
        if target is None:
            return Action(motion=Wait(seconds=1.0))
        errand, where = self._errand(target)
        say = self._say(observation, target, errand, where)
        if not observation.idle:
            return Action(say=say)
        yielding = self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)
        motion = yielding if yielding is not None else self._go(observation, errand, where)
        return Action(motion=motion, say=say)

    def _errand(self, target: ThingState) -> tuple[str, Vec3]:
        """What to show now, the target or the destination, and where it is [m]."""
        if target.held_by == HUMAN:
            thing = self._destination(target)
            if thing is not None:
                return "destination", thing.centre
        return "target", target.position

    def _destination(self, target: ThingState) -> Thing | None:
        """The thing of the wanted kind that is nearest to the target by the floor."""
        things = [thing for thing in self.house.things if thing.kind == self.briefing.destination]
        if not things:
            return None
        here = (target.position[0], target.position[1])
        return min(things, key=lambda thing: (self.routes.near(here, thing.centre), thing.id))

    def _say(self, observation: Observation, target: ThingState, errand: str, where: Vec3) -> Send | None:
        if not self._is_due(observation, errand):
            return None
        message = (
            self._destined(observation, target, where) if errand == "destination" else self._found(observation, target)
        )
        if message is not None:
            self.offers[errand].note(observation.tick)
            self.spoken_about = errand
        return message

    def _is_due(self, observation: Observation, errand: str) -> bool:
        receipt = observation.receipt if self.spoken_about == errand else None
        return self.offers[errand].due(observation.tick, receipt)

    def _found(self, observation: Observation, target: ThingState) -> Send | None:
        seen = spot(observation, target.id)
        if seen is not None and seen.held_by != HUMAN:
            return Send(text=sighting(seen, self.kinds), object=seen.id, position=seen.position)
        support = next((thing for thing in self.house.things if thing.id == target.support), None)
        if support is None or not self._is_close(observation, support.id):
            return None
        if len(self.misses) < _LOOKS and not self._is_shut(observation, support.id):
            return None
        text = f"{title(target.kind).capitalize()} is {place(support.kind)}."
        return Send(text=text, object=target.id, position=target.position)

    def _is_shut(self, observation: Observation, name: str) -> bool:
        """Whether this is a thing with a door, and the door is closed."""
        thing = next((thing for thing in observation.truth if thing.id == name), None)
        return thing is not None and thing.kind == "fridge" and not thing.open

    def _destined(self, observation: Observation, target: ThingState, where: Vec3) -> Send | None:
        thing = self._destination(target)
        if thing is None or not self._is_close(observation, thing.id):
            return None
        return Send(text=f"{title(thing.kind).capitalize()} is here.", object=thing.id, position=where)

    def _is_close(self, observation: Observation, name: str) -> bool:
        """Whether the robot is within the detector's range of a thing's outline, in the same room."""
        thing = next((thing for thing in self.house.things if thing.id == name), None)
        if thing is None:
            return False
        here = (observation.pose.x, observation.pose.y)
        apart = geometry.distance_to_rectangle(
            here, (thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw
        )
        return apart <= rules.DETECTOR_RANGE_M and self.routes.same_room(here, thing.centre)

    def _go(self, observation: Observation, errand: str, where: Vec3) -> Motion:
        """Walk to where the place is in range, face it, then stand aside; try another spot when it is not seen."""
        from hthor.navigation.follow import face

        if self.goal is None or math.dist(self.goal, where) > 0.3:
            self.goal, self.misses = where, []
            self._route(observation, where)
        elif self.aside == errand and self._is_due(observation, errand):
            self.aside = ""
            self._route(observation, where)
        elif observation.outcome is not None and observation.outcome.motion == "move" and not observation.outcome.ok:
            self._reroute(observation, where)
        step = self.follower.next(observation.pose)
        if step is not None:
            return step
        body = self.briefing.body
        turn = face(observation.pose, where, body.eye, body.pitch_limit)
        if turn is not None:
            return turn
        if self.offers[errand].sent == 0 and len(self.misses) < 2 * _LOOKS:
            self.misses.append((observation.pose.x, observation.pose.y))
            self._route(observation, where)
            return self.follower.next(observation.pose) or Wait(seconds=0.5)
        return self._stand_aside(observation, where, errand)

    def _route(self, observation: Observation, where: Vec3) -> None:
        here = (observation.pose.x, observation.pose.y)
        self.follower.take(self.routes.to_view(here, where, self.misses))

    def _reroute(self, observation: Observation, where: Vec3) -> None:
        """Stopped on the way: go round whoever stands there, or step back from a corner that was cut too close."""
        here = (observation.pose.x, observation.pose.y)
        people = [seen.position for seen in observation.detections if seen.family == "person"]
        via = self.routes.around(here, where, people) if people else self.routes.clear(here)
        self.follower.take((via, *self.routes.to_view(via, where, self.misses)))

    def _stand_aside(self, observation: Observation, where: Vec3, errand: str) -> Motion:
        """Go where it is in nobody's way, once."""
        if self.aside == errand:
            return Wait(seconds=0.5)
        self.aside = errand
        here = (observation.pose.x, observation.pose.y)
        self.follower.take(self.routes.retreat(here, (where[0], where[1]), APART_M))
        return self.follower.next(observation.pose) or Wait(seconds=0.5)
