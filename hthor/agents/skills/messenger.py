"""Shows the person where things are: goes where it can see them, then sends a message."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from hthor import rules
from hthor.agents.skills.knowledge import PAPER_KINDS, Knowledge
from hthor.agents.skills.message_timing import (
    ASIDE_M,
    MessageTiming,
    find_detection,
    help_carry_text,
    kind_title,
    look_inside_text,
    place_phrase,
    sighting_text,
)
from hthor.geometry import plane
from hthor.types import (
    Briefing,
    Job,
    Motion,
    Observation,
    Receipt,
    Send,
    Thing,
    ThingState,
    Vec2,
    Vec3,
    Wait,
    is_person,
)

if TYPE_CHECKING:
    from hthor.agents.skills.audience import Audience
    from hthor.agents.skills.right_of_way.yielding import Yielding
    from hthor.agents.skills.routes import HouseRoutes
    from hthor.navigation.path_follower import Follower

_LOOKS = 3
"""How many places to look from before saying that the target must be in it: a low camera cannot see into a sink."""
_MOST = {"target": 3, "destination": 1, "help": 4, "done": 1}
_HELP_AGAIN_S = 40.0
"""How long to wait for a helper before asking again [s]: the longest way of a load, 14 m, at the 0.4 m/s of people."""
_UNANSWERED_S, _ACCEPTED_S = 8.0, 20.0
"""How long to stay with an object after a message [s]: without an answer, and once the person has accepted."""


class Messenger:
    """Tells the person about one job at a time: about the object, and once they hold it, about its destination.

    It speaks only when close enough to detect the thing; for a thing behind a closed door, at the door.
    """

    def __init__(
        self,
        briefing: Briefing,
        routes: HouseRoutes,
        follower: Follower,
        knowledge: Knowledge,
        yielding: Yielding | None,
        audience: Audience,
    ) -> None:
        """``yielding`` is None for a single job, as in the paper."""
        self.briefing, self.routes, self.follower = briefing, routes, follower
        self.knowledge, self.yielding, self.several = knowledge, yielding, yielding is not None
        self.audience = audience
        self.kinds = {thing.id: thing.kind for thing in knowledge.things.values()}
        self._timings: dict[tuple[str, str], MessageTiming] = {}
        self._answers: dict[tuple[str, str], Receipt] = {}
        self.spoken_about = ("", "")
        self.target = ""
        self._looked: dict[str, tuple[Vec3, list[Vec2]]] = {}
        self._forget_goal()

    def _forget_goal(self) -> None:
        self.goal: Vec3 | None = None
        self.misses: list[Vec2] = []
        self.aside = ""

    def take(self, job: Job) -> None:
        """Turn to a job, unless it is the current one."""
        if job.target != self.target:
            if self.goal is not None:
                self._looked[self.target] = (self.goal, self.misses)
            self.target = job.target
            self._forget_goal()
            self.follower.take(None)

    def timing(self, job: Job, topic: str) -> MessageTiming:
        """When to speak about the job's "target", "destination", "help" or "done"."""
        repeat_s = _HELP_AGAIN_S if topic == "help" else math.inf
        return self._timings.setdefault((job.target, topic), MessageTiming(self.briefing, _MOST[topic], repeat_s))

    def hear(self, observation: Observation) -> None:
        """Keep the answer to the last message."""
        if self.several and observation.receipt is not None:
            self._answers[self.spoken_about] = observation.receipt
        self.audience.hear(observation, self.knowledge)

    def waits(self, observation: Observation, job: Job) -> bool:
        """Whether the person may still act on the message about this job, or has not been sent one."""
        if self.timing(job, "target").sent == 0:
            return True
        answer = self._answers.get((job.target, "target"))
        if answer is None:
            return False
        accepted = 0.0 if self.audience.has_somebody_else(job, self.knowledge) else _ACCEPTED_S
        patience = {"sent": _UNANSWERED_S, "shown": _UNANSWERED_S, "accepted": accepted}.get(answer.status, 0.0)
        return observation.tick < answer.tick + patience / self.briefing.tick_s

    def is_due(self, observation: Observation, job: Job, topic: str = "target") -> bool:
        """Whether a message about the job is due."""
        key = (job.target, topic)
        receipt = observation.receipt if self.spoken_about == key else self._answers.get(key)
        return self.timing(job, topic).due(observation.tick, receipt)

    def is_exhausted(self, job: Job) -> bool:
        """Whether the largest number of messages about the object was sent."""
        return self.timing(job, "target").sent >= _MOST["target"]

    def topic(self, job: Job) -> tuple[str, Vec3]:
        """The topic to show now, "target" or "destination", and its position [m]."""
        target = self.knowledge.states[job.target]
        if is_person(target.held_by):
            where = self._belongs(job, target)
            if where is not None:
                return "destination", where[1]
        return "target", target.position

    def _belongs(self, job: Job, target: ThingState) -> tuple[Thing, Vec3] | None:
        """The destination nearest to the object by walking distance, and the point to show [m]."""
        things = self.knowledge.bearers(job)
        if not things:
            return None
        here = (target.position[0], target.position[1])
        thing = min(things, key=lambda thing: (self.routes.near(here, thing.centre), thing.id))
        return thing, thing.centre if job.place is None else job.place

    def say(self, observation: Observation, job: Job) -> Send | None:
        """A message about the current job, when one is due and the thing in question is near."""
        topic, where = self.topic(job)
        if not self.is_due(observation, job, topic):
            return None
        target = self.knowledge.states[job.target]
        if topic == "destination":
            message = self._destined(observation, job, target, where)
        else:
            message = self._found(observation, target, job)
        return self._note(observation, job, topic, message)

    def in_view(self, observation: Observation, jobs: Sequence[Job]) -> list[Job]:
        """The jobs whose objects are in view and in nobody's hand, and about which a message is due."""
        seen = {thing.id for thing in observation.detections if thing.family == "object" and not thing.held_by}
        return [job for job in jobs if job.target in seen and self.is_due(observation, job)]

    def mention(self, observation: Observation, job: Job) -> Send | None:
        """A message about an object in view."""
        seen = find_detection(observation, job.target)
        assert seen is not None
        message = Send(
            text=sighting_text(seen, self.kinds), object=seen.id, position=seen.position, to=self._listener(job)
        )
        return self._note(observation, job, "target", message)

    def ask_for_help(self, observation: Observation, job: Job) -> Send | None:
        """A request to take the other end of a thing that is too heavy for one body."""
        state = self.knowledge.states[job.target]
        if not self.is_due(observation, job, "help"):
            return None
        text = help_carry_text(state.kind, self.briefing.seat in state.bearers)
        message = Send(text=text, object=state.id, position=state.position, to=self._listener(job))
        return self._note(observation, job, "help", message)

    def report(self, observation: Observation, job: Job) -> Send | None:
        """A report that an object is where it belongs, so that nobody searches for it."""
        state = self.knowledge.states[job.target]
        thing = self.knowledge.things.get(state.support)
        if thing is None or not self.is_due(observation, job, "done"):
            return None
        text = f"I put {kind_title(state.kind)} {place_phrase(thing.kind)}."
        return self._note(observation, job, "done", Send(text=text, object=state.id, position=state.position))

    def _note(self, observation: Observation, job: Job, topic: str, message: Send | None) -> Send | None:
        if message is not None:
            self.timing(job, topic).note(observation.tick)
            self.spoken_about = (job.target, topic)
            self.audience.note(message.to, job)
        return message

    def _listener(self, job: Job) -> str:
        """The person to tell about the job; everybody ("") if it is the only job there is."""
        return self.audience.choose(job, self.knowledge) if self.several else ""

    def _found(self, observation: Observation, target: ThingState, job: Job) -> Send | None:
        to, seen = self._listener(job), find_detection(observation, target.id)
        if seen is not None and not is_person(seen.held_by):
            return Send(text=sighting_text(seen, self.kinds), object=seen.id, position=seen.position, to=to)
        support = self.knowledge.things.get(target.support)
        if support is None or not self._is_close(observation, support):
            return None
        shut = self.knowledge.is_shut(support.id)
        if len(self.misses) < _LOOKS and not shut:
            return None
        text = f"{kind_title(target.kind).capitalize()} is {place_phrase(support.kind)}."
        if shut and self.briefing.kind not in PAPER_KINDS and "open" not in self.briefing.body.capabilities:
            text = look_inside_text(support.kind, (target.kind,))
        return Send(text=text, object=target.id, position=target.position, to=to)

    def _destined(self, observation: Observation, job: Job, target: ThingState, where: Vec3) -> Send | None:
        found = self._belongs(job, target)
        if found is None or not self._is_close(observation, found[0]):
            return None
        text, to = (
            f"{kind_title(found[0].kind).capitalize()} is here.",
            target.held_by if len(self.audience.allocation.people) > 1 else "",
        )
        return Send(text=text, object=found[0].id, position=where, to=to)

    def _is_close(self, observation: Observation, thing: Thing) -> bool:
        """Whether the robot is within the detector's range of a thing's outline, in the same room."""
        here = (observation.pose.x, observation.pose.y)
        apart = plane.distance_to_rectangle(
            here, (thing.centre[0], thing.centre[1]), (thing.size[0], thing.size[1]), thing.yaw
        )
        return apart <= rules.DETECTOR_RANGE_M and self.routes.same_room(here, thing.centre)

    def motion(self, observation: Observation, job: Job) -> Motion:
        """Walk to where the place is in range, face it, then stand aside; try another spot if it is not seen."""
        from hthor.navigation.path_follower import face

        topic, where = self.topic(job)
        if self.goal is None or math.dist(self.goal, where) > 0.3:
            goal, misses = self._looked.get(job.target, (where, []))
            self.goal, self.misses = where, misses if math.dist(goal, where) <= 0.3 else []
            self._route(observation, where)
        elif self.aside == topic and self.is_due(observation, job, topic):
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
        unsaid = self.is_due(observation, job, topic) if self.several else self.timing(job, topic).sent == 0
        if unsaid and len(self.misses) < 2 * _LOOKS:
            self.misses.append((observation.pose.x, observation.pose.y))
            self._route(observation, where)
            return self.follower.next(observation.pose) or Wait(seconds=0.5)
        return self.stand_aside(observation, where, topic)

    def _route(self, observation: Observation, where: Vec3) -> None:
        here = (observation.pose.x, observation.pose.y)
        self.follower.take(self.routes.to_view(here, where, self.misses))

    def _reroute(self, observation: Observation, where: Vec3) -> None:
        """After a stop on the way: go round the body that stands there, or back off from a tight corner."""
        here, goal = (observation.pose.x, observation.pose.y), self.follower.goal
        if self.yielding is not None and goal is not None:
            way = self.yielding.around(observation, goal)
            if way:
                self.follower.take(way)
                return
        people = [seen.position for seen in observation.detections if seen.family == "person"]
        via = self.routes.around(here, where, people) if people else here
        via = self.routes.clear(here) if via == here else via
        self.follower.take((via, *self.routes.to_view(via, where, self.misses)))

    def stand_aside(self, observation: Observation, where: Vec3, topic: str) -> Motion:
        """Go to a spot where the robot blocks nobody, once."""
        if self.aside == topic:
            return Wait(seconds=0.5)
        self.aside = topic
        here = (observation.pose.x, observation.pose.y)
        self.follower.take(self.routes.retreat(here, (where[0], where[1]), ASIDE_M))
        return self.follower.next(observation.pose) or Wait(seconds=0.5)
