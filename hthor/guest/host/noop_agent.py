"""An agent that does nothing, to try out how agents are held."""

from hthor.types import Action, Briefing, Observation


class Agent:
    """Stands still."""

    def begin(self, _: Briefing) -> None:
        """Nothing to prepare."""

    def act(self, _: Observation) -> Action:
        """Nothing."""
        return Action()
