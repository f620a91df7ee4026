"""How much a calibration simulates and draws."""

from __future__ import annotations

from msgspec import Struct


class Sizes(Struct, frozen=True, kw_only=True):
    """Numbers of sessions of ten trials, of whole studies, and of draws.

    Attributes:
        sessions: all over the prior, for the emulator's training.
        correction: near the first posterior, for its second training; 0 for none.
        studies: at points of the prior, for coverage, design effects and the check by ABC.
        posterior_studies: at draws of the posterior: what people of the population really do.
        members: nets in the emulator's ensemble.
        draws: of the population. proposals: of the importance sampling.
        quick: whether this is the small calibration, which proves that everything works and is not for use.
    """

    sessions: int = 4000
    correction: int = 1000
    studies: int = 200
    posterior_studies: int = 60
    members: int = 6
    draws: int = 1000
    proposals: int = 1 << 18
    quick: bool = False


FULL = Sizes()
QUICK = Sizes(
    sessions=120,
    correction=0,
    studies=10,
    posterior_studies=1,
    members=4,
    draws=400,
    proposals=1 << 14,
    quick=True,
)
