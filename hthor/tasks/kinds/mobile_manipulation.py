"""Pick an object and place it in or on a thing of a given kind: done when it rests there.

The least time is the time of a person who knows all places:

- a walk at `rules.PACE_M_S` along the shortest path of a body of the avatar's radius, from the start by way of a cell
  within the avatar's reach of the target (horizontally, to its centre) to a cell within reach of the nearest point of
  any surface of any thing of the destination's kind; the two cells are chosen together;
- `rules.HANDLING_S` each to pick and to place, and to open a fridge that the target lies in, or must go into;
- less the slack of the 5 cm grid (half a cell's diagonal per range and per leg), so that it is a lower bound.

Turning, recognising and reading cost nothing, and lines of sight do not matter.
"""

from typing import Literal

from hthor import catalog, rules
from hthor.tasks.kind import LeastTimes, TaskKind, kind_of, target_of
from hthor.types import Goal, HouseSpec, Placement, Snapshot, TaskSpec

_FOOD = ("fridge", "counter_top", "dining_table")
TEMPLATES: dict[str, tuple[str, ...]] = {
    "apple": _FOOD,
    "tomato": _FOOD,
    "lettuce": _FOOD,
    "book": ("bed", "desk", "sofa", "coffee_table"),
    "remote_control": ("sofa", "tv_stand", "bed"),
    "mug": ("counter_top", "dining_table", "desk"),
}
"""The 19 task templates: the destinations of each target."""


class MobileManipulation(TaskKind):
    """ "Pick an apple and place it in a fridge." """

    name = "mobile_manipulation"
    short = "manipulation"
    t_star_base = rules.T_STAR_BASE_S
    t_star_slowness = rules.T_STAR_SLOWNESS

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        present = {thing.kind for thing in house.things}
        return tuple(
            Goal(target=target, relation=_relation(destination), destination=destination)
            for target in catalog.TARGETS
            for destination in TEMPLATES[target]
            if destination in present
        )

    def objection(self, goal: Goal, house: HouseSpec) -> str:
        present = {thing.kind for thing in house.things if catalog.kind(thing.kind).receptacle}
        if goal.destination not in present:
            return f"no thing of kind '{goal.destination}' to place it; the house has {', '.join(sorted(present))}"
        if goal.relation != _relation(goal.destination):
            return f"relation is '{goal.relation}', expected '{_relation(goal.destination)}' for '{goal.destination}'"
        return ""

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        target = catalog.kind(target_of(goal, objects).kind)
        destination = catalog.kind(goal.destination)
        return f"Pick {target.indefinite} and place it {goal.relation} {destination.indefinite}."

    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        target = snapshot.things[task.goal.target]
        if target.held_by or not target.support:
            return False
        return kind_of(target.support, house) == task.goal.destination

    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:
        return kind_of(target_of(goal, objects).support, house) == goal.destination

    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:
        from hthor.tasks.arrangement.reachability import ReachableFloor

        target = target_of(goal, objects)
        opening = [kind_of(target.support, house) if target.relation == "in" else "", goal.destination]
        doors = sum(1 for kind in opening if kind and catalog.kind(kind).hides)
        ground = ReachableFloor.of(house)
        walk = ground.walk([ground.touching(target), ground.serving(goal.destination)])
        handling = (2 + doors) * rules.HANDLING_S
        return lambda starts: walk.lengths(starts) / rules.PACE_M_S + handling


def _relation(destination: str) -> Literal["on", "in"]:
    return catalog.kind(destination).relation


KIND = MobileManipulation()
