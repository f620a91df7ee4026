"""No robot: the control condition."""

from __future__ import annotations

from hthor.types import Action, Briefing, Observation, Wait


class Agent:
    """No robot. The person does the task alone."""

    absent = True
    privileges: tuple[str, ...] = ()

    def begin(self, briefing: Briefing) -> None:
        """Nothing to prepare."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Stand still, for the case that a body is there after all."""
        return Action(motion=Wait(seconds=1.0))
