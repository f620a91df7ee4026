"""Fetches objects and puts them where they belong, motion by motion."""

import functools
import math

from msgspec import Struct

from hthor import catalog, rules
from hthor.agents.skills import viewpoints
from hthor.agents.skills.knowledge import Knowledge, has_door, resting_points
from hthor.agents.skills.right_of_way.yielding import Yielding, seat_bumped
from hthor.agents.skills.routes_around import RoutesAround
from hthor.agents.skills.viewpoints import Routes
from hthor.geometry import plane
from hthor.navigation.detours import Disc
from hthor.navigation.path_follower import Follower, face
from hthor.types import BodySpec, Job, Motion, Observation, Open, Pick, Place, Thing, Vec2, Vec3, Wait

AGAIN_S = 10.0
"""How long an object is left alone after several failures [s]."""
_REACHES = ((0.85, 0.12), (0.985, 0.045))
"""Shares of the arm's length, and the grid [m] of spots to consider: close first, then at full reach."""
_TRIES = 6
_PAUSE_S = 0.5
_TURN_RAD = 0.7
"""Largest heading error at which the body moves or reaches without turning first."""
_SIDESTEP_M = 0.5
"""The body goes sideways or backwards to a place nearer than this [m]: turning there and back takes longer."""
_MOVED_M = 0.1
_AT_M = 0.2
"""Tolerance of a required standing position [m]."""


class ManipulationGoal(Struct, frozen=True):
    """A goal for the body: stand with one of the ``points`` [m] within reach, face it, then do ``act``.

    ``stand`` [m] is where to stand for it, if that matters; ``avoid``: discs to keep out of on the way, such as
    bodies that will stay where they are, or the object itself when it is heavy.
    """

    name: str
    points: tuple[Vec3, ...]
    act: Motion
    holder: Thing | None = None
    stand: Vec3 | None = None
    avoid: tuple[Disc, ...] = ()


class Manipulator:
    """Carries one object after the other; leaves an object alone for a while after several failures.

    ``follower`` has its current path.
    """

    def __init__(self, body: BodySpec, routes: Routes, yielding: Yielding, tick_s: float) -> None:
        self.body, self.routes, self.yielding = body, routes, yielding
        step = whole_tick_move(body, tick_s)
        self.follower = Follower(step=step, turn_rad=_TURN_RAD, arrived_m=0.01, sidestep_m=_SIDESTEP_M)
        self._again = round(AGAIN_S / tick_s)
        self._left_alone: dict[str, int] = {}
        self._goal_name, self._at = "", (0.0, 0.0, 0.0)
        self._misses: list[Vec2] = []

    def can_try(self, name: str, tick: int) -> bool:
        """Whether an object, or an object with a thing to put it on, may be tried now."""
        return self._left_alone.get(name, 0) <= tick

    def leave(self, name: str, until: int) -> None:
        """Leave the object alone until this tick."""
        self._left_alone[name] = until

    def motion(self, observation: Observation, knowledge: Knowledge, job: Job) -> Motion | None:
        """The next motion of this job, None when nothing can be done for it now."""
        if observation.holding == job.target:
            goal = self._delivery(observation, knowledge, job)
        else:
            goal = self._fetching(knowledge, job)
        return None if goal is None else self.pursue(observation, goal)

    def open(self, observation: Observation, thing: Thing) -> Motion | None:
        """The next motion towards an open door, None when it was given up."""
        if not self.can_try(thing.id, observation.tick):
            return None
        x, y, z = plane.to_house((0.0, thing.size[1] / 2, 0.0), thing.centre, thing.yaw)
        return self.pursue(observation, ManipulationGoal(thing.id, ((x, y, z),), Open(thing=thing.id), thing))

    def drop(self) -> None:
        """Forget the current goal."""
        self._goal_name = ""
        self.follower.take(None)

    def _fetching(self, knowledge: Knowledge, job: Job) -> ManipulationGoal | None:
        state = knowledge.states.get(job.target)
        if state is None or state.held_by:
            return None
        holder = knowledge.things.get(state.support)
        act: Motion = Open(thing=state.support) if knowledge.is_shut(state.support) else Pick(object=job.target)
        return ManipulationGoal(job.target, (state.position,), act, holder)

    def _delivery(self, observation: Observation, knowledge: Knowledge, job: Job) -> ManipulationGoal | None:
        thing = self._bearer(observation, knowledge, job)
        if thing is None:
            return None
        act: Motion = Place(on=thing.id, position=job.place)
        if knowledge.is_shut(thing.id):
            act = Open(thing=thing.id)
        points = (job.place,) if job.place is not None else self._room_for(job, thing, knowledge)
        return ManipulationGoal(_at(job, thing), points, act, thing)

    def _bearer(self, observation: Observation, knowledge: Knowledge, job: Job) -> Thing | None:
        """The furniture to put the object on: the current goal, or else the nearest that may be tried."""
        able = [
            thing
            for thing in knowledge.bearers(job)
            if self._in_reach(thing, 0.0) and (not knowledge.is_shut(thing.id) or "open" in self.body.capabilities)
        ]
        going = next((thing for thing in able if _at(job, thing) == self._goal_name), None)
        if going is not None:
            return going
        things = [thing for thing in able if self.can_try(_at(job, thing), observation.tick)] or able
        if len(things) < 2:
            return things[0] if things else None
        here = (observation.pose.x, observation.pose.y)
        return viewpoints.closest_thing(
            self.routes, here, things, lambda thing: self._in_reach(thing, 0.0), self.body.reach
        )

    def _in_reach(self, thing: Thing, inset_m: float) -> tuple[Vec3, ...]:
        """Points on the thing's surfaces at heights within the arm's reach."""
        return _between(thing, inset_m, self.body.reach_low, self.body.reach_high - 0.1)

    def _room_for(self, job: Job, thing: Thing, knowledge: Knowledge) -> tuple[Vec3, ...]:
        """Points [m] on the thing where the object fits next to objects known to lie there, or else all points."""
        states = knowledge.states
        wide = _wide(states[job.target].kind)
        points = self._in_reach(thing, wide)
        there = [(one.position, _wide(one.kind) + wide) for one in states.values() if one.support == thing.id]
        free = [point for point in points if all(math.dist(point[:2], at[:2]) > apart for at, apart in there)]
        return tuple(free) or points

    def pursue(self, observation: Observation, goal: ManipulationGoal) -> Motion | None:
        """Go to a spot, face a point and act; after a refusal, try another spot."""
        outcome, here = observation.outcome, (observation.pose.x, observation.pose.y)
        moved = len(goal.points) == 1 and math.dist(goal.points[0], self._at) > _MOVED_M
        if goal.name != self._goal_name or moved:
            self._goal_name, self._at, self._misses = goal.name, goal.points[0], []
            if not self._set_out(here, goal):
                return self._give_up(observation)
        elif outcome is not None and not outcome.ok:
            if seat_bumped(observation) and not self._is_taken(observation):
                if not self._gets_past(observation):
                    return Wait(seconds=_PAUSE_S)
            elif not self._recover(observation, goal):
                return self._give_up(observation)
        step = self.follower.next(observation.pose)
        if step is not None:
            return step
        turn = face(observation.pose, viewpoints.nearest_point(goal.points, here), self.body.eye, self.body.pitch_limit)
        return turn if turn is not None and abs(turn.yaw) > _TURN_RAD else goal.act

    def _recover(self, observation: Observation, goal: ManipulationGoal) -> bool:
        """After a failure: try another spot, or leave a tight corner first. False when everything was tried."""
        outcome, here = observation.outcome, (observation.pose.x, observation.pose.y)
        assert outcome is not None
        if outcome.motion != "move":
            self._misses.append(here)
            return len(self._misses) <= _TRIES and self._set_out(here, goal)
        spot = self.follower.goal
        if seat_bumped(observation):
            if spot is not None:
                self._misses.append(spot)
            return len(self._misses) <= _TRIES and self._set_out(here, goal)
        loose = self._routes_for(goal).loose(here)
        if not self._set_out(loose, goal):
            return False
        self.follower.take((loose, *self.follower.path))
        return True

    def _is_taken(self, observation: Observation) -> bool:
        """Whether the body that this body ran into stands at the spot that this body wants."""
        spot = self.follower.goal
        return spot is None or self.yielding.is_taken(observation, spot)

    def _gets_past(self, observation: Observation) -> bool:
        """Set out round another body; False when it has to wait for that body to go."""
        spot = self.follower.goal
        way = self.yielding.around(observation, spot) if spot is not None else ()
        if way:
            self.follower.take(way)
        return bool(way)

    def _set_out(self, here: Vec2, goal: ManipulationGoal) -> bool:
        """Take the path to a spot; False when there is none."""
        routes = self._routes_for(goal)
        if goal.stand is not None:
            way = viewpoints.path_to_reach(routes, here, (goal.stand,), _AT_M, but=self._misses, grid_m=_AT_M / 3.0)
            if way:
                self.follower.take(way)
                return True
        holder = goal.holder
        front = holder is not None and has_door(holder)
        for share, grid_m in _REACHES:
            reach = share * self.body.reach
            way = viewpoints.path_to_reach(routes, here, goal.points, reach, holder, front, self._misses, grid_m)
            if way:
                self.follower.take(way)
                return True
        return False

    def _routes_for(self, goal: ManipulationGoal) -> Routes:
        return RoutesAround(self.routes, goal.avoid) if goal.avoid else self.routes

    def _give_up(self, observation: Observation) -> Motion:
        self._left_alone[self._goal_name] = observation.tick + self._again
        self.drop()
        return Wait(seconds=2.0 if observation.holding else 0.3)


def whole_tick_move(body: BodySpec, tick_s: float) -> float:
    """The longest move [m] that takes a whole number of ticks at full speed, so that no time is lost."""
    tick_m = body.speed * tick_s
    return tick_m * math.floor(rules.MOVE_MAX_M / tick_m + 1e-9) if tick_m < rules.MOVE_MAX_M else rules.MOVE_MAX_M


def _wide(kind: str) -> float:
    """Half the longer side of an object of this kind [m]."""
    return max(catalog.kind(kind).size[:2]) / 2


def _at(job: Job, thing: Thing) -> str:
    return f"{job.target} {thing.id}"


@functools.lru_cache(maxsize=1024)
def _between(thing: Thing, inset_m: float, low: float, high: float) -> tuple[Vec3, ...]:
    """Points of the thing's surfaces between two heights [m]."""
    return tuple(point for point in resting_points(thing, inset_m) if low <= point[2] <= high)
