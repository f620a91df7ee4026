"""One person: who they are, and how chance treats them."""

from __future__ import annotations

from msgspec import Struct

from hthor import seeds
from hthor.humans.population.parameters import Parameters


class Person(Struct, frozen=True, kw_only=True):
    """Participant number ``participant`` of the study with this ``seed``, with these ``traits``.

    The same seed and number out of the same population are the same person, whoever they meet.
    """

    seed: int
    participant: int
    traits: Parameters = Parameters()

    @property
    def root(self) -> int:
        """Root of everything that chance decides about this person; never depends on the robots."""
        return root(self.seed, self.participant)

    def trial(self, index: int) -> int:
        """Root of the chances of this person's trial number ``index``."""
        return seeds.derive(self.root, "trial", index)


def root(seed: int, participant: int) -> int:
    """Root of all chances of a participant of a study."""
    return seeds.derive(seed, "participant", participant)
