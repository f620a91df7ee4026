"""Carries a thing that is too heavy for one body, together with another robot or a person.

They hold it by the handles at its ends. Once they are strong enough together, the body that moves pulls the thing and
the others along like a trailer. The thing is put down as soon as one body lets go.
"""

import math

from hthor import catalog
from hthor.agents.skills import viewpoints
from hthor.agents.skills.joint_carrying.handle_choice import HandleChoice
from hthor.agents.skills.joint_carrying.leadership import Leadership
from hthor.agents.skills.joint_carrying.towing import Towing, TowingRoutes
from hthor.agents.skills.knowledge import Knowledge
from hthor.agents.skills.manipulation import ManipulationGoal, Manipulator, whole_tick_move
from hthor.agents.skills.right_of_way.yielding import seat_bumped
from hthor.agents.skills.routes_around import RoutesAround, discs_around
from hthor.agents.skills.task_allocation import TaskAllocation, can_do, seat_order
from hthor.navigation.detours import Disc
from hthor.navigation.path_follower import Follower, face
from hthor.navigation.planner import path_length
from hthor.types import (
    HUMAN,
    Briefing,
    Drop,
    Job,
    Motion,
    Observation,
    Pick,
    Room,
    Rotate,
    ThingState,
    Vec2,
    Vec3,
    Wait,
    is_person,
)

_BY_M, _ASIDE_M = 1.4, 1.2
"""A body this near to the thing is at it [m]; how far from it to wait [m]."""
_BEFORE_M = 0.7
"""The least distance from which the body looks at the thing [m]."""
_MARGIN_M = 0.05
"""Room left between the body and others at the thing [m]."""
_CROWD_M = 3.0
"""A body within this distance [m] of a thing that a person holds makes no way for them: they stay where they are."""
_LOOK_SHARE = 0.8
"""Share of its field of view by which a body turns at a time while it holds an end and looks for helpers."""
_VAIN_S = 12.0
"""How long to hold an end while another body beside the thing does not take the other [s]."""


class Carrier:
    """One body's part in carrying one thing.

    The first to come takes an end that leaves the others a way to the other end; where no end does, it waits out of the
    way until a person has taken one, if it ``waits`` for people at all. The body in front leads. When the thing is
    stuck, they put it down and take hold of it again.
    """

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
        step = whole_tick_move(briefing.body, briefing.tick_s)
        self.follower, self._towing = Follower(step=step), Towing(routes, step, briefing.tick_s)
        self._waits = waits
        self._yaw: float | None = None
        self._half = 0.4
        self._parked = self._squeezed = False
        self._vain = 0
        self._beside: list[int] = []  # ticks at which another body was seen while an end was held in vain
        self._awaited: Vec2 | None = None
        rooms = [_middle(room) for room in briefing.house.rooms] if briefing.house is not None else []
        self._choice = HandleChoice(briefing.body, routes, self._way_length, rooms)
        self._leadership = Leadership(briefing.tick_s, allocation.place, self._way_length)

    def is_close(self, observation: Observation, knowledge: Knowledge, job: Job) -> bool:
        """Whether the body holds the thing or is near it; if so, others come to help, and nobody makes way."""
        here, state = (observation.pose.x, observation.pose.y), knowledge.states[job.target]
        near = _CROWD_M if any(is_person(seat) for seat in state.bearers) else _BY_M
        return observation.holding == job.target or math.dist(here, state.position[:2]) < near

    def needs_helper(self, observation: Observation, knowledge: Knowledge, job: Job) -> bool:
        """Whether the body is at the thing, or waits near it, and no person has taken hold."""
        state = knowledge.states[job.target]
        if state.held_by or any(is_person(seat) for seat in state.bearers):
            return False
        return self._parked or self.is_close(observation, knowledge, job)

    def motion(self, observation: Observation, knowledge: Knowledge, job: Job) -> Motion:
        """The next motion of this job."""
        state = knowledge.states[job.target]
        self._look(observation, job)
        place = job.place or _middle_of_destination(knowledge, job, state)
        if observation.holding != job.target:
            return self._approach(observation, state, job, place)
        if not state.held_by:
            return self._hold(observation, state, place)
        return Wait(seconds=0.3) if place is None else self._carry(observation, state, place)

    def _carry(self, observation: Observation, state: ThingState, place: Vec3) -> Motion:
        """Lead or follow; put the thing down at its place, or when it is stuck."""
        leader = self._leadership.leader(observation.tick, state, place)
        still_s = self._leadership.standstill(observation.tick) * self.briefing.tick_s
        if self._towing.is_there(state, place, still_s):
            return Drop()
        if self._leadership.is_stuck:
            self._towing.rest()
            self._leadership.forget()
            self._squeezed = False
            return Drop()
        if leader == self.briefing.seat:
            return self._towing.lead(observation, state, place)
        self._towing.rest()
        return Wait(seconds=0.3)

    def _look(self, observation: Observation, job: Job) -> None:
        """Note the orientation and length of the thing."""
        for seen in observation.detections:
            if seen.id == job.target:
                self._yaw, self._half = seen.yaw, seen.size[0] / 2

    def _approach(self, observation: Observation, state: ThingState, job: Job, place: Vec3 | None) -> Motion:
        """Go to a handle and take it, if possible from the outer side of the thing."""
        handle, others = self._handle(state), self._others_at(state)
        if not state.bearers and not others:
            first = self._first_ends(state, place)
            waits = self._waits and not first and self._counts_on_person(state, job)
            if waits or self._another_goes_first(state, job):
                return self._await(observation, state)
            handle = first[self._vain % len(first)] if first else handle
        if seat_bumped(observation) and not self._squeezed:
            self._squeezed = True
            self.manipulator.drop()
        free = self._yaw is not None and not self._squeezed
        stand = self._choice.stand(handle, state.position, self._outline(state)) if free else None
        avoid = (*self._outline(state), *others)
        pick = ManipulationGoal(job.target, (handle,), Pick(object=job.target), stand=stand, avoid=avoid)
        return self.manipulator.pursue(observation, pick) or Wait(seconds=0.3)

    def _outline(self, state: ThingState) -> tuple[Disc, ...]:
        """Discs that the body keeps out of in order to keep off the thing."""
        size = (2.0 * self._half, catalog.kind(state.kind).size[1])
        return discs_around(state.position, size, self._yaw, self.body.radius)

    def _first_ends(self, state: ThingState, place: Vec3 | None) -> tuple[Vec3, ...]:
        """The ends that may be taken before the others; none also until it is seen how the thing stands."""
        if self._yaw is None or place is None:
            return ()
        return self._choice.before_helper(self._ends(state), state.position, place, self._outline(state))

    def _another_goes_first(self, state: ThingState, job: Job) -> bool:
        """Whether another robot takes the first end."""
        return min(self._able_robots(state, job), key=seat_order, default=self.briefing.seat) != self.briefing.seat

    def _others_at(self, state: ThingState) -> tuple[Disc, ...]:
        """Whoever holds the thing, and people in view at it: they stay, so the way leads round them."""
        touching, places = self.manipulator.yielding.touching, self.allocation.places
        near = {seat: spot for seat, spot in places.items() if math.dist(spot, state.position[:2]) < _BY_M}
        there = [
            seat
            for seat in near
            if seat in state.bearers or (is_person(seat) and seat in self.allocation.now)
            if seat != self.briefing.seat
        ]
        return tuple((*near[seat], touching(seat) + _MARGIN_M) for seat in there)

    def _ends(self, state: ThingState) -> tuple[Vec3, Vec3]:
        return self._choice.ends(state.position, self._yaw or 0.0, self._half)

    def _able_robots(self, state: ThingState, job: Job) -> list[str]:
        bodies = self.allocation.bodies.items()
        return [seat for seat, body in bodies if not is_person(seat) and can_do(body, state.kind, job)]

    def _counts_on_person(self, state: ThingState, job: Job) -> bool:
        """Whether a person is needed because there are too few robots with arms."""
        return bool(self.allocation.people) and len(self._able_robots(state, job)) < job.hands

    def _await(self, observation: Observation, state: ThingState) -> Motion:
        """Come near enough to see how the thing stands, then wait where it blocks nobody, facing the thing."""
        here, place = (observation.pose.x, observation.pose.y), state.position
        routes, outcome = RoutesAround(self.routes, self._outline(state)), observation.outcome
        stopped = outcome is not None and not outcome.ok and outcome.motion == "move"
        if stopped or self._awaited is None or math.dist(self._awaited, place[:2]) > _MARGIN_M:
            self._awaited, self._parked = place[:2], False
            start = routes.loose(here) if stopped and not seat_bumped(observation) else here
            near = _BY_M if self._yaw is not None else self._seeing_distance(place)
            way = viewpoints.path_to_reach(routes, start, (place,), near, but=[here] if stopped else [])
            self.follower.take((start, *way) if way else ())
        step = self.follower.next(observation.pose)
        if step is None and not self._parked:
            turn = face(observation.pose, place, self.body.eye, self.body.pitch_limit)
            if self._yaw is None and turn is not None:
                return turn
            self._parked = True
            self.follower.take(routes.retreat(here, place[:2], _ASIDE_M))
            step = self.follower.next(observation.pose)
        return step or self._attend(observation, state)

    def _seeing_distance(self, place: Vec3) -> float:
        """How near on the plan the body has to come to see the thing [m]."""
        drop = self.body.eye - place[2]
        return math.sqrt(max(self.body.sight_range**2 - drop**2, _BEFORE_M**2)) - _MARGIN_M

    def _handle(self, state: ThingState) -> Vec3:
        """The free handle, of two the one farther from the nearest person; the middle until its heading is seen."""
        if self._yaw is None:
            return state.position
        ends = self._ends(state)
        others = [self.allocation.place(seat) for seat in state.bearers if seat != self.briefing.seat]
        if others:
            return max(ends, key=lambda end: round(math.dist(end[:2], others[0]), 3))
        places = [self.allocation.place(seat) for seat in self.allocation.people or (HUMAN,)]
        person = min(places, key=lambda place: math.dist(place, state.position[:2]))
        way = self.routes.way(person, self.routes.loose(state.position[:2]))
        last = way[-2] if len(way) > 1 else person
        return max(ends, key=lambda end: round(math.dist(end[:2], last), 3))

    def _hold(self, observation: Observation, state: ThingState, place: Vec3 | None) -> Motion:
        """Hold an end until another body takes the other; if one beside it does not get there, change ends."""
        here = (observation.pose.x, observation.pose.y)
        bodies = [seen.position[:2] for seen in observation.detections if seen.family in ("person", "robot")]
        if any(min(math.dist(body, here), math.dist(body, state.position[:2])) < _BY_M for body in bodies):
            self._beside.append(observation.tick)
        recent = observation.tick - 2.0 * _VAIN_S / self.briefing.tick_s
        self._beside = [tick for tick in self._beside if tick > recent]
        in_vain = bool(self._beside) and (observation.tick - self._beside[0]) * self.briefing.tick_s > _VAIN_S
        if in_vain and len(self._first_ends(state, place)) != 1:
            self._vain, self._squeezed = self._vain + 1, False
            self._beside.clear()
            return Drop()
        return Rotate(yaw=_LOOK_SHARE * self.body.fov[0])

    def _attend(self, observation: Observation, state: ThingState) -> Motion:
        """Face the thing and wait for another body to take the other end."""
        turn = face(observation.pose, state.position, self.body.eye, self.body.pitch_limit)
        return turn if turn is not None and abs(turn.yaw) > 0.2 else Wait(seconds=0.5)

    def _way_length(self, here: Vec2, spot: Vec2) -> float:
        way = self.routes.way(here, self.routes.loose(spot))
        return path_length(way) if way else math.inf


def _middle_of_destination(knowledge: Knowledge, job: Job, state: ThingState) -> Vec3 | None:
    """The middle of the room that the thing belongs in, for a job without a place."""
    room = next((knowledge.rooms[name] for name in job.destinations if name in knowledge.rooms), None)
    return None if room is None else (*_middle(room), state.position[2])


def _middle(room: Room) -> Vec2:
    """The mean of a room's corners [m]."""
    corners = room.polygon
    x, y = (sum(corner[axis] for corner in corners) / len(corners) for axis in (0, 1))
    return (x, y)
