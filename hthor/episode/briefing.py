"""What an agent or a human model is told before a trial."""

from collections.abc import Sequence

from hthor import rules
from hthor.episode.trial_world import TrialWorld
from hthor.types import Briefing, TaskSpec


def make_briefing(
    task: TaskSpec, world: TrialWorld, seats: Sequence[str], seat: str, privileges: tuple[str, ...]
) -> Briefing:
    """The briefing of a seat; ``seats`` are all that take part, ``privileges`` those of its agent."""
    goal = task.goal
    return Briefing(
        seat=seat,
        instruction=task.instruction,
        target=goal.target,
        destination=goal.destination,
        relation=goal.relation,
        body=world.bodies[seat],
        tick_s=rules.TICK_S,
        time_limit=task.time_limit,
        teammates=tuple(other for other in seats if other != seat),
        privileges=privileges,
        house=world.house if "house_map" in privileges else None,
        kind=task.kind,
        jobs=goal.todo,
        crew=dict(world.bodies),
    )
