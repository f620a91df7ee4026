"""The simplest robot that explores: it always goes to the nearest place that it knows too little about.

A control for robots with a cleverer choice: exploration by distance alone, with hysteresis, is hard to beat. It is here
in one piece, to be read in one sitting.
"""

from __future__ import annotations

import math

from hthor.agents.skills.message_timing import APART_M, ASIDE_M, MessageTiming, find_detection, sighting_text
from hthor.navigation.frontier import Frontier, Survey
from hthor.navigation.grid_map import CELL_M, GridMap
from hthor.navigation.path_follower import Courtesy, Follower, face
from hthor.navigation.planner import Planner
from hthor.navigation.waiting_spots import retreat
from hthor.types import Action, Briefing, Detection, Motion, Observation, Pose, Ready, Rotate, Send, Wait, is_person

KEEP_M = 1.0
"""[m] Hysteresis: another place must be nearer than the present one by this much."""
AGAIN_M = 1.0
"""[m] After this way it chooses again."""
CLOSE_M = 1.15
"""[m] A place on furniture counts as looked at from this near: objects behind its edge are in the detector's range."""
LEAST_M = 0.5
"""[m] Smallest place to go to."""
TRIES = 3
"""How often it goes to one place."""
LOOK_RAD = 0.9
"""Share of the field of view by which it turns when it looks round."""
AT_TABLES_RAD = math.radians(-15.0)
"""[rad] Tilt of the camera while it explores."""


class Agent:
    """Goes to the nearest frontier or piece of furniture that it has not looked at from close by.

    When its detector sees the target, it tells the person, once more ten seconds after a declined message, and stands
    aside.
    """

    privileges: tuple[str, ...] = ("ideal_detector",)

    def begin(self, briefing: Briefing) -> None:
        """Begin with an empty map."""
        self.briefing, body = briefing, briefing.body
        self.map: GridMap | None = None
        self.mapped_from: Pose | None = None
        self.follower = Follower(turn_rad=0.8)
        self.courtesy = Courtesy(body, lambda a, b: self.planner.straight(a, b))
        self.timing = MessageTiming(briefing, most=2)
        self.kinds: dict[str, str] = {}
        self.turns = math.ceil(2.0 * math.pi / (LOOK_RAD * body.fov[0]))
        self.place: Frontier | None = None
        self.chose = (math.inf, math.inf)
        self.tries: dict[tuple[int, int], int] = {}
        self.target: Detection | None = None
        self.aside = False

    def act(self, observation: Observation) -> Action:
        """Tell of the target if it is in view, and go on."""
        if observation.phase:
            return Action(motion=Wait(seconds=1.0), signals=(Ready(),))
        self.see(observation)
        seen = find_detection(observation, self.briefing.target)
        self.target = seen or self.target
        say = None
        due = self.timing.due(observation.tick, observation.receipt)
        if seen is not None and due and not is_person(seen.held_by):
            self.timing.note(observation.tick)
            say = Send(text=sighting_text(seen, self.kinds), object=seen.id, position=seen.position)
        if not observation.idle:
            return Action(say=say)
        motion = self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)
        if motion is None:
            motion = self.explore(observation.pose) if self.target is None else self.watch(observation, due)
        return Action(motion=motion, say=say)

    def see(self, observation: Observation) -> None:
        """Bring the map up to date."""
        pose, outcome = observation.pose, observation.outcome
        if self.map is None:
            self.map = GridMap(pose.x, pose.y)
            self.planner = Planner(self.map, self.briefing.body.radius, optimistic=False)
        if pose != self.mapped_from:
            self.map.integrate(observation.scan, CLOSE_M, 0.45 * self.briefing.body.fov[0])
            self.mapped_from = pose
        self.kinds |= {one.id: one.kind for one in observation.detections}
        ahead = self.follower.ahead
        if observation.idle and outcome is not None and not outcome.ok and outcome.motion == "move" and ahead:
            angle, reach = math.atan2(ahead[1] - pose.y, ahead[0] - pose.x), self.briefing.body.radius + CELL_M
            if not outcome.by or not is_person(outcome.by):
                self.map.mark_blocked(pose.x + reach * math.cos(angle), pose.y + reach * math.sin(angle))
            self.place, self.chose = None, (math.inf, math.inf)
            self.follower.take(None)

    def explore(self, pose: Pose) -> Motion:
        """Look round once, then go to one nearest place after another."""
        look = LOOK_RAD * self.briefing.body.fov[0]
        if self.turns:
            self.turns -= 1
            return Rotate(yaw=look, pitch=AT_TABLES_RAD - pose.pitch)
        if self.follower.done or math.dist(self.chose, (pose.x, pose.y)) > AGAIN_M:
            self.choose(pose)
        return self.follower.next(pose) or Rotate(yaw=look)

    def choose(self, pose: Pose) -> None:
        """Take the nearest place, or keep the present one if no other is much nearer."""
        assert self.map is not None
        last, is_new_try = self.place, self.follower.done or self.place is None
        self.place, self.chose = None, (pose.x, pose.y)
        self.follower.take(None)

        def extra_m(centre: tuple[float, float]) -> float:
            return 0.0 if last is not None and math.dist(centre, last.centre) <= LEAST_M else KEEP_M

        survey = Survey(self.map, self.planner, pose, LEAST_M)
        for one in survey.ranked(extra_m):
            key = (round(one.centre[0] / LEAST_M), round(one.centre[1] / LEAST_M))
            path = survey.path(one) if self.tries.get(key, 0) < TRIES else None
            if path:
                self.tries[key] = self.tries.get(key, 0) + is_new_try
                self.place = one
                self.follower.take(path)
                return
        self.map.forget_near()  # there is nothing left: look at everything again
        self.tries.clear()

    def watch(self, observation: Observation, due: bool) -> Motion:
        """Stand where it blocks nobody, facing the target; come near when another message is due."""
        assert self.target is not None
        assert self.map is not None
        pose, body, (x, y, _) = observation.pose, self.briefing.body, self.target.position
        speaks = due and not is_person(self.target.held_by)
        if self.aside and speaks:
            self.aside = False
            self.follower.take(self.planner.path((pose.x, pose.y), (x, y), within=APART_M))
        elif not self.aside and not speaks:
            self.aside = True
            self.follower.take(retreat(self.map, self.planner, (pose.x, pose.y), (x, y), ASIDE_M))
        step = self.follower.next(pose) or face(pose, self.target.position, body.eye, body.pitch_limit)
        return step or Wait(seconds=1.0)
