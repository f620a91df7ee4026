"""What a calibration came to, as data for programs; computes nothing."""

from __future__ import annotations

from msgspec import Struct

from hthor.calibration.diagnostics.acceptance import Gate
from hthor.calibration.simulation.budget import Sizes

SCHEMA = "hthor.calibration/1"


class Span(Struct, frozen=True, kw_only=True):
    """Median and 90 % interval."""

    low: float
    median: float
    high: float


class Foretold(Struct, frozen=True, kw_only=True):
    """A published figure and what is foretold of studies, all in per cent.

    ``prior`` and ``posterior`` come from the emulator; ``simulated`` from whole studies of people of the posterior in
    the real world.
    """

    figure: str
    published: float
    prior: Span
    posterior: Span
    simulated: Span


class Learned(Struct, frozen=True, kw_only=True):
    """What the published numbers say of a parameter, in its unit.

    ``contraction`` is 1 - variance of the posterior / variance of the prior, of its quantile in the prior; ``word``
    says whether that makes it known; ``recovery`` is the correlation of truth and estimate over simulated studies.
    """

    name: str
    unit: str
    fitted: bool
    grade: str
    prior: Span
    posterior: Span
    contraction: float
    word: str
    recovery: float


class Summary(Struct, frozen=True, kw_only=True):
    """A calibration's result.

    Attributes:
        population: path of the population's JSON in the calibration's folder, and its hash.
    """

    schema: str = SCHEMA
    target: str
    target_sha256: str
    suite: str
    suite_sha256: str
    seed: int
    sizes: Sizes
    trials: int
    effective: float
    population: str
    population_sha256: str
    figures: tuple[Foretold, ...]
    parameters: tuple[Learned, ...]
    design_effects: dict[str, float]
    gates: tuple[Gate, ...]

    @property
    def passed(self) -> bool:
        """Whether every gate was passed."""
        return all(gate.passed for gate in self.gates)
