"""Find an object: done when a person has it in view from close by.

The least time is the time of a person who knows all places:

- a walk at `rules.PACE_M_S` along the shortest path of a body of the avatar's radius, from the start to the first
  standing cell from which the target is seen: its centre is at most `rules.FIND_RANGE_M` from the eyes, measured in
  space, and no wall or furniture lies between the eyes and its centre or a point near its top;
- for a target in a closed fridge: by way of a cell within reach of the fridge, plus `rules.HANDLING_S` to open it, and
  the target is then seen as if the fridge had no door;
- less the slack of the 5 cm grid (half a cell's diagonal per range and per leg), so that it is a lower bound.

Turning, recognising and reading cost nothing.
"""

# ruff: noqa: ARG002 - a search does not need the house; the signatures are those of every kind

from hthor import catalog, rules
from hthor.tasks.kind import LeastTimes, TaskKind, target_of
from hthor.types import Goal, HouseSpec, Placement, Snapshot, TaskSpec


class ObjectGoalNavigation(TaskKind):
    """ "Find an apple." """

    name = "object_goal_navigation"
    short = "navigation"
    t_star_base = rules.T_STAR_BASE_S
    t_star_slowness = rules.T_STAR_SLOWNESS

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        return tuple(Goal(target=target, relation="find") for target in catalog.TARGETS)

    def objection(self, goal: Goal, house: HouseSpec) -> str:
        if goal.relation != "find" or goal.destination:
            return f"a search has relation 'find' and no destination, got '{goal.relation}' and '{goal.destination}'"
        return ""

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        return f"Find {catalog.kind(target_of(goal, objects).kind).indefinite}."

    def met(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> bool:
        target, view = task.goal.target, snapshot.in_view
        for person in view:  # noqa: SIM110 - twice as fast as a generator, and called at every tick
            if target in view[person]:
                return True
        return False

    def solved(self, goal: Goal, objects: tuple[Placement, ...], house: HouseSpec) -> bool:
        return False

    def least_times(self, house: HouseSpec, objects: tuple[Placement, ...], goal: Goal) -> LeastTimes:
        from hthor.tasks.arrangement.reachability import ReachableFloor

        target = target_of(goal, objects)
        ground = ReachableFloor.of(house)
        holder = next((thing for thing in house.things if thing.id == target.support), None)
        if holder is not None and target.relation == "in" and catalog.kind(holder.kind).hides:
            stops = [ground.beside(holder), ground.seeing(target, frozenset({holder.id}))]
            walk, handling = ground.walk(stops), rules.HANDLING_S
        else:
            walk, handling = ground.walk([ground.seeing(target)]), 0.0
        return lambda starts: walk.lengths(starts) / rules.PACE_M_S + handling


KIND = ObjectGoalNavigation()
