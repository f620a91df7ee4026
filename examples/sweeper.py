"""A robot that goes through the house furniture by furniture, the likeliest first.

    hthor eval --agent examples/sweeper.py --humans proxy

It asks for no privilege but the detector, and makes its own map. Unlike the frontier robot it does not care for the
edges of its map as such: it prefers places next to furniture where people usually keep what is wanted.
"""

import math

from hthor.navigation import Courtesy, Follower, Frontier, GridMap, Planner, Survey, face, retreat
from hthor.types import Action, Briefing, Detection, Motion, Observation, Pose, Rotate, Send, Wait

LIKELY = {
    "apple": ("counter_top", "dining_table", "fridge"),
    "tomato": ("counter_top", "dining_table", "fridge"),
    "lettuce": ("counter_top", "dining_table", "fridge"),
    "mug": ("counter_top", "coffee_table", "desk", "dining_table"),
    "book": ("desk", "bed", "coffee_table", "sofa"),
    "remote_control": ("tv_stand", "coffee_table", "sofa"),
}
FINISH_FIRST_M = 2.0  # finish a room before the next is begun
TURN_M_RAD = 1.5  # what a radian of turning costs, in metres
WORTH_M = 2.0  # a likely piece of furniture is worth this much of a detour
RIGHT_BESIDE_M = 1.0
APART_M = 1.3  # how far from the target it waits, so that the person can get there
AGAIN_TICKS = 100


class Agent:
    """Sweeps the house: likely furniture first, then whatever was not looked at yet, then the edges of the map."""

    privileges = ("ideal_detector",)

    def begin(self, briefing: Briefing) -> None:
        """Start with an empty map and nothing said."""
        self.brief, self.body = briefing, briefing.body
        self.map = GridMap()
        self.planner = Planner(self.map, self.body.radius, optimistic=False)
        self.courtesy = Courtesy(self.body, self.planner.straight)
        self.follower = Follower(turn_rad=0.8)  # it may go sideways, which saves turns
        self.likely = LIKELY.get(briefing.target, ())
        self.turns = math.ceil(2 * math.pi / self.body.fov[0])
        self.furniture: dict[str, Detection] = {}
        self.target: Detection | None = None
        self.place: Frontier | None = None
        self.messages, self.aside = 0, False
        self.tried: dict[tuple[float, float], int] = {}

    def act(self, observation: Observation) -> Action:
        """Look, speak, move."""
        self.look(observation)
        say = self.say(observation)
        if not observation.idle:
            return Action(say=say)
        polite = self.courtesy.motion(observation, observation.tick * self.brief.tick_s)
        return Action(motion=polite or self.move(observation), say=say)

    def look(self, observation: Observation) -> None:
        """Bring the map and the lists of what was seen up to date."""
        self.map.integrate(observation.scan, look_m=1.15, look_rad=0.45 * self.body.fov[0])
        self.target = next((seen for seen in observation.detections if seen.id == self.brief.target), self.target)
        self.furniture.update((seen.id, seen) for seen in observation.detections if seen.family == "furniture")

    def say(self, observation: Observation) -> Send | None:
        """Tell where the target is; once more after ten seconds when the person said no."""
        seen = next((seen for seen in observation.detections if seen.id == self.brief.target), None)
        receipt = observation.receipt
        again = receipt and receipt.status == "declined" and observation.tick > receipt.tick + AGAIN_TICKS
        if seen is None or seen.held_by or self.messages >= 2 or (self.messages and not again):
            return None
        self.messages += 1
        name = seen.kind.replace("_", " ")
        return Send(text=f"The {name} is right here, in front of me.", object=seen.id, position=seen.position)

    def move(self, observation: Observation) -> Motion:
        """Look around, then go from place to place until the target is found."""
        pose = observation.pose
        if self.target is not None:
            if not self.aside:
                self.aside, here = True, (pose.x, pose.y)
                self.follower.take(retreat(self.map, self.planner, here, self.target.position[:2], APART_M))
            step = self.follower.next(pose)
            return step or face(pose, self.target.position, self.body.eye, self.body.pitch_limit) or Wait(seconds=0.5)
        if self.turns:
            self.turns -= 1
            return Rotate(yaw=self.body.fov[0], pitch=-0.2 - pose.pitch)
        seen = self.place is not None and self.map.was_near(*self.place.centre)
        if seen or self.follower.done or (observation.outcome and not observation.outcome.ok):
            self.choose(observation)
        return self.follower.next(pose) or Rotate(yaw=self.body.fov[0])

    def choose(self, observation: Observation) -> None:
        """Take the path to the best place: near, and next to likely furniture."""
        pose = observation.pose
        survey = Survey(self.map, self.planner, pose, least=0.5)
        places = [(cost(pose, place) - self.worth(place.centre), place) for place in survey.unvisited]
        places += [(cost(pose, place) + FINISH_FIRST_M, place) for place in survey.frontiers]
        places = [(price, place) for price, place in places if self.tried.get(place.centre, 0) < 2]
        if not places:
            self.tried.clear()
            self.map.forget_near()
            self.follower.take(None)
            return
        self.place = min(places, key=lambda entry: (entry[0], entry[1].centre))[1]
        centre = self.place.centre
        self.tried[centre] = self.tried.get(centre, 0) + 1
        self.follower.take(survey.path(self.place))

    def worth(self, centre: tuple[float, float]) -> float:
        """How much detour [m] a place deserves for the furniture next to it."""
        beside = (
            thing
            for thing in self.furniture.values()
            if math.dist(centre, thing.position[:2]) < RIGHT_BESIDE_M + max(thing.size[:2]) / 2
        )
        return WORTH_M if any(thing.kind in self.likely for thing in beside) else 0.0


def cost(pose: Pose, place: Frontier) -> float:
    """The way to a place [m], turns included."""
    x, y = place.centre
    turn = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, 2 * math.pi)
    return place.distance + TURN_M_RAD * abs(turn)
