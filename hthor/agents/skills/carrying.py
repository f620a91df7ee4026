"""Carries a thing that is too heavy for one body, together with another robot or a person.

They hold it by the handles at its ends. Once they are strong enough together, the body that moves pulls the thing and
the others along like a trailer. The thing is put down as soon as one body lets go.
"""

import math
from typing import Protocol

from hthor.agents.skills import viewpoints
from hthor.agents.skills.knowledge import Knowledge
from hthor.agents.skills.leading import Leadership
from hthor.agents.skills.manipulation import ManipulationGoal, Manipulator, whole_tick_move
from hthor.agents.skills.right_of_way.yielding import seat_bumped
from hthor.agents.skills.task_allocation import TaskAllocation, can_do
from hthor.agents.skills.viewpoints import Routes
from hthor.geometry import plane
from hthor.navigation.path_follower import Follower, face, shift
from hthor.navigation.planner import path_length
from hthor.types import HUMAN, Briefing, Drop, Job, Motion, Observation, Pick, ThingState, Vec2, Vec3, Wait, is_person

_THERE_M = 0.45
"""The thing is put down this close to its place [m]."""
_ENOUGH_M = 0.7
"""The same distance [m] for a thing that does not get closer."""
_PAST_M = (0.9, 0.6, 0.3, 0.0)
"""How far past the place the leader goes [m], so that the thing behind it ends up there."""
_BESIDE_M, _BY_M, _ASIDE_M = 0.12, 1.4, 1.2
_AIMS = 24
_STUCK = 4
"""After so many blocked moves in a row, another body may lead for a while."""
_REST_S = 6.0
_NOWHERE = ("", 0.0, 0.0)


class TowingRoutes(Routes, Protocol):
    """Routes that also serve a body that pulls something along."""

    def broad(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]: ...


class Carrier:
    """One body's part in carrying one thing; with ``waits`` it lets a person take hold first."""

    def __init__(
        self,
        briefing: Briefing,
        routes: TowingRoutes,
        manipulator: Manipulator,
        allocation: TaskAllocation,
        waits: bool = True,
    ) -> None:
        self.briefing, self.body, self.routes = briefing, briefing.body, routes
        self.manipulator, self.allocation = manipulator, allocation
        self.follower = Follower(step=whole_tick_move(briefing.body, briefing.tick_s))
        self._waits = waits
        self._yaw: float | None = None
        self._half = 0.4
        self._parked = self._squeezed = False
        self._goal = _NOWHERE
        self._leadership = Leadership(briefing.tick_s, allocation.place, self._way_length)
        self._stuck, self._until, self._number = 0, -1, 0

    def is_close(self, observation: Observation, knowledge: Knowledge, job: Job) -> bool:
        """Whether the body holds the thing or is near it; if so, others come to help, and nobody makes way."""
        here, place = (observation.pose.x, observation.pose.y), knowledge.states[job.target].position
        return observation.holding == job.target or math.dist(here, place[:2]) < _BY_M

    def motion(self, observation: Observation, knowledge: Knowledge, job: Job) -> Motion:
        """The next motion of this job."""
        state = knowledge.states[job.target]
        self._look(observation, job)
        if observation.holding != job.target:
            return self._approach(observation, state, job)
        if not state.held_by:
            return self._attend(observation, state)
        place = job.place or self._room(knowledge, job, state)
        if place is None or self._leadership.leader(observation.tick, state, place) != self.briefing.seat:
            self._goal, self._until = _NOWHERE, -1
            return Wait(seconds=0.3)
        return self._lead(observation, state, place)

    def _look(self, observation: Observation, job: Job) -> None:
        """Note the orientation and length of the thing."""
        for seen in observation.detections:
            if seen.id == job.target:
                self._yaw, self._half = seen.yaw, seen.size[0] / 2

    def _approach(self, observation: Observation, state: ThingState, job: Job) -> Motion:
        """Go to a handle and take it, if possible from the outer side of the thing.

        A person chooses an end first: a robot at that end might block them.
        """
        if self._waits and not state.bearers and self._counts_on_person(state, job):
            return self._await(observation, state)
        handle = self._handle(state)
        out = math.atan2(handle[1] - state.position[1], handle[0] - state.position[0])
        apart = self.body.radius + _BESIDE_M
        stand = (handle[0] + apart * math.cos(out), handle[1] + apart * math.sin(out), handle[2])
        if seat_bumped(observation) and not self._squeezed:
            self._squeezed = True
            self.manipulator.drop()
        free = self._yaw is not None and not self._squeezed
        pick = ManipulationGoal(job.target, (handle,), Pick(object=job.target), stand=stand if free else None)
        return self.manipulator.pursue(observation, pick) or Wait(seconds=0.3)

    def _counts_on_person(self, state: ThingState, job: Job) -> bool:
        """Whether a person is needed because there are too few robots with arms."""
        bodies = self.allocation.bodies.items()
        robots = [seat for seat, body in bodies if not is_person(seat) and can_do(body, state.kind, job)]
        return bool(self.allocation.people) and len(robots) < job.hands

    def _await(self, observation: Observation, state: ThingState) -> Motion:
        """Come near, then wait where it blocks nobody, facing the thing."""
        here, place = (observation.pose.x, observation.pose.y), state.position
        goal = ("await", round(place[0], 1), round(place[1], 1))
        outcome = observation.outcome
        stopped = outcome is not None and not outcome.ok and outcome.motion == "move"
        if goal != self._goal or stopped:
            self._goal, self._parked = goal, False
            start = self.routes.loose(here) if stopped and not seat_bumped(observation) else here
            way = viewpoints.path_to_reach(self.routes, start, (place,), _BY_M, but=[here] if stopped else [])
            self.follower.take((start, *way) if way else ())
        step = self.follower.next(observation.pose)
        if step is None and not self._parked:
            self._parked = True
            self.follower.take(self.routes.retreat(here, place[:2], _ASIDE_M))
            step = self.follower.next(observation.pose)
        return step or self._attend(observation, state)

    def _handle(self, state: ThingState) -> Vec3:
        """The free handle, of two the one farther from the nearest person; the middle until its heading is seen."""
        if self._yaw is None:
            return state.position
        ends = [plane.to_house((side * self._half, 0.0, 0.0), state.position, self._yaw) for side in (1.0, -1.0)]
        others = [self.allocation.place(seat) for seat in state.bearers if seat != self.briefing.seat]
        if others:
            return max(ends, key=lambda end: round(math.dist(end[:2], others[0]), 3))
        places = [self.allocation.place(seat) for seat in self.allocation.people or (HUMAN,)]
        person = min(places, key=lambda place: math.dist(place, state.position[:2]))
        way = self.routes.way(person, self.routes.loose(state.position[:2]))
        last = way[-2] if len(way) > 1 else person
        return max(ends, key=lambda end: round(math.dist(end[:2], last), 3))

    def _attend(self, observation: Observation, state: ThingState) -> Motion:
        """Face the thing and wait for another body to take the other end."""
        turn = face(observation.pose, state.position, self.body.eye, self.body.pitch_limit)
        return turn if turn is not None and abs(turn.yaw) > 0.2 else Wait(seconds=0.5)

    def _way_length(self, here: Vec2, spot: Vec2) -> float:
        way = self.routes.way(here, self.routes.loose(spot))
        return path_length(way) if way else math.inf

    def _lead(self, observation: Observation, state: ThingState, place: Vec3) -> Motion:
        """Pull the thing to its place and put it down there."""
        here, outcome = (observation.pose.x, observation.pose.y), observation.outcome
        apart = math.dist(state.position[:2], place[:2])
        if apart < _THERE_M:
            return Drop()
        if observation.tick < self._until:
            return Wait(seconds=0.3)
        goal = ("lead", round(place[0], 1), round(place[1], 1))
        stopped = outcome is not None and not outcome.ok and outcome.motion == "move"
        self._stuck = self._stuck + 1 if stopped else 0
        if goal != self._goal:
            self._goal, self._number = goal, 0
            self.follower.take(self._course(here, state, place))
        elif stopped:
            return self._free(observation, state, place)
        step = self.follower.next(observation.pose)
        if step is not None:
            return step
        self._number += 1
        if apart < _ENOUGH_M or self._number > _AIMS:
            return Drop()
        self.follower.take(self._course(here, state, place))
        return self.follower.next(observation.pose) or Wait(seconds=0.3)

    def _course(self, here: Vec2, state: ThingState, place: Vec3) -> tuple[Vec2, ...]:
        """The path to the place and past it, in line with the thing at first, from other sides if that failed."""
        way = self.routes.broad(here, place[:2])
        before = way[-2] if len(way) > 1 and self._number == 0 else state.position[:2]
        angle = math.atan2(place[1] - before[1], place[0] - before[0]) + _swing(self._number)
        for past in _PAST_M:
            end = (place[0] + past * math.cos(angle), place[1] + past * math.sin(angle))
            if self.routes.stands(end) and (past == 0.0 or self.routes.fits(place[:2], end)):
                return self.routes.broad(here, end)
        return way

    def _free(self, observation: Observation, state: ThingState, place: Vec3) -> Motion:
        """After a blocked move: swing to a side; after several tries, let the others lead."""
        here = (observation.pose.x, observation.pose.y)
        if self._stuck >= _STUCK:
            self._stuck = 0
            self._until = observation.tick + round(_REST_S / self.briefing.tick_s)
            self.follower.take(self._course(here, state, place))
            return Wait(seconds=0.3)
        ahead = self.follower.ahead or place[:2]
        angle = math.atan2(ahead[1] - here[1], ahead[0] - here[0]) + (0.0, 1.0, -1.0, 2.2)[self._stuck % 4]
        spot = (here[0] + 0.3 * math.cos(angle), here[1] + 0.3 * math.sin(angle))
        self.follower.take((spot, *self._course(spot, state, place)) if self.routes.fits(here, spot) else None)
        return shift(observation.pose, spot, 0.3)

    def _room(self, knowledge: Knowledge, job: Job, state: ThingState) -> Vec3 | None:
        """The middle of the room that the thing belongs in, for a job without a place."""
        rooms = [knowledge.rooms[name] for name in job.destinations if name in knowledge.rooms]
        if not rooms:
            return None
        corners = rooms[0].polygon
        x, y = (sum(corner[axis] for corner in corners) / len(corners) for axis in (0, 1))
        return (x, y, state.position[2])


def _swing(number: int) -> float:
    """Angle of a try [rad]: 0 for the first, then to alternating sides, ever farther."""
    return (1 if number % 2 else -1) * 0.5 * ((number + 1) // 2)
