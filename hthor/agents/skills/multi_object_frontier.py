"""The frontier robot in larger tasks than finding one object: explores, carries what it can, tells the rest."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hthor import rules
from hthor.agents.skills.audience import Audience
from hthor.agents.skills.explorer import Explorer, ObservedRoutes
from hthor.agents.skills.joint_carrying.carrier import Carrier
from hthor.agents.skills.knowledge import ObservedKnowledge
from hthor.agents.skills.manipulation import Manipulator
from hthor.agents.skills.message_timing import (
    MessageTiming,
    find_detection,
    help_carry_text,
    look_inside_text,
    sighting_text,
)
from hthor.agents.skills.right_of_way.passing import Passing
from hthor.agents.skills.right_of_way.yielding import Yielding
from hthor.agents.skills.task_allocation import TaskAllocation, can_do
from hthor.agents.skills.viewpoints import outline_distance
from hthor.types import Action, Briefing, Job, Motion, Observation, Place, Receipt, Send, ThingState, Vec3

if TYPE_CHECKING:
    from hthor.agents.skills.touring.tour import Tour

_MOST = 2
_LATER_S = 15.0


class MultiObjectFrontier:
    """One robot's policy for one trial; ``before`` is its tour in earlier phases, whose map it keeps."""

    def __init__(self, briefing: Briefing, before: Tour | None = None) -> None:
        self.briefing, self.jobs = briefing, briefing.todo
        self.seen = ObservedKnowledge() if before is None else before.seen
        self.explorer = Explorer(briefing.body) if before is None else before.explorer
        if before is not None:
            self.seen.begin_again()
            self.explorer.begin_again()
        routes = ObservedRoutes(self.explorer)
        self.yielding = Yielding(briefing, routes)
        self.passing = Passing(briefing, routes, self.yielding)
        self.manipulator = Manipulator(briefing.body, routes, self.yielding, briefing.tick_s)
        self.allocation = TaskAllocation(briefing, lambda here, place: math.dist(here, place[:2]))
        self.audience = Audience(self.allocation, briefing.tick_s)
        self.carrier = Carrier(briefing, routes, self.manipulator, self.allocation, waits=False)
        self.mine: Job | None = None
        self.placing: Place | None = None
        self._timings: dict[str, MessageTiming] = {}
        self._answers: dict[str, Receipt] = {}
        self._spoken = ""

    def act(self, observation: Observation) -> Action:
        """The next motion and message; as `hthor.types.Mind.act`."""
        self.explorer.see(observation)
        self.seen.note(observation)
        self.allocation.see(observation, self.seen)
        if observation.receipt is not None:
            self._answers[self._spoken] = observation.receipt
        self.audience.hear(observation, self.seen)
        if observation.idle:
            self._look_back(observation)
            self.mine = self._own(observation)
        say = self._say(observation)
        if not observation.idle:
            return Action(say=say)
        motion = self._motion(observation)
        self.yielding.note(observation, motion)
        self.placing = motion if isinstance(motion, Place) else None
        return Action(motion=motion, say=say)

    def unfinished(self) -> list[str]:
        """The objects of jobs that are not known to be done."""
        return [job.target for job in self.jobs if not self.seen.is_done(job)]

    def _motion(self, observation: Observation) -> Motion:
        if self.mine is not None and self.mine.hands > 1 and self.carrier.is_close(observation, self.seen, self.mine):
            self.explorer.drop()
            return self.carrier.motion(observation, self.seen, self.mine)
        explores = self.mine is None and self.explorer.is_on_the_way
        follower = self.explorer.follower if explores else self.manipulator.follower
        aside = self.passing.motion(observation, follower, is_free=False)
        if aside is None:
            aside = self.yielding.motion(observation)
        if aside is not None:
            return aside
        motion = None
        if self.mine is not None and self.mine.hands > 1:
            motion = self.carrier.motion(observation, self.seen, self.mine)
        elif self.mine is not None:
            motion = self.manipulator.motion(observation, self.seen, self.mine)
        elif "open" in self.briefing.body.capabilities and self._missing():
            motion = self._open(observation)
        if motion is None:
            return self.explorer.motion(observation)
        self.explorer.drop()
        return motion

    def _own(self, observation: Observation) -> Job | None:
        """The job it does itself now: that of the object it holds, or the first with a known object and destination."""
        holding = next((job for job in self.jobs if job.target == observation.holding), None)
        if holding is not None:
            return holding
        mine = [job for job in self.jobs if self._can(observation, job)]
        if self.mine in mine:
            return self.mine
        self.manipulator.drop()
        return mine[0] if mine else None

    def _can(self, observation: Observation, job: Job) -> bool:
        state = self._waits(job)
        if state is None or job.relation == "find" or not self.manipulator.can_try(job.target, observation.tick):
            return False
        shut = self.seen.is_shut(state.support)
        return can_do(self.briefing.body, state.kind, job, shut) and (job.hands > 1 or bool(self.seen.bearers(job)))

    def _waits(self, job: Job) -> ThingState | None:
        """The job's object, if it was seen, nobody holds it, and it is not where it belongs."""
        state = self.seen.states.get(job.target)
        return None if state is None or state.held_by or self.seen.is_done(job) else state

    def _look_back(self, observation: Observation) -> None:
        """After the last motion: leave a misplaced object alone, and forget an object that was not there."""
        job, outcome, placed = self.mine, observation.outcome, self.placing
        if job is None or outcome is None:
            return
        if placed is not None and outcome.motion == "place" and outcome.ok:
            self.seen.put(job.target, placed)
            if not self.seen.is_done(job):
                self.manipulator.leave(job.target, observation.tick + round(_LATER_S / self.briefing.tick_s))
        elif not observation.holding and not self.manipulator.can_try(job.target, observation.tick):
            self.seen.forget(job.target)

    def _open(self, observation: Observation) -> Motion | None:
        """Open furniture while an object is still missing."""
        motions = (self.manipulator.open(observation, thing) for thing in self.seen.shut())
        return next((motion for motion in motions if motion is not None), None)

    def _missing(self) -> list[Job]:
        """The jobs whose objects have never been seen."""
        return [job for job in self.jobs if job.target not in self.seen.states]

    def _say(self, observation: Observation) -> Send | None:
        """A message about an object in view that it does not carry itself, or about a door that it cannot open."""
        if self.seen.all_hold(self.allocation.people):
            return None
        if self.mine is not None and self.mine.hands > 1:
            return self._ask_for_help(observation, self.mine)
        for job in self.jobs:
            seen = find_detection(observation, job.target)
            if seen is None or seen.held_by or job is self.mine or self.seen.is_done(job):
                continue
            if self._is_due(observation, job.target):
                kinds = {thing.id: thing.kind for thing in self.seen.things.values()}
                return self._note(observation, job.target, sighting_text(seen, kinds), seen.id, seen.position, job)
        return self._ask(observation)

    def _ask_for_help(self, observation: Observation, job: Job) -> Send | None:
        """Ask for somebody to take the other end, until the thing is lifted."""
        state, name = self.seen.states[job.target], f"help {job.target}"
        if observation.holding != job.target or state.held_by or not self._is_due(observation, name):
            return None
        return self._note(observation, name, help_carry_text(state.kind, held=True), job.target, state.position, job)

    def _ask(self, observation: Observation) -> Send | None:
        """Ask the person to look inside, in front of a closed door that it cannot open, while an object is missing."""
        missing = self._missing()
        if not missing or "open" in self.briefing.body.capabilities:
            return None
        here = (observation.pose.x, observation.pose.y)
        in_view = {seen.id for seen in observation.detections}
        for thing in self.seen.shut():
            is_near = outline_distance(thing, here) <= rules.DETECTOR_RANGE_M
            if is_near and thing.id in in_view and self._is_due(observation, thing.id):
                text = look_inside_text(thing.kind, tuple(_kind(job.target) for job in missing))
                return self._note(observation, thing.id, text, thing.id, thing.centre, missing[0])
        return None

    def _is_due(self, observation: Observation, name: str) -> bool:
        timing = self._timings.setdefault(name, MessageTiming(self.briefing, most=_MOST))
        return timing.due(observation.tick, self._answers.get(name))

    def _note(self, observation: Observation, name: str, text: str, about: str, position: Vec3, job: Job) -> Send:
        self._timings[name].note(observation.tick)
        self._spoken = name
        to = self.audience.choose(job, self.seen)
        self.audience.note(to, job)
        return Send(text=text, object=about, position=position, to=to)


def _kind(target: str) -> str:
    """The kind of an object that was never seen, by its id: "apple_2" is an apple."""
    return target.rstrip("0123456789").rstrip("_")
