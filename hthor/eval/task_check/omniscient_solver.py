"""A person who knows where everything is and does a task alone, in the simulated world.

The walk is the shortest there is, at `PACE_M_S`, which is slow; turning and handling take as long as the avatar's body
needs, and nothing else takes any time. So a person can be quicker only by walking faster, and the least time is never
longer than this person's time.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hthor import catalog, plugins, rules
from hthor.eval.task_check.solution import Solution
from hthor.eval.task_check.walking import MetTest, in_the_persons_place, spots_at_end
from hthor.geometry import plane
from hthor.tasks.arrangement.reachability import ReachableFloor, lines_of_sight
from hthor.types import (
    HUMAN,
    Drop,
    Job,
    Motion,
    Move,
    Open,
    Outcome,
    Pick,
    Place,
    Rotate,
    TaskSpec,
    Thing,
    Vec2,
    Vec3,
    Wait,
)

if TYPE_CHECKING:
    from hthor.world import World

Floats = NDArray[np.float64]

PACE_M_S = 0.4
"""Walking speed of the omniscient person [m/s]."""
_SURE = 0.98
"""Share of a range that the person uses, as a margin."""
_SPOTS, _LOOKS, _APART_M = 6, 200, 0.2
"""How many spots are tried for one action, how many places are looked at for each, and how far apart they are."""
_POINTS, _EDGE_M, _OFF_M = 3, 0.12, 0.03
"""How many points of a surface are tried from one spot, how far from its edge and above it."""
_TURN_RAD, _EPS = 1e-3, 1e-9


class _Over(Exception):
    """The goal is met, or time is up."""


def solve(world: World, task: TaskSpec, *, limit_s: float | None = None) -> Solution:
    """Do a task from its start to its end.

    Args:
        world: the world of the task's house, with its objects; it is reset here. Robots in it stand still.
        limit_s: how long it may take [s]; the task's own limit when None.

    Where a robot has to walk somewhere, the person does it in its place.
    """
    return _Performance(world, in_the_persons_place(task), task.time_limit if limit_s is None else limit_s).run()


class _Performance:
    def __init__(self, world: World, task: TaskSpec, limit_s: float) -> None:
        self.world, self.task, self.house = world, task, world.house
        self.kind = plugins.load("task kind", task.kind)
        self.limit = round(limit_s / rules.TICK_S)
        self.ground = ReachableFloor.of(world.house)
        self.body = world.bodies[HUMAN]
        self.things = {thing.id: thing for thing in world.house.things}
        self._is_met = MetTest(self.kind, task, self.house)
        self.met, self.reason = False, ""
        self.way: list[Vec2] = []

    def run(self) -> Solution:
        self.world.reset(self.task)
        self.way = [self._here()]
        try:
            for job in self.task.goal.todo:
                self._go(job) if job.relation == "go" else self._job(job)
        except _Over:
            pass
        if not self.met and not self.reason:
            late = self.world.tick >= self.limit
            self.reason = "time is up" if late else "all is done that the goal names, and yet it is not met"
        way = (*self.way, self._here())
        return Solution(
            met=self.met,
            seconds=round(self.world.tick * rules.TICK_S, 1),
            metres=round(sum(math.dist(a, b) for a, b in pairwise(way)), 3),
            reason="" if self.met else self.reason,
            way=way,
        )

    def _go(self, job: Job) -> None:
        """Walk to the nearest spot beside a thing of the destination's kind, and stand there."""
        spots = spots_at_end(self.house, self.ground, self._here(), job)
        self._walk(next(self._nearest(spots), self._here()))
        self._do(Wait(seconds=2.0 * self.kind.stop_s))

    def _job(self, job: Job) -> None:
        if job.hands > 1:
            self._fail(f"{job.target} takes {job.hands} bodies to carry")
        self._unshut(self.world.state(job.target).support)
        if job.relation == "find":
            self._at_spots(self._seeing(job.target, None), lambda: self._look(job.target), f"see {job.target}")
            return
        spots = self._seeing(job.target, self.body.reach * _SURE)
        self._at_spots(spots, lambda: self._look(job.target) and self._do(Pick(object=job.target)).ok, "pick it")
        self._deliver(job)

    def _deliver(self, job: Job) -> None:
        """Bring the held object to the nearest destination that has room for it."""
        ends = [thing for thing in self.house.things if thing.id in job.destinations or thing.kind in job.destinations]
        if not ends:
            self._at_spots(self._rooms(job), lambda: self._do(Drop()).ok, f"drop {job.target}")
            return
        ways = sorted((self._way(self._serving(thing, job.place)), thing.id) for thing in ends)
        for _, id in ways:
            thing = self.things[id]
            self._unshut(id)
            spots = self._serving(thing, job.place)
            put = functools.partial(self._put, thing, job.place)
            if self._at_spots(spots, put, f"place {job.target} on {id}", needed=id == ways[-1][1]):
                return

    def _put(self, thing: Thing, place: Vec3 | None) -> bool:
        """Put the held object on a thing, at one of the points that are in sight and in reach from here."""
        here = np.array([self._here()])
        points = [point for point in self._points(thing, place) if len(self._lit(here, thing, point))]
        points.sort(key=lambda point: math.dist(point[:2], self._here()))
        for point in points[:_POINTS]:
            self._face(point)
            if self._do(Place(on=thing.id, position=point)).ok:
                return True
        return False

    def _unshut(self, id: str) -> None:
        """Open the thing with this id if its door hides what lies in it."""
        thing = self.things.get(id)
        if thing is None or not catalog.kind(thing.kind).hides or self.world.state(id).open:
            return
        self._at_spots(
            self._front(thing), lambda: self._face(thing.centre) and self._do(Open(thing=id)).ok, f"open {id}"
        )

    def _at_spots(self, spots: Floats, deed: Callable[[], bool], what: str, *, needed: bool = True) -> bool:
        """Do something at the first of the spots where it succeeds, tried in order of walking distance."""
        tried = list[Vec2]()
        for spot in self._nearest(spots):
            if len(tried) < _SPOTS and all(math.dist(spot, other) >= _APART_M for other in tried):
                tried.append(spot)
                self._walk(spot)
                if deed():
                    return True
        if needed:
            outcome = self.world.outcome(HUMAN)
            why = outcome.reason if outcome is not None and outcome.reason else "there is no place to do it from"
            self._fail(f"cannot {what} from any of {len(tried)} places: {why}")
        return False

    def _seeing(self, id: str, reach: float | None) -> Floats:
        """Spots (N, 2) [m] with the object in sight, near enough to be found, or within ``reach`` [m] of the body."""
        x, y, z = self.world.position(id)
        level = math.sqrt(max((rules.FIND_RANGE_M * _SURE) ** 2 - (self.body.eye - z) ** 2, 0.0))
        cells = self._floor()
        cells = cells[np.hypot(cells[:, 0] - x, cells[:, 1] - y) <= (level if reach is None else reach)]
        seen = [not self.world.hidden(id, (float(u), float(v), self.body.eye)) for u, v in cells]
        lit: Floats = cells[np.array(seen, dtype=bool)]
        return lit

    def _front(self, thing: Thing) -> Floats:
        """Spots (N, 2) [m] from which a body can take hold of a thing's door."""
        cells = self._floor()
        u, v = _local(cells, thing.centre, thing.yaw)
        gap = np.hypot(np.maximum(np.abs(u) - thing.size[0] / 2, 0.0), v - thing.size[1] / 2)
        cells = cells[(v > 0.0) & (gap <= self.body.reach * _SURE)]
        middle = plane.to_house((0.0, thing.size[1] / 2 + _OFF_M, 0.0), thing.centre, thing.yaw)
        front: Floats = cells[lines_of_sight(self.house, frozenset()).seen(self._eyes(cells), [middle])]
        return front

    def _serving(self, thing: Thing, place: Vec3 | None) -> Floats:
        """Spots (N, 2) [m] from which some point where the thing can hold objects is in sight and in reach."""
        cells = self._floor()
        found = [self._lit(cells, thing, point) for point in self._points(thing, place)]
        return np.unique(np.concatenate([np.zeros((0, 2)), *found]), axis=0)

    def _points(self, thing: Thing, place: Vec3 | None) -> list[Vec3]:
        """Points [m] just above the thing's surfaces: the point where the object belongs, or points all over them."""
        if place is not None:
            return [place]
        return [
            plane.to_house((x + u * (w - _EDGE_M), y + v * (d - _EDGE_M), z + _OFF_M), thing.centre, thing.yaw)
            for (x, y, z), (w, d) in ((one.centre, one.half) for one in catalog.kind(thing.kind).rests(thing.size))
            for u in (0.0, -1.0, 1.0, -0.5, 0.5)
            for v in (0.0, -1.0, 1.0)
        ]

    def _lit(self, cells: Floats, thing: Thing, point: Vec3) -> Floats:
        """The cells from which the point is within reach, and in sight when the thing is open."""
        near: Floats = cells[np.hypot(cells[:, 0] - point[0], cells[:, 1] - point[1]) <= self.body.reach * _SURE]
        if len(near):
            near = near[lines_of_sight(self.house, frozenset({thing.id})).seen(self._eyes(near), [point])]
        return near

    def _eyes(self, cells: Floats) -> Floats:
        return np.column_stack((cells, np.full(len(cells), self.body.eye)))

    def _rooms(self, job: Job) -> Floats:
        cells = self._floor()
        rooms = [room for room in self.house.rooms if room.id in job.destinations]
        inside = [any(plane.inside((float(x), float(y)), room.polygon) for room in rooms) for x, y in cells]
        within: Floats = cells[np.array(inside, dtype=bool)]
        return within

    def _floor(self) -> Floats:
        return self.ground.space.centres(self.ground.space.component(*self._here()))

    def _here(self) -> Vec2:
        pose = self.world.pose(HUMAN)
        return (pose.x, pose.y)

    def _nearest(self, spots: Floats) -> Iterator[Vec2]:
        few = spots[:: max(1, len(spots) // _LOOKS)]
        lengths = self.ground.paths.distances(self._here(), few) if len(few) else np.zeros(0)
        return ((float(few[k][0]), float(few[k][1])) for k in np.argsort(lengths, kind="stable"))

    def _way(self, spots: Floats) -> float:
        few = spots[:: max(1, len(spots) // _LOOKS)]
        return float(self.ground.paths.distances(self._here(), few).min(initial=math.inf)) if len(few) else math.inf

    def _walk(self, goal: Vec2) -> None:
        step = PACE_M_S * rules.TICK_S
        for point in self.ground.paths.path(self._here(), goal)[1:]:
            pose = self.world.pose(HUMAN)
            length, bearing = math.dist((pose.x, pose.y), point), math.atan2(point[1] - pose.y, point[0] - pose.x)
            turn = plane.wrap(bearing - pose.yaw)
            if length > _EPS and abs(turn) > _TURN_RAD:
                self._do(Rotate(yaw=turn))
            for _ in range(math.floor(length / step)):
                self._do(Move(forward=step))
            rest = length - math.floor(length / step) * step
            if rest > _EPS:
                self._do(Move(forward=rest))
            self.way.append(self._here())

    def _look(self, id: str) -> bool:
        return self._face(self.world.position(id))

    def _face(self, point: Vec3) -> bool:
        """Turn body and eyes to a point [m]."""
        pose = self.world.pose(HUMAN)
        dx, dy = point[0] - pose.x, point[1] - pose.y
        up = math.atan2(point[2] - self.body.eye, max(math.hypot(dx, dy), _EPS))
        limit = self.body.pitch_limit
        pitch = max(-limit, min(limit, up)) - pose.pitch
        self._do(Rotate(yaw=plane.wrap(math.atan2(dy, dx) - pose.yaw), pitch=pitch))
        return True

    def _do(self, motion: Motion) -> Outcome:
        world = self.world
        world.start(HUMAN, motion)
        while True:
            world.advance()
            self.met = self._is_met(world.snapshot())
            if self.met or world.tick >= self.limit:
                raise _Over
            if world.idle(HUMAN):
                break
        outcome = world.outcome(HUMAN)
        assert outcome is not None
        return outcome

    def _fail(self, reason: str) -> None:
        self.reason = reason
        raise _Over


def _local(cells: Floats, centre: Iterable[float], yaw: float) -> tuple[Floats, Floats]:
    """Places (N, 2) [m] in the frame of a thing: along its width, along its depth."""
    x, y, *_ = centre
    cos, sin = math.cos(yaw), math.sin(yaw)
    dx, dy = cells[:, 0] - x, cells[:, 1] - y
    return cos * dx + sin * dy, cos * dy - sin * dx
