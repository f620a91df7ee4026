"""Between-subjects studies: which people meet which condition.

By default every robot meets the same people, as only simulated people can. In a between-subjects study everybody meets
one condition, as in the published study (P): 18 people in 3 groups of 6. No robot is a condition like the others.
"""

import math
from collections.abc import Sequence

from msgspec import Struct

from hthor import seeds
from hthor.errors import HthorError

PAIRED, BETWEEN = "paired", "between"


class StudyDesign(Struct, frozen=True, kw_only=True, tag_field="name", tag=BETWEEN):
    """The between-subjects study that a run is one condition of.

    Attributes:
        conditions: the agents of all conditions, as the command line names them, sorted.
        condition: the run's own, its index among these.
        participants: how many people take part in all conditions together.
    """

    conditions: tuple[str, ...]
    condition: int
    participants: int

    @property
    def study(self) -> str:
        """The study as a whole, in words; equal for all its conditions."""
        return f"{BETWEEN} subjects, {self.participants} people, conditions {', '.join(self.conditions)}"

    def sessions(self, seed: int, people: int) -> tuple[int, ...]:
        """The numbers of the sessions of the run's own condition; ``people`` are together in each."""
        groups = assign_conditions(self.participants // people, len(self.conditions), seed)
        return tuple(number for number, condition in enumerate(groups) if condition == self.condition)


def assign_conditions(sessions: int, conditions: int, seed: int) -> tuple[int, ...]:
    """The condition of each session, by block randomisation.

    Every block of as many sessions as there are conditions has each condition once, in an order drawn for that block
    alone. So groups never differ by more than one session, and sessions that are added later change no earlier one.
    """
    found: list[int] = []
    for block in range(math.ceil(sessions / conditions)):
        found += seeds.shuffled(conditions, seed, "condition", conditions, block)
    return tuple(found[:sessions])


def plan_study(
    conditions: Sequence[str], own: str, *, participants: int | None, sessions_each: int, people: int
) -> StudyDesign:
    """The design of one condition's run.

    Args:
        conditions: the agents of all conditions. own: the run's.
        participants: how many people in all; None for so many that every condition does every task once.
        sessions_each: how many sessions that takes. people: how many are together in a session.

    Raises:
        HthorError: when there are fewer than two conditions, or too few people for them.
    """
    ordered = tuple(sorted(conditions))
    if len(ordered) < 2:
        raise HthorError(
            "--design between compares groups of people, and there is one condition only. Name another --agent, or "
            "leave out --no-control, so that a group without a robot is added."
        )
    total = len(ordered) * sessions_each * people if participants is None else participants
    if total % people or total // people < len(ordered):
        raise HthorError(
            f"--participants {total}: {len(ordered)} conditions with {people} in every trial need a multiple of "
            f"{people}, and {len(ordered) * people} at least."
        )
    return StudyDesign(conditions=ordered, condition=ordered.index(own), participants=total)
