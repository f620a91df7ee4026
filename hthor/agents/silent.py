"""No robot: the control condition."""

from hthor.types import Action, Briefing, Observation, Ready, Wait


class Agent:
    """No robot: the person does the task alone."""

    absent = True
    privileges: tuple[str, ...] = ()

    def begin(self, briefing: Briefing) -> None:
        """Do nothing."""

    def act(self, observation: Observation) -> Action:
        """Stand still, if there is a body, always ready for the next phase."""
        return Action(motion=Wait(seconds=1.0), signals=(Ready(),) if observation.phase else ())
