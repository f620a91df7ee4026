"""A participant's trust in the robots: a Beta distribution, updated by trials.

The law is from Guo and Yang (2021): experience adds to two counts, trust with large counts changes less, and bad
experience may weigh more than good. The worth of an experience also depends on the trial's outcome, whoever caused it
(outcome bias: Yang, Schemanske and Searle 2021). Their contrast effect (help counts for more if the participant would
have failed alone) is left out: no data say how a participant would have done alone.
"""

from __future__ import annotations

import math

from msgspec import Struct

from hthor import rules
from hthor.humans.population.parameters import Parameters

LATE_HELP = 0.5
"""[share] Worth of help that comes very late in a trial; immediate help is worth 1. Our choice."""


class Trust(Struct, frozen=True, kw_only=True):
    """Beta(``alpha``, ``beta``): counts of good and of bad experience."""

    alpha: float
    beta: float

    @property
    def mean(self) -> float:
        """Mean trust, between 0 and 1."""
        return self.alpha / (self.alpha + self.beta)

    def after(self, signal: float, traits: Parameters) -> Trust:
        """Trust after an experience worth ``signal``, from 0 (misled) to 1 (helped at once)."""
        worth = min(1.0, max(0.0, signal))
        return Trust(alpha=self.alpha + traits.w_s * worth, beta=self.beta + traits.w_f * (1.0 - worth))

    def report(self, noise: float, traits: Parameters) -> int:
        """The rating on the scale from 1 to 7; ``noise`` is a standard normal number."""
        span = rules.TRUST_MAX - rules.TRUST_MIN
        rating = math.floor(rules.TRUST_MIN + span * self.mean + traits.sd_report * noise + 0.5)
        return min(rules.TRUST_MAX, max(rules.TRUST_MIN, rating))


def initial_trust(traits: Parameters) -> Trust:
    """Trust before the first trial."""
    return Trust(alpha=traits.mu0 * traits.n0, beta=(1.0 - traits.mu0) * traits.n0)


class Experience(Struct, kw_only=True):
    """What the robots did in one trial; ``helped`` [s] is when the first useful message was accepted, if any."""

    offered: bool = False
    helped: float | None = None
    misled: bool = False

    def signal(self, met: bool, traits: Parameters) -> float:
        """Worth of the robots in this trial, 0 to 1; ``met`` is whether the trial was successful."""
        if self.helped is not None:
            worth = LATE_HELP + (1.0 - LATE_HELP) * math.exp(-self.helped / traits.tau_s)
        elif self.misled:
            worth = 0.0
        else:
            worth = traits.s_offered if self.offered else 0.0
        return worth if met else worth * traits.s_failed
