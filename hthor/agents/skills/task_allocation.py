"""Task allocation that every robot computes identically from the same observations."""

import math
from collections.abc import Callable, Collection, Sequence

from hthor import catalog
from hthor.agents.skills.knowledge import Knowledge
from hthor.types import BodySpec, Briefing, Job, Observation, Vec2, Vec3, is_person

UNKNOWING_M = 4.0
"""Extra distance of a person to any object [m], since they have to find it first."""
DOOR_M = 2.0
"""Extra distance for opening a door [m]."""
AT_HAND_M = 2.0
"""Objects this close to a person are left to them [m]."""
_REVIEW_S = 2.0

WalkingDistance = Callable[[Vec2, Vec3], float]
"""Walking distance [m] from a place to the floor next to a point."""


class TaskAllocation:
    """Who does which job best, by where everybody is; bodies never seen are assumed at the robot's own start.

    Attributes:
        seats: everybody, in order. people: those of people.
        now: positions [m] known at this moment, by seat. places: also the last known positions of the others.
    """

    def __init__(self, briefing: Briefing, apart: WalkingDistance) -> None:
        self.me, self.bodies, self._apart = briefing.seat, dict(briefing.crew), apart
        self.bodies.setdefault(briefing.seat, briefing.body)
        self.seats = sorted(self.bodies, key=seat_order)
        self.people = tuple(seat for seat in self.seats if is_person(seat))
        self.places: dict[str, Vec2] = {}
        self.now: dict[str, Vec2] = {}
        self._start: Vec2 | None = None
        self._shared: tuple[object, dict[str, Job]] = (None, {})
        self._period = round(_REVIEW_S / briefing.tick_s)
        self.tick = 0
        self.jobs = briefing.todo
        self._ways: dict[tuple[Vec2, Vec2], float] = {}

    def see(self, observation: Observation, knowledge: Knowledge) -> None:
        """Update the positions of bodies that are in view, or that hold an object whose position is known."""
        here, self.tick = (observation.pose.x, observation.pose.y), observation.tick
        self._start = self._start or here
        self.now = {}
        for state in knowledge.states.values():
            if state.held_by and not state.bearers:
                self.now[state.held_by] = state.position[:2]
        for seen in observation.detections:
            if seen.family in ("person", "robot"):
                self.now[seen.id] = seen.position[:2]
        self.now[self.me] = here
        self.places.update(self.now)

    def share(self, jobs: Sequence[Job], knowledge: Knowledge) -> dict[str, Job]:
        """The next job of each seat: shortest paths first, one job per seat, as many seats per job as it needs.

        Seats that hold something get no job. Shares are computed again when jobs or hands have changed, and every two
        seconds.
        """
        busy = {state.held_by for state in knowledge.states.values()}
        moment = (tuple(job.target for job in jobs), frozenset(busy), self.tick // self._period)
        if moment != self._shared[0]:
            self._shared = (moment, self._dealt(jobs, busy, knowledge))
        return self._shared[1]

    def _dealt(self, jobs: Sequence[Job], busy: Collection[str], knowledge: Knowledge) -> dict[str, Job]:
        free = [seat for seat in self.seats if seat not in busy]
        bids = [
            (self.cost(seat, job, knowledge), seat_order(seat), number, seat, job)
            for number, job in enumerate(jobs)
            for seat in free
        ]
        given = {seat: job for job in jobs for seat in knowledge.states[job.target].bearers}
        for cost, _, _, seat, job in sorted(bids, key=lambda bid: bid[:3]):
            if math.isfinite(cost) and seat not in given and list(given.values()).count(job) < job.hands:
                given[seat] = job
        return given

    def reserved(self, jobs: Sequence[Job], knowledge: Knowledge) -> str:
        """The object that is left to people where a robot without an arm can tell them about it; "" for none.

        It is the object with the shortest way to its destination; an object behind a door counts as nearer, since
        people can open doors. All robots that know where everything is get the same answer.
        """
        robots = [seat for seat in self.seats if not is_person(seat)]
        tellers = [seat for seat in robots if "pick" not in self.bodies[seat].capabilities]
        todo = [job for job in jobs if job.hands == 1 and job.relation != "find"]
        if not tellers or len(todo) < 2 or not self.people:
            return ""
        return min(todo, key=lambda job: (round(self._carry(job, knowledge), 2), job.target)).target

    def _carry(self, job: Job, knowledge: Knowledge) -> float:
        """Distance [m] from an object to its nearest destination."""
        state = knowledge.states[job.target]
        ends = [job.place] if job.place is not None else [thing.centre for thing in knowledge.bearers(job)]
        way = min((math.dist(state.position[:2], end[:2]) for end in ends), default=0.0)
        return way - (DOOR_M if knowledge.is_shut(state.support) else 0.0)

    def cost(self, seat: str, job: Job, knowledge: Knowledge) -> float:
        """Walking distance [m] from a seat to an object plus surcharges; infinite for a body that cannot take it."""
        state = knowledge.states[job.target]
        shut = knowledge.is_shut(state.support)
        if not can_do(self.bodies[seat], state.kind, job, shut):
            return math.inf
        way = self.distance(seat, state.position)
        return way + UNKNOWING_M if is_person(seat) else way + (DOOR_M if shut else 0.0) - self._later(job, knowledge)

    def _later(self, job: Job, knowledge: Knowledge) -> float:
        """Distance [m] to an object from the nearest end of another job; if that is far, fetch it first."""
        object, ways = knowledge.states[job.target].position, [math.inf]
        for other in self.jobs:
            ends = (other.place,) if other.place is not None else tuple(one.centre for one in knowledge.bearers(other))
            if other is not job and not knowledge.is_done(other):
                ways += [self._between(end, object) for end in ends]
        return min(ways) if math.isfinite(min(ways)) else 0.0

    def _between(self, a: Vec3, b: Vec3) -> float:
        """Walking distance [m] between two things, remembered."""
        key = (a[:2], b[:2])
        if key not in self._ways:
            self._ways[key] = self._apart(a[:2], b)
        return self._ways[key]

    def distance(self, seat: str, point: Vec3) -> float:
        """Walking distance [m] of a seat's body to the floor next to a point."""
        return self._apart(self.place(seat), point)

    def place(self, seat: str) -> Vec2:
        """Position [m] of a seat's body: current, last known, or assumed at the start."""
        return self.places.get(seat) or self._start or (0.0, 0.0)

    def leaves_to_person(self, job: Job, knowledge: Knowledge) -> bool:
        """Whether a person is seen next to the object, with a free hand."""
        spot, busy = knowledge.states[job.target].position[:2], {other.held_by for other in knowledge.states.values()}
        return any(
            math.dist(place, spot) < AT_HAND_M
            for seat, place in self.now.items()
            if is_person(seat) and seat not in busy
        )


def can_do(body: BodySpec, kind: str, job: Job, shut: bool = False) -> bool:
    """Whether a body can do its part of a job with an object of this kind, alone or with others."""
    if "pick" not in body.capabilities or (shut and "open" not in body.capabilities):
        return False
    return job.hands > 1 or catalog.kind(kind).mass <= body.strength


def seat_order(seat: str) -> tuple[bool, int, str]:
    """Seats in order: "human", "human2", ... "robot", "robot2", ... "robot10"."""
    return (not is_person(seat), len(seat), seat)
