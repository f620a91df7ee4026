"""Gather three apples in one place, too much for one person to carry in time.

The goal has one job for each of ``apple``, ``apple_2`` and ``apple_3``::

    Job(target="apple_2", relation="on", destinations=("dining_table",))

The destination is the id of the only piece of furniture of its kind in the house. Progress is the share of apples
that rest there; the goal is met when all three do.

In half of the tasks one apple is in the closed fridge: a robot that cannot open it has to ask for help. The apples
lie in different rooms, so far apart that an omniscient person who walks at `PACE_M_S` cannot bring all three in
time (`alone`). A person and a robot with hands who divide them well finish with time to spare (`team`).
"""

# ruff: noqa: ARG002 - the instruction does not say where the apples are; the signatures are those of every kind

import itertools
import math
from collections.abc import Iterable

from hthor import catalog, rules, seeds
from hthor.catalog import priors
from hthor.errors import HthorError
from hthor.tasks.arrangement.free_spots import find_spot, room_of, unique_things
from hthor.tasks.arrangement.reachability import ReachableFloor
from hthor.tasks.job_times import carrying_way
from hthor.tasks.subgoals import JobKind
from hthor.types import Goal, HouseSpec, Job, Placement, Pose, TaskSpec, Thing

PLACES = ("dining_table", "counter_top", "coffee_table", "desk", "tv_stand")
"""Kinds of things that apples are gathered on, if the house has exactly one of the kind."""
APPLES = ("apple", "apple_2", "apple_3")
FRIDGE_SHARE = 0.5
"""Share of the tasks in which an apple is in the fridge."""
PACE_M_S = 0.4
"""Mean speed of people in a headset, stops included (docs/humans.md)."""
GUIDED_M_S, ROBOT_M_S = 0.25, 0.52
"""Mean speeds of a person guided by a robot, and of a robot with hands, turns included."""
TOLD_S, GRASP_S = 20.0, 2.5
"""Time until a person has been told where an apple is; time of a person or a robot to pick or place an apple."""
ALONE_S, TEAM_S = 92.0, 64.0
"""Least `alone` time, and greatest `team` time, of an accepted task."""
LEAST_M, MOST_M = 17.0, 23.0
"""Bounds of the apples' ways in total: less is too easy for a person alone, more is too hard for two."""
_SOME = 0.02
_TRIES = 200


class MultiRobotCollection(JobKind):
    """ "Put the three apples on the dining table." """

    name = "multi_robot_collection"
    short = "collect"
    crew = ("tender", "puck")
    medium_from, hard_from = 57.0, 61.0

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        return tuple(_goal(place) for place in unique_things(house, PLACES))

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        return f"Put the three apples on {catalog.kind(goal.destination).definite}."

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        goals = self.goals(house)
        for attempt in range(_TRIES if goals else 0):
            own = seeds.derive(root, "try", attempt)
            goal = goals[seeds.choice([1.0] * len(goals), own, "goal")]
            place = next(thing for thing in house.things if thing.id in goal.jobs[0].destinations)
            objects = _apples(house, place, own, seeds.draw(root, "fridge") < FRIDGE_SHARE)
            if objects and LEAST_M <= sum(ways(house, objects, goal)) <= MOST_M:
                return goal, objects
        raise HthorError(f"house '{house.id}' is too small to keep a person busy with three apples")

    def misfit(self, task: TaskSpec, house: HouseSpec) -> str:
        if (seconds := alone(task, house)) < ALONE_S:
            return f"a person alone needs {seconds:.0f} s, so nobody has to help"
        if (seconds := team(task, house)) > TEAM_S:
            return f"a person and a robot need {seconds:.0f} s, so they would hardly make it"
        return ""


def _goal(place: Thing) -> Goal:
    relation = catalog.kind(place.kind).relation
    jobs = tuple(Job(target=apple, relation=relation, destinations=(place.id,)) for apple in APPLES)
    return Goal(target=APPLES[0], relation=relation, destination=place.kind, jobs=jobs)


def _apples(house: HouseSpec, place: Thing, root: int, cold: bool) -> tuple[Placement, ...]:
    """Three apples in different rooms, none in the room of ``place``; empty when no such places were found."""
    expected = {place: weight for (how, place), weight in priors.weights("apple").items() if how != "near"}
    taken, done = {place.room}, list[Placement]()
    for number in seeds.shuffled(len(APPLES), root, "order"):
        fridge = cold and not done

        def weigh(thing: Thing, fridge: bool = fridge) -> float:
            if (thing.kind == "fridge") != fridge or (thing.room in taken and not fridge) or thing.id == place.id:
                return 0.0
            far = math.dist(thing.centre, place.centre)  # tasks with near apples would be rejected as too easy
            return max(expected.get(thing.kind, 0.0), _SOME) * far

        found = find_spot(house, APPLES[number], "apple", weigh, seeds.derive(root, "apple", number), done)
        if found is None:
            return ()
        done.append(found)
        taken.add(room_of(house, found.support))
    return tuple(sorted(done, key=lambda placement: placement.id))


def ways(house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> list[float]:
    """How far [m] each job's apple has to be carried."""
    there = {placement.id: placement for placement in objects}
    return [carrying_way(house, there[job.target], job) for job in goal.jobs]


def alone(task: TaskSpec, house: HouseSpec) -> float:
    """The least time [s] of an omniscient person at `PACE_M_S` who brings one apple after the other, without a robot.

    Each pick, each place and the fridge's opening take `rules.HANDLING_S`.
    """
    carried, opened = ways(house, task.objects, task.goal), any(one.relation == "in" for one in task.objects)
    walked = _round(_first_ways(task, house, task.human_start), carried, range(len(carried)))
    return walked / PACE_M_S + (2 * len(carried) + opened) * rules.HANDLING_S


def team(task: TaskSpec, house: HouseSpec) -> float:
    """The time [s] of a guided person and the first robot with the best division of the apples between them."""
    carried, every = ways(house, task.objects, task.goal), range(len(task.objects))
    person = _first_ways(task, house, task.human_start)
    robot = _first_ways(task, house, task.robot_starts[0])
    best = math.inf
    for count in every:
        for own in itertools.combinations(every, count):
            others = [number for number in every if number not in own]
            told = TOLD_S + _round(person, carried, own) / GUIDED_M_S + 2 * GRASP_S * len(own) if own else 0.0
            rest = _round(robot, carried, others) / ROBOT_M_S + 2 * GRASP_S * len(others)
            best = min(best, max(told, rest))
    return best


def _round(first: list[float], carried: list[float], own: Iterable[int]) -> float:
    """The least way [m] to fetch the ``own`` apples in turn; ``first`` are the ways if an apple is fetched first."""
    own = list(own)
    return min((first[k] - carried[k] for k in own), default=0.0) + 2 * sum(carried[k] for k in own)


def _first_ways(task: TaskSpec, house: HouseSpec, start: Pose) -> list[float]:
    ground, there = ReachableFloor.of(house), {placement.id: placement for placement in task.objects}
    walks = [ground.walk([ground.touching(there[job.target])]) for job in task.goal.jobs]
    return [float(walk.lengths([(start.x, start.y)])[0]) for walk in walks]


KIND = MultiRobotCollection()
