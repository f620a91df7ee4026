"""One participant: who they are, and the roots of their random numbers."""

from msgspec import Struct

from hthor import seeds
from hthor.humans.population.parameters import Parameters


class Participant(Struct, frozen=True, kw_only=True):
    """Participant ``number`` of the study with this ``seed``, with these ``traits``.

    The same seed and number from the same population are the same participant, whichever robots they meet.
    """

    seed: int
    number: int
    traits: Parameters = Parameters()

    @property
    def root(self) -> int:
        """Root of all random numbers of this participant; never depends on the robots."""
        return participant_root(self.seed, self.number)

    def trial_root(self, index: int) -> int:
        """Root of the random numbers of trial ``index``, from 0."""
        return seeds.derive(self.root, "trial", index)


def participant_root(seed: int, number: int) -> int:
    """Root of all random numbers of participant ``number`` of a study."""
    return seeds.derive(seed, "participant", number)
