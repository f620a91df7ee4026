"""What a seat is told before a trial, and what it observes in it."""

from collections.abc import Sequence

from hthor import plugins, rules
from hthor.comms.display import DisplayState
from hthor.comms.display_contents import display_contents
from hthor.comms.mailbox import Mailbox
from hthor.episode.trial_world import TrialWorld
from hthor.tasks.kind import TaskKind
from hthor.types import Briefing, Observation, PhaseBriefing, TaskSpec


def make_briefing(
    task: TaskSpec, world: TrialWorld, seats: Sequence[str], seat: str, privileges: tuple[str, ...]
) -> Briefing:
    """The briefing of a seat; ``seats`` are all that take part, ``privileges`` those of its agent."""
    kind: TaskKind = plugins.load("task kind", task.kind)
    goal = kind.told_goal(task)
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
        phases=tuple(
            PhaseBriefing(name=phase.name, instruction=phase.instruction, time_limit=phase.time_limit)
            for phase in task.phases
        ),
        labels=tuple(world.label_kinds) if "pixel_labels" in privileges else (),
    )


def make_observation(
    world: TrialWorld,
    mailbox: Mailbox,
    display: DisplayState | None,
    seat: str,
    privileges: tuple[str, ...],
    phase: str,
    *,
    frozen: bool,
) -> Observation:
    """What a seat observes now.

    Args:
        phase: name of the present phase, empty in the task itself.
        frozen: whether its sensors still show this moment when the world has gone on.
    """
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
        truth=world.truth() if "object_poses" in privileges and not phase else (),
        display=None if display is None else display_contents(display, mailbox, world.pose),
        phase=phase,
    )
