"""No robot: the control condition."""

from hthor.types import Action, Briefing, Observation, Wait


class Agent:
    """No robot: the person does the task alone."""

    absent = True
    privileges: tuple[str, ...] = ()

    def begin(self, briefing: Briefing) -> None:
        """Do nothing."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Stand still, if there is a body."""
        return Action(motion=Wait(seconds=1.0))
