"""A human who searches at random and never accepts a message.

With `hthor.humans.models.greedy` it brackets what real people may do: no robot can help such a human by messages, so
robots differ only in how much they stand in the way. Eyes, memory, legs and hands are the proxy's, with the
population's differences between people; messages are read, and declined.
"""

from hthor import seeds
from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.models import proxy
from hthor.types import Briefing


class Model(proxy.Model):
    """The random human."""

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with random numbers of its own."""
        self.policy = RandomPolicy(seeds.derive(self.participant.trial_root(self.trials), "whim"))
        super().begin(briefing)


class RandomPolicy:
    """Chooses by a random number for each option, and declines everything."""

    def __init__(self, root: int) -> None:
        self.root = root

    def choose(self, situation: Situation) -> int:
        """The option with the largest random number."""
        luck = [seeds.draw(self.root, situation.aim, situation.number, option.name) for option in situation.options]
        return luck.index(max(luck))

    def answer(self, offer: Offer) -> Answer:  # noqa: ARG002  always the same
        """Decline every message."""
        return "decline"
