"""The findings of a calibration about its population: records that its stages make and the validation report shows.

Figures are named ``sr none``, ``twsr oracle``, ``adoption frontier`` and so on, and are fractions, not percentages. A
predicted figure is always that of one group of the published study: six people with ten tasks each.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from msgspec import Struct

from hthor import documents, jsonio
from hthor.calibration.targets import CONDITIONS
from hthor.errors import RunError

SCHEMA = "hthor.evidence/1"
FILE = "evidence.json"
FIGURES = (
    *(f"{metric} {condition}" for metric in ("sr", "twsr") for condition in CONDITIONS),
    *(f"adoption {condition}" for condition in CONDITIONS[1:]),
)
"""The eight published figures; without a robot there is no adoption."""
TOLERANCE = {"sr": 0.04, "twsr": 0.04, "adoption": 0.07}
"""Largest distance of a predicted figure's median from the published figure, by metric. Our choice."""
BAND90 = (0.05, 0.5, 0.95)
"""Quantiles of a 90 % interval and its median."""
_Record = TypeVar("_Record", bound=Struct)


class Band(Struct, frozen=True, kw_only=True):
    """Median of a distribution and an interval around it; its probability is given where the band is used."""

    low: float
    median: float
    high: float


class PredictedFigure(Struct, frozen=True, kw_only=True):
    """A published figure before and after the fit: medians and 90 % intervals of study groups.

    ``prior`` and ``posterior`` are predicted by the emulator, ``simulated`` comes from whole studies with people of the
    posterior. ``design_effect`` is the variance over that of independent trials, None if the fit does not use one.
    """

    figure: str
    prior: Band
    posterior: Band
    simulated: Band | None = None
    design_effect: float | None = None


class HeldOutFigure(Struct, frozen=True, kw_only=True):
    """A published figure and its predicted interval (80 % when the fit left out the figure's condition)."""

    figure: str
    published: float
    band: Band

    @property
    def inside(self) -> bool:
        """Whether the published figure lies inside the interval."""
        return self.band.low <= self.published <= self.band.high

    @property
    def close(self) -> bool:
        """Whether the median is within the tolerance."""
        return abs(self.band.median - self.published) <= TOLERANCE[self.figure.split()[0]]


class HeldOutCondition(Struct, frozen=True, kw_only=True):
    """A condition left out of the fit, and its prediction from the other two.

    ``log_score`` and ``log_score_prior`` are log predictive densities [nats] of its published counts and ratio, after
    a fit to the conditions ``fitted`` and before any fit; ``rivals`` has the densities by simple human models.
    """

    condition: str
    fitted: tuple[str, ...]
    figures: tuple[HeldOutFigure, ...]
    log_score: float
    log_score_prior: float
    rivals: dict[str, float] = {}


class ParameterFinding(Struct, frozen=True, kw_only=True):
    """What the published numbers say about a parameter; ``prior`` and ``posterior`` are 90 % bands in its own unit.

    ``contraction`` is 1 - posterior variance / prior variance in the unit cube. ``recovery`` is the correlation of true
    values and posterior means over simulated studies, ``coverage`` the share of studies whose 90 % interval has the
    truth, ``ranks`` a histogram of the truth's rank among posterior draws (flat when the posterior is calibrated).
    ``fitted``: whether the published numbers are expected to change it; all parameters are sampled.
    """

    name: str
    unit: str
    meaning: str
    grade: str
    fitted: bool
    prior: Band
    posterior: Band
    contraction: float
    recovery: float | None = None
    coverage: float | None = None
    ranks: tuple[int, ...] = ()


class CoverageFinding(Struct, frozen=True, kw_only=True):
    """Share of simulated studies whose 90 % interval has the truth; ``low``, ``high``: the range over parameters."""

    studies: int
    mean: float
    low: float
    high: float


class EmulatorFit(Struct, frozen=True, kw_only=True):
    """How well an emulator predicts trials that it was not trained on: one outcome in one condition.

    ``z_sd`` is the sd of standardised errors on whole simulated studies, ``score`` the mean log score per trial and
    ``baseline`` the score of always predicting the mean [nats]; ``bins`` are (predicted frequency, observed, trials).
    """

    outcome: str
    condition: str
    z_sd: float | None = None
    score: float | None = None
    baseline: float | None = None
    bins: tuple[tuple[float, float, int], ...] = ()


class AbcShift(Struct, frozen=True, kw_only=True):
    """Distance of ABC's posterior median from ours, and its standard ``error``, in our posterior sds."""

    name: str
    shift: float
    error: float | None = None


class ParameterSwing(Struct, frozen=True, kw_only=True):
    """The change of a gap between robots when one parameter alone moves from a low to a high quantile of its prior.

    ``low`` and ``high`` are mean gaps in SR at the two ends, ``ordered`` the share of draws in order at the worse end.
    """

    name: str
    better: str
    worse: str
    low: float
    high: float
    ordered: float | None = None


class RobotRanking(Struct, frozen=True, kw_only=True):
    """How often posterior draws rank the robots oracle over frontier over none.

    ``sr``, ``twsr`` and ``both`` are shares of the draws, each judged on ``trials`` noisy trials with each robot;
    ``expected`` has the shares of draws whose true rates have that order, by the same names;
    ``pairs`` has the share of each pair, such as ``sr oracle>frontier``.
    """

    suite: str
    draws: int
    trials: int
    sr: float
    twsr: float
    both: float
    expected: dict[str, float] = {}
    pairs: dict[str, float] = {}
    swings: tuple[ParameterSwing, ...] = ()


class Origin(Struct, frozen=True, kw_only=True):
    """The inputs of the calibration; ``effective`` is the effective number of posterior draws."""

    population_sha256: str
    targets_sha256: str
    suite: str
    suite_sha256: str
    simulation: int
    seed: int
    trials: int
    draws: int
    effective: float
    quick: bool = False


class Evidence(Struct, frozen=True, kw_only=True):
    """Everything that a calibration says about the population that it made. Empty parts were not computed.

    ``emulator_z`` is the sd of the emulator's standardised errors over all eight figures of whole simulated studies.
    """

    schema: str = SCHEMA
    origin: Origin
    predictive: tuple[PredictedFigure, ...] = ()
    simulated_studies: int = 0
    held_out: tuple[HeldOutCondition, ...] = ()
    parameters: tuple[ParameterFinding, ...] = ()
    coverage: CoverageFinding | None = None
    emulator_z: float | None = None
    emulated: tuple[EmulatorFit, ...] = ()
    abc: tuple[AbcShift, ...] = ()
    rankings: tuple[RobotRanking, ...] = ()


def band(values: Sequence[float] | np.ndarray) -> Band:
    """A band of three numbers: low, median, high."""
    low, median, high = (float(value) for value in values)
    return Band(low=low, median=median, high=high)


def rounded(record: _Record, digits: int) -> _Record:
    """The record with every number in it rounded, and never -0.0."""
    return msgspec.convert(_rounded(msgspec.to_builtins(record), digits), type(record))


def _rounded(value: Any, digits: int) -> Any:
    if isinstance(value, float):
        return round(value, digits) + 0.0
    if isinstance(value, dict):
        return {name: _rounded(part, digits) for name, part in value.items()}
    return [_rounded(part, digits) for part in value] if isinstance(value, (list, tuple)) else value


def encode_evidence(evidence: Evidence) -> bytes:
    """The evidence as a file for people and programs."""
    return jsonio.pretty(evidence)


def load_evidence(path: Path) -> Evidence:
    """The evidence in a file, or in the folder of a calibration.

    Raises:
        RunError: when there is no evidence, or it cannot be read.
    """
    file = path / FILE if path.is_dir() else path
    if not file.is_file():
        raise RunError(f"{path}: there is no {FILE}. Finish the calibration with 'hthor calibrate --out {path}'.")
    return documents.read(file, Evidence, RunError, schema=SCHEMA, hint="make it again with 'hthor calibrate'")
