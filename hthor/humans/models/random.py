"""A person who searches without any plan and never confirms a message: chance picks among the options, all alike.

With `hthor.humans.models.greedy` it brackets what real people may do: no robot can help such a person by what it says,
so what still differs between two robots is how much they stand in the way. Eyes, memory, legs and hands are those of
any person of the population (`hthor.humans.models.proxy`), with their differences; messages are read, and declined.
"""

from __future__ import annotations

from hthor import seeds
from hthor.humans.core.policy import Answer, Offer, Situation
from hthor.humans.models import proxy
from hthor.types import Briefing


class Model(proxy.Model):
    """The random person."""

    def begin(self, briefing: Briefing) -> None:
        """A trial begins, with luck of its own."""
        self.policy = Whim(seeds.derive(self.person.trial(self.trials), "whim"))
        super().begin(briefing)


class Whim:
    """Chooses by luck alone, each option by its own, and declines everything."""

    def __init__(self, root: int) -> None:
        self.root = root

    def choose(self, situation: Situation) -> int:
        """The luckiest."""
        luck = [seeds.draw(self.root, situation.aim, situation.number, choice.name) for choice in situation.options]
        return luck.index(max(luck))

    def answer(self, offer: Offer) -> Answer:  # noqa: ARG002  whatever it says
        """No."""
        return "decline"
