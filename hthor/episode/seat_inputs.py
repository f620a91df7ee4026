"""What a seat is told before a trial, and what it observes in it."""

from collections.abc import Sequence

from hthor import rules
from hthor.comms.mailbox import Mailbox
from hthor.episode.trial_world import TrialWorld
from hthor.types import Briefing, Observation, TaskSpec


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


def make_observation(
    world: TrialWorld, mailbox: Mailbox, seat: str, privileges: tuple[str, ...], *, frozen: bool
) -> Observation:
    """What a seat observes now; ``frozen``: its sensors still show this moment when the world has gone on."""
    return Observation(
        tick=world.tick,
        pose=world.pose(seat),
        idle=world.idle(seat),
        senses=world.frozen_senses(seat) if frozen else world.senses(seat),
        room=world.room(seat),
        holding=world.holding(seat),
        outcome=world.outcome(seat),
        inbox=mailbox.inbox(seat),
        receipt=mailbox.receipt(seat),
        truth=world.truth() if "object_poses" in privileges else (),
    )
