"""Carry a trunk, too heavy for one body, to another room together.

The goal has one job, which needs two bodies with hands (see `hthor.world.carrying.joint_carrying` for the rules)::

    Job(target="trunk", relation="at", destinations=("room|5",), place=(2.4, 6.1, 0.2), hands=2)

At first the trunk stands on the floor of another room, where two bodies can take its ends, whoever comes first
(`hthor.tasks.arrangement.handle_access`). It has arrived when it stands in the destination room, in nobody's hands,
within `hthor.tasks.jobs.TOGETHER_M` of the place, which is next to a piece of furniture that the instruction names.
Progress is the share of the straight distance that the trunk has covered.
"""

import math

from hthor import catalog, seeds
from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.tasks.arrangement.free_spots import find_floor_spot, unique_things
from hthor.tasks.arrangement.handle_access import are_ends_accessible
from hthor.tasks.job_times import carrying_way
from hthor.tasks.subgoals import JobKind
from hthor.types import Goal, HouseSpec, Job, Placement, Snapshot, TaskSpec

TRUNK = "trunk"
BESIDE = ("sofa", "bed", "dining_table", "desk", "tv_stand", "coffee_table", "armchair", "dresser", "wardrobe")
"""Kinds of things that the trunk is brought to, if the house has exactly one of the kind."""
CLEAR_M = 0.6
"""Radius of free floor around the trunk's middle."""
LEAST_M, MOST_M = 4.0, 14.0
"""Bounds of the walking distance from within reach of the trunk to its destination."""
TIME_LIMIT_S = 180.0
"""Twice the usual limit: two bodies have to meet first, and then walk slowly, with a load and round corners."""
_TRIES = 240


class CollaborativeCarrying(JobKind):
    """ "Carry the trunk to the bedroom, beside the bed. It takes two." """

    name = "collaborative_carrying"
    short = "carry"
    crew = ("porter",)
    time_limit = TIME_LIMIT_S
    medium_from, hard_from = 31.0, 36.0

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        trunk = catalog.kind(next(placement.kind for placement in objects if placement.id == goal.target))
        return f"Carry {trunk.definite} to {catalog.kind(goal.destination).definite} and put it down. It takes two."

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        marks, rooms = unique_things(house, BESIDE), {room.id: room for room in house.rooms}
        for attempt in range(_TRIES if marks else 0):
            own = seeds.derive(root, "try", attempt)
            mark = marks[seeds.choice([1.0] * len(marks), own, "mark")]
            areas = [abs(plane.signed_area(room.polygon)) for room in house.rooms]
            room = house.rooms[seeds.choice(areas, own, "room")]
            if room.id == mark.room or mark.room not in rooms:
                continue
            start = find_floor_spot(house, TRUNK, TRUNK, room, CLEAR_M, seeds.derive(own, "start"))
            end = find_floor_spot(house, TRUNK, TRUNK, rooms[mark.room], CLEAR_M, seeds.derive(own, "end"), near=mark)
            goal = _goal(mark.kind, mark.room, end) if start and end else None
            if (
                start
                and goal
                and are_ends_accessible(house, start)
                and LEAST_M <= carrying_way(house, start, goal.jobs[0]) <= MOST_M
            ):
                return goal, (start,)
        raise HthorError(
            f"house '{house.id}' has no two rooms with enough floor to carry a trunk from one to the other"
        )

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: HouseSpec) -> float:
        if self.met(task, snapshot, house):
            return 1.0
        (job,), trunk = task.goal.jobs, snapshot.things.get(task.goal.target)
        start = next(placement.position for placement in task.objects if placement.id == job.target)
        if trunk is None or job.place is None:
            return 0.0
        way = math.dist(start[:2], job.place[:2])
        return min(max(1.0 - math.dist(trunk.position[:2], job.place[:2]) / way, 0.0), 0.99) if way else 0.0


def _goal(kind: str, room: str, end: Placement) -> Goal:
    job = Job(target=TRUNK, relation="at", destinations=(room,), place=end.position, hands=2)
    return Goal(target=TRUNK, relation="at", destination=kind, jobs=(job,))


KIND = CollaborativeCarrying()
