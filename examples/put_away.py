"""A kind of task of one's own: bring the tomato and the lettuce into the fridge.

hthor eval --kind examples/put_away.py --agent oracle
"""

from hthor import catalog
from hthor.errors import HthorError
from hthor.tasks.arrangement.target_arrangement import arrange
from hthor.tasks.subgoals import JobKind
from hthor.types import Goal, HouseSpec, Job, Placement

FOOD = ("tomato", "lettuce")
PLACE = "fridge"


class PutAway(JobKind):
    """Done when both are in a fridge; each is half of the progress."""

    name = "put_away"  # the file's name
    short = "away"  # stands for it in the tasks' ids
    crew = ("tender",)  # who helps unless --robot or --robots says otherwise

    def goals(self, house: HouseSpec) -> tuple[Goal, ...]:
        """The one goal there is, where the house has a fridge."""
        if PLACE not in {thing.kind for thing in house.things}:
            return ()
        jobs = tuple(Job(target=food, relation="in", destinations=(PLACE,)) for food in FOOD)
        return (Goal(target=FOOD[0], relation="in", destination=PLACE, jobs=jobs),)

    def instruction(self, goal: Goal, objects: tuple[Placement, ...]) -> str:
        """What the person and the robots are told."""
        kinds = {placement.id: placement.kind for placement in objects}
        return f"Put {' and '.join(catalog.kind(kinds[job.target]).definite for job in goal.jobs)} in the fridge."

    def draw(self, house: HouseSpec, root: int) -> tuple[Goal, tuple[Placement, ...]]:
        """Everything lies where the scene priors put it, but for the food, which is not in the fridge yet."""
        goals = self.goals(house)
        if not goals:
            raise HthorError(f"house '{house.id}' has no {PLACE}")
        return goals[0], arrange(house, root, dict.fromkeys(FOOD, PLACE))


KIND = PutAway()
