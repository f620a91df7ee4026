"""The frontier robot of the paper: explores with a short-range detector, and tells the person what it finds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hthor.agents.skills.conversation.conversation import Conversation
from hthor.agents.skills.knowledge import PAPER_KINDS
from hthor.agents.skills.message_timing import APART_M, ASIDE_M, MessageTiming, find_detection, sighting_text
from hthor.types import Action, Briefing, Detection, Motion, Observation, Send, Wait, is_person

if TYPE_CHECKING:
    from hthor.agents.skills.explorer import Explorer
    from hthor.agents.skills.multi_object_frontier import MultiObjectFrontier
    from hthor.agents.skills.touring.tour import Tour
    from hthor.agents.skills.walking.frontier_walk import FrontierWalk
    from hthor.navigation.path_follower import Courtesy


class Agent:
    """Frontier exploration with an ideal detector within 1.5 m.

    When it sees the target, it tells the person once where that is, and again ten seconds after a declined message.
    Then it watches the target from a place where it blocks nobody. It answers questions from what it has seen so far.
    If the task begins with a tour, it explores the house and records where the objects of the task are.
    """

    privileges = ("ideal_detector",)
    robots: tuple[str, ...] = ()
    asks = False
    """Whether it asks what became of its suggestions."""

    def begin(self, briefing: Briefing) -> None:
        """Start with an empty map."""
        self.tour: Tour | None = _tour(briefing) if briefing.phases else None
        if self.tour is None:
            self._begin_task(briefing)
        else:
            self.conversation = Conversation(briefing, self.tour.unfinished, self.asks)

    def _begin_task(self, briefing: Briefing) -> None:
        from hthor.agents.skills.explorer import Explorer
        from hthor.navigation.path_follower import Courtesy, face

        self.briefing = briefing
        self.multi_object: MultiObjectFrontier | FrontierWalk | None = None
        self.conversation = Conversation(briefing, self._unfinished, self.asks)
        if briefing.relation == "go":
            from hthor.agents.skills.walking.frontier_walk import FrontierWalk

            self.multi_object = FrontierWalk(briefing)
            return
        carries = "pick" in briefing.body.capabilities and briefing.relation != "find"
        if carries or briefing.kind not in PAPER_KINDS:
            from hthor.agents.skills.multi_object_frontier import MultiObjectFrontier

            self.multi_object = MultiObjectFrontier(briefing, self.tour)
            return
        self.timing = MessageTiming(briefing, most=2)
        self.explorer: Explorer = Explorer(briefing.body)
        self.courtesy: Courtesy = Courtesy(briefing.body, self.explorer.fits)
        self.face = face
        self.target: Detection | None = None
        self.stands_aside = False

    def act(self, observation: Observation) -> Action:
        """Update the map, tell people what is in view, answer their questions, and move on."""
        if self.tour is not None and not observation.phase:
            self._begin_task(self.tour.briefing_after())
            self.tour = None
        heard = self.conversation.hear(observation)
        if self.tour is not None:
            return self.conversation.speak(heard, self.tour.act(heard))
        action = self._search(heard) if self.multi_object is None else self.multi_object.act(heard)
        return self.conversation.speak(heard, action)

    def _unfinished(self) -> Sequence[str]:
        return (self.briefing.target,) if self.multi_object is None else self.multi_object.unfinished()

    def _search(self, observation: Observation) -> Action:
        """The next motion and message in a task with one object to find."""
        self.explorer.see(observation)
        seen = find_detection(observation, self.briefing.target)
        if seen is not None:
            self.target = seen
        say = self._say(observation, seen)
        if not observation.idle:
            return Action(say=say)
        seconds = observation.tick * self.briefing.tick_s
        aside = self.courtesy.motion(observation, seconds)
        if aside is not None:
            return Action(motion=aside, say=say)
        return Action(motion=self._watch(observation) if self.target else self.explorer.motion(observation), say=say)

    def _say(self, observation: Observation, seen: Detection | None) -> Send | None:
        """A message, when the target is in view, the person does not hold it, and a message is due."""
        if seen is None or is_person(seen.held_by) or not self.timing.due(observation.tick, observation.receipt):
            return None
        self.timing.note(observation.tick)
        return Send(
            text=sighting_text(seen, self.conversation.sightings.kinds()), object=seen.id, position=seen.position
        )

    def _watch(self, observation: Observation) -> Motion:
        """Wait where it blocks nobody, facing the target; come back when another message is due."""
        assert self.target is not None
        pose, (x, y, _) = observation.pose, self.target.position
        follower, body = self.explorer.follower, self.briefing.body
        speaking = not is_person(self.target.held_by) and self.timing.due(observation.tick, observation.receipt)
        if self.stands_aside and speaking:
            self.stands_aside = False
            follower.take(self.explorer.planner.path((pose.x, pose.y), (x, y), within=APART_M))
        elif not self.stands_aside and not speaking:
            self.stands_aside = True
            self.explorer.retreat(pose, (x, y), ASIDE_M)
        step = follower.next(pose)
        return step or self.face(pose, self.target.position, body.eye, body.pitch_limit) or Wait(seconds=1.0)


def _tour(briefing: Briefing) -> Tour:
    from hthor.agents.skills.touring.tour import Tour

    return Tour(briefing)
