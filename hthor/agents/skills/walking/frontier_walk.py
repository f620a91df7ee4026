"""The frontier robot where somebody has to go to a landmark: explores, follows instructions, tells what it finds."""

import math

from hthor.agents.skills.explorer import Explorer
from hthor.agents.skills.message_timing import APART_M, ASIDE_M
from hthor.agents.skills.walking.instructed_exploration import InstructedExplorer
from hthor.agents.skills.walking.landmark_messages import LandmarkMessages
from hthor.geometry.plane import distance_to_rectangle
from hthor.navigation.path_follower import Courtesy, face
from hthor.types import Action, Briefing, Detection, Motion, Observation, Wait

_BESIDE_M = 0.7
"""How near [m] the robot goes to the landmark's edge before it stops. Our choice: well within the goal's 1 m."""


class FrontierWalk:
    """One robot's policy for one trial: to walk itself, if it is the walker, or to tell the person who walks."""

    def __init__(self, briefing: Briefing) -> None:
        self.briefing, self.messages = briefing, LandmarkMessages(briefing)
        own = self.messages.walks_itself
        self.explorer = InstructedExplorer(briefing.body, briefing.instruction) if own else Explorer(briefing.body)
        self.courtesy = Courtesy(briefing.body, self.explorer.fits)
        self.stands_aside = False
        self._takes_path = False

    def act(self, observation: Observation) -> Action:
        """The next motion and message; as `hthor.types.Mind.act`."""
        self.explorer.see(observation)
        self.messages.see(observation)
        say = self.messages.say(observation)
        if not observation.idle:
            return Action(say=say)
        return Action(motion=self._motion(observation), say=say)

    def unfinished(self) -> list[str]:
        """What people may ask for."""
        return self.messages.unfinished()

    def _motion(self, observation: Observation) -> Motion:
        landmark, own = self.messages.landmark, self.messages.walks_itself
        if landmark is not None and own and _edge_distance(landmark, observation) <= _BESIDE_M:
            return Wait(seconds=1.0)
        aside = self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)
        if aside is not None:
            return aside
        if landmark is None:
            return self.explorer.motion(observation)
        return self._approach(observation, landmark) if own else self._watch(observation, landmark)

    def _approach(self, observation: Observation, landmark: Detection) -> Motion:
        """Go to the landmark's edge; explore on while the map shows no path."""
        pose, follower = observation.pose, self.explorer.follower
        if not self._takes_path or follower.done:
            within = _BESIDE_M + min(landmark.size[:2]) / 2.0
            path = self.explorer.planner.path((pose.x, pose.y), landmark.position[:2], within=within)
            self._takes_path = path is not None and len(path) > 1
            if not self._takes_path:
                return self.explorer.motion(observation)
            follower.take(path)
        step = follower.next(pose)
        self._takes_path = step is not None
        return step or self.explorer.motion(observation)

    def _watch(self, observation: Observation, landmark: Detection) -> Motion:
        """Wait where it blocks nobody, facing the landmark; come back when another message is due."""
        pose, (x, y, _) = observation.pose, landmark.position
        follower, body = self.explorer.follower, self.briefing.body
        due = self.messages.is_due(observation)
        if self.stands_aside and due:
            self.stands_aside = False
            follower.take(self.explorer.planner.path((pose.x, pose.y), (x, y), within=APART_M))
        elif not self.stands_aside and not due:
            self.stands_aside = True
            self.explorer.retreat(pose, (x, y), ASIDE_M)
        step = follower.next(pose)
        return step or face(pose, landmark.position, body.eye, body.pitch_limit) or Wait(seconds=1.0)


def _edge_distance(landmark: Detection, observation: Observation) -> float:
    """Distance [m] of the body's axis from the landmark's edge; infinite while a doorway may lie between."""
    pose, size = observation.pose, landmark.size
    apart = distance_to_rectangle((pose.x, pose.y), landmark.position[:2], size[:2], landmark.yaw)
    in_view = any(seen.id == landmark.id for seen in observation.detections)
    return apart if in_view or apart <= _BESIDE_M / 2 else math.inf
