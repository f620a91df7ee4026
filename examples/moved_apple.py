"""A kind of task with a phase of one's own: people see the apple, then somebody moves it behind their backs.

hthor eval --kind examples/moved_apple.py --agent oracle
"""

import msgspec

from hthor import seeds
from hthor.errors import HthorError
from hthor.tasks.arrangement.free_spots import find_spot
from hthor.tasks.arrangement.target_arrangement import arrange
from hthor.tasks.subgoals import JobKind
from hthor.types import Goal, HouseSpec, Job, Phase, Placement, TaskSpec, Thing

TABLE, BEFORE_S = "dining_table", 40.0


class MovedApple(JobKind):
    """Whoever looked around knows where the apple was; nobody knows that it is not there any more."""

    name = "moved_apple"  # the file's name
    short = "moved"
    crew = ("tender",)

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        """Bring the apple to the dining table, where the house has one."""
        if TABLE not in {thing.kind for thing in house.things}:
            return ()
        jobs = (Job(target="apple", relation="on", destinations=(TABLE,)),)
        return (Goal(target="apple", relation="on", destination=TABLE, jobs=jobs),)

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:  # noqa: ARG002
        """What the person and the robots are told."""
        return "Put the apple on the dining table."

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        """The apple's second place; `phases` says what the house looked like before."""
        if not (goals := self.goals(house)):
            raise HthorError(f"house '{house.id}' has no {TABLE}")
        before = arrange(house, root, {"apple": TABLE})
        first = next(one for one in before if one.id == "apple")

        def weigh(thing: Thing) -> float:
            return float(thing.kind != TABLE and thing.id != first.support)

        moved = find_spot(house, "apple", "apple", weigh, seeds.derive(root, "moved"), before)
        if moved is None:
            raise HthorError(f"house '{house.id}' has no second place for the apple")
        after = (moved if one.id == "apple" else one for one in before)
        return goals[0], tuple(msgspec.structs.replace(one, near="") for one in after)

    def phases(self, task: TaskSpec, house: HouseSpec, root: int) -> tuple[Phase, ...]:
        """Forty seconds to look around; then only the apple moves, and everybody stays where they are."""
        first = next(one for one in arrange(house, root, {"apple": TABLE}) if one.id == "apple")
        before = tuple(first if one.id == "apple" else one for one in task.objects)
        words = "Look around; you will need the apple."
        return (Phase(name="before", instruction=words, time_limit=BEFORE_S, objects=before, restarts=False),)


KIND = MovedApple()
