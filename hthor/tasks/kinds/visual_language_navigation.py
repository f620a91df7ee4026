"""Follow an instruction that describes the way to a landmark, and stop there.

The goal names who walks (`hthor.types.WALKERS`: the first person or the first robot) and the kind of thing where the
way ends, of which the house has only one::

    Goal(target="person_1", relation="go", destination="fridge", route=((1.2, 3.4), ...))

A task begins with the walker in another room. The instruction is written from the route and from what is in sight on
the way (`hthor.tasks.routes`), and the route itself is for judging and drawing only. The goal is met when the walker
has stood still for `STOP_S` within `NEAR_M` of the landmark's edge, in its room. As in R2R (Anderson et al. 2018),
where an agent has to stop within 3 m of the end of the route, passing by is not enough; but a wrong stop does not end a
trial.
Progress is the share by which the walking distance has become smaller.

The least time is that of the shortest path to such a place, plus `STOP_S`: at `rules.PACE_M_S` for a person, at
`ROBOT_M_S` for a robot. Start poses are chosen by a person's time in both cases, so that the routes are equally long.
"""

import functools
import math
from itertools import pairwise

import msgspec

from hthor import catalog, rules
from hthor.geometry import plane
from hthor.navigation import directions
from hthor.tasks.arrangement.free_spots import unique_things
from hthor.tasks.arrangement.reachability import ReachableFloor, Walk
from hthor.tasks.kind import LeastTimes, TaskKind
from hthor.tasks.routes.instruction_writer import directions_of
from hthor.tasks.routes.landmarks import is_landmark, outline_distance
from hthor.tasks.routes.passages import exits
from hthor.tasks.routes.route import as_route, place_beside, shortest_route
from hthor.types import HUMAN, WALKERS, Goal, HouseSpec, Placement, Pose, Snapshot, TaskSpec, Thing

NEAR_M = 1.0
"""Greatest distance [m] of the walker's axis from the landmark's edge, as in object-goal navigation (Batra et al. 2020,
ObjectNav Revisited). R2R's 3 m would be most of a room here."""
STOP_S = 2.0
"""How long [s] the walker has to stand still. Our choice: longer than the pauses of people and robots on their way."""
ROBOT_M_S = 2.5
"""Speed [m/s] of the fastest robot that comes with hthor, `scout`, which also is the kind's robot."""
LEAST_M, MOST_M = 5.0, 20.0
"""Bounds of the route's length; R2R's routes have at least 5 m, and 10 m on average. Our choice of the upper bound:
50 s at the pace of people in a headset (0.4 m/s)."""
LEAST_STEPS = 3
"""Least number of steps in an instruction, so of legs of the way."""


class VisualLanguageNavigation(TaskKind):
    """ "Go through the door on your left into the kitchen. Walk past the stove on your right. Stop at the fridge." """

    name = "visual_language_navigation"
    short = "vln"
    stop_s = STOP_S
    intended_s = (7.0, 20.0)

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        ends = [thing.kind for thing in _ends(house)]
        return tuple(Goal(target=walker, relation="go", destination=kind) for kind in ends for walker in WALKERS)

    def objection(self, goal: Goal, house: HouseSpec) -> str:
        if goal.relation != "go" or goal.target not in WALKERS:
            valid = " or ".join(WALKERS)
            return f"a walk has relation 'go' and target {valid}, got '{goal.relation}' and '{goal.target}'"
        ends = [thing.kind for thing in _ends(house)]
        if goal.destination not in ends:
            return f"ends at '{goal.destination}'; in this house a walk can end at {', '.join(ends) or 'nothing'}"
        return ""

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:  # noqa: ARG002 - they do not matter
        """The instruction without the way, which depends on the start: see `completed`."""
        return f"Go to {catalog.kind(goal.destination).definite} and stop there."

    def completed(self, task: TaskSpec, house: HouseSpec) -> TaskSpec:
        """The task with its route and the instruction for it, and with the first robot at the drawn start if it walks.

        Without either if no instruction describes the shortest route without ambiguity.
        """
        if task.goal.target != "person_1":
            robot, *others = task.robot_starts
            task = msgspec.structs.replace(task, human_start=robot, robot_starts=(task.human_start, *others))
        end, start = _end(house, task.goal), _start(task)
        place = None if end is None else place_beside(house, end)
        route = None if place is None else shortest_route(house, start, place)
        steps = None if end is None or route is None else directions_of(house, start, route, end)
        if route is None or not steps:
            return task
        goal = msgspec.structs.replace(task.goal, route=route.points)
        task = msgspec.structs.replace(task, goal=goal, instruction=directions.write(steps))
        return msgspec.structs.replace(task, t_star=self.t_star(task, house))

    def misfit(self, task: TaskSpec, house: HouseSpec) -> str:  # noqa: ARG002 - the route says it all
        route = task.goal.route
        if not route:
            return "no instruction describes the way without ambiguity"
        metres = sum(math.dist(a, b) for a, b in pairwise(route))
        if not LEAST_M <= metres <= MOST_M:
            return f"the way has {metres:.1f} m, not {LEAST_M:g} to {MOST_M:g} m"
        steps = directions.read(task.instruction)
        if len(steps) < LEAST_STEPS or steps[0].act == "stop":
            return f"the way has {len(steps)} steps; it needs {LEAST_STEPS} and has to lead to another room"
        return ""

    def doubt(self, task: TaskSpec, house: HouseSpec) -> float:
        """The chance to take a wrong door somewhere on the way for somebody who knows only that there is another room.

        Each door by which a room can be left, except the one just used, is equally likely.
        """
        route = as_route(house, _start(task), task.goal.route) if task.goal.route else None
        right = 1.0
        for stretch in route.stretches if route is not None else ():
            if stretch.exit is not None:
                right /= len([way for way in exits(house, stretch.room.id) if way != stretch.entry])
        return 1.0 - right

    def stopper(self, goal: Goal) -> str:
        return WALKERS[goal.target]

    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        pose, end = snapshot.poses.get(WALKERS[task.goal.target]), _end(house, task.goal)
        if pose is None or end is None or outline_distance(end, (pose.x, pose.y)) > NEAR_M:
            return False
        return any(room.id == end.room and plane.inside((pose.x, pose.y), room.polygon) for room in house.rooms)

    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:  # noqa: ARG002
        return False

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> float:
        pose, start = snapshot.poses.get(WALKERS[task.goal.target]), _start(task)
        if pose is None:
            return 0.0
        whole, left = _walk(house, task.goal.destination).lengths([(start.x, start.y), (pose.x, pose.y)])
        return float(min(max(1.0 - left / whole, 0.0), 0.99)) if 0.0 < whole < math.inf else 0.0

    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:  # noqa: ARG002
        walk = _walk(house, goal.destination)
        return lambda starts: walk.lengths(starts) / rules.PACE_M_S + STOP_S

    def t_star(self, task: TaskSpec, house: HouseSpec) -> float:
        start, pace = _start(task), rules.PACE_M_S if WALKERS[task.goal.target] == HUMAN else ROBOT_M_S
        metres = float(_walk(house, task.goal.destination).lengths([(start.x, start.y)])[0])
        return self.t_star_of(metres / pace + STOP_S)


@functools.lru_cache(maxsize=32)
def _ends(house: HouseSpec) -> tuple[Thing, ...]:
    """The landmarks where a walk can end: the only things of their kinds, and every body can get there."""
    kinds = sorted({thing.kind for thing in house.things if is_landmark(thing)})
    return tuple(thing for thing in unique_things(house, kinds) if place_beside(house, thing) is not None)


def _end(house: HouseSpec, goal: Goal) -> Thing | None:
    return next((thing for thing in _ends(house) if thing.kind == goal.destination), None)


def _start(task: TaskSpec) -> Pose:
    """Where the walker starts."""
    return task.human_start if WALKERS[task.goal.target] == HUMAN or not task.robot_starts else task.robot_starts[0]


@functools.lru_cache(maxsize=64)
def _walk(house: HouseSpec, kind: str) -> Walk:
    """The walk to any place near the landmark of a kind, in its room."""
    ground = ReachableFloor.of(house)
    end = next(thing for thing in _ends(house) if thing.kind == kind)
    room = next(room for room in house.rooms if room.id == end.room)
    return ground.walk([ground.beside(end, NEAR_M) & ground.space.room_mask(room)])


KIND = VisualLanguageNavigation()
