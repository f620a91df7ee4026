"""A calibration's result as data for programs."""

from msgspec import Struct

from hthor.calibration.diagnostics.acceptance import Gate
from hthor.calibration.evidence import Band
from hthor.calibration.pipeline.config import CalibrationSizes

SCHEMA = "hthor.calibration/1"


class FigureSummary(Struct, frozen=True, kw_only=True):
    """A published figure and what is predicted of studies: medians and 90 % intervals, all in per cent.

    ``prior`` and ``posterior`` come from the emulator, ``simulated`` from whole studies simulated with people of the
    posterior.
    """

    figure: str
    published: float
    prior: Band
    posterior: Band
    simulated: Band


class ParameterSummary(Struct, frozen=True, kw_only=True):
    """What the published numbers say of a parameter, in its unit: medians and 90 % intervals.

    ``contraction`` is 1 - variance of the posterior / variance of the prior, of its quantile in the prior; ``word``
    says whether that makes it known; ``recovery`` is the correlation of truth and estimate over simulated studies.
    """

    name: str
    unit: str
    fitted: bool
    grade: str
    prior: Band
    posterior: Band
    contraction: float
    word: str
    recovery: float


class CalibrationSummary(Struct, frozen=True, kw_only=True):
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
    sizes: CalibrationSizes
    trials: int
    effective: float
    population: str
    population_sha256: str
    figures: tuple[FigureSummary, ...]
    parameters: tuple[ParameterSummary, ...]
    design_effects: dict[str, float]
    gates: tuple[Gate, ...]

    @property
    def passed(self) -> bool:
        """Whether every gate was passed."""
        return all(gate.passed for gate in self.gates)
