"""What a calibration found out about its own population, as data.

Figures are named ``sr none``, ``twsr oracle``, ``adoption frontier`` and so on, and are fractions, not per cent. A
predicted figure is always that of one group of the published study: six people, ten tasks each.
"""

from __future__ import annotations

from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.calibration.simulation.trial_table import CONDITIONS
from hthor.errors import RunError

SCHEMA = "hthor.evidence/1"
FILE = "evidence.json"
FIGURES = (
    *(f"{metric} {condition}" for metric in ("sr", "twsr") for condition in CONDITIONS),
    "adoption frontier",
    "adoption oracle",
)
"""The eight published figures; nobody can adopt a robot that is not there."""


class Band(Struct, frozen=True, kw_only=True):
    """Median of a distribution and an interval around it; where it stands says of which probability."""

    low: float
    median: float
    high: float


class Predictive(Struct, frozen=True, kw_only=True):
    """A published figure before and after the fit: medians and 90 % intervals of study groups.

    ``prior`` and ``posterior`` are foretold by the emulator, ``simulated`` is what whole studies of people of the
    posterior showed in the real world. ``design_effect`` is the variance of that figure over that of independent
    trials, None where the fit does not look at it.
    """

    figure: str
    prior: Band
    posterior: Band
    simulated: Band | None = None
    design_effect: float | None = None


class HeldFigure(Struct, frozen=True, kw_only=True):
    """A figure of a condition that was left out of the fit; ``band`` is its predicted median and 80 % interval."""

    figure: str
    published: float
    band: Band

    @property
    def inside(self) -> bool:
        """Whether the published figure lies inside the interval."""
        return self.band.low <= self.published <= self.band.high


class HeldOut(Struct, frozen=True, kw_only=True):
    """A condition left out: what the other two predict of it.

    ``log_score`` and ``log_score_prior`` are log predictive densities [nats] of its published counts and ratio, after
    a fit on ``fitted`` and before any; ``rivals`` has those of simple human models, by name.
    """

    condition: str
    fitted: tuple[str, ...]
    figures: tuple[HeldFigure, ...]
    log_score: float
    log_score_prior: float
    rivals: dict[str, float] = {}


class ParameterFinding(Struct, frozen=True, kw_only=True):
    """What the published numbers say of one parameter; ``prior`` and ``posterior`` are 90 % bands in its own unit.

    ``contraction`` is 1 - posterior variance / prior variance in the unit cube. ``recovery`` is the correlation of true
    values and posterior means over simulated studies, ``coverage`` the share of them whose 90 % interval held the
    truth, ``ranks`` a histogram of the truth's rank among posterior draws (flat when the posterior is honest).
    ``fitted``: whether the calibration means to move it; all are sampled.
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


class Coverage(Struct, frozen=True, kw_only=True):
    """Simulated studies fitted like the published one: how often the 90 % interval held the true value."""

    studies: int
    mean: float
    low: float
    high: float
    """Lowest and highest of any parameter."""


class Emulated(Struct, frozen=True, kw_only=True):
    """How well an emulator foretells trials that it was not trained on, one outcome in one condition.

    ``z_sd`` is the standard deviation of its standardised errors on whole simulated studies. ``score`` is its mean log
    score a held-out trial and ``baseline`` that of always saying the mean [nats]. ``bins`` are (said, came, trials).
    """

    outcome: str
    condition: str
    z_sd: float | None = None
    score: float | None = None
    baseline: float | None = None
    bins: tuple[tuple[float, float, int], ...] = ()


class Shift(Struct, frozen=True, kw_only=True):
    """By how much ABC's posterior median of a parameter differs from ours, in our posterior standard deviations.

    ``error`` is the standard error of that shift: ABC rests on few simulated studies.
    """

    name: str
    shift: float
    error: float | None = None


class Swing(Struct, frozen=True, kw_only=True):
    """What a parameter does to a gap between robots when it alone goes from a low to a high quantile of its prior.

    ``low`` and ``high`` are the mean gaps in SR at either end; ``ordered`` the share of draws at the worse end in which
    the better robot is ahead.
    """

    name: str
    better: str
    worse: str
    low: float
    high: float
    ordered: float | None = None


class Ranking(Struct, frozen=True, kw_only=True):
    """How often posterior draws rank the robots oracle over frontier over none.

    ``sr``, ``twsr`` and ``both`` are shares of the draws, each judged on ``trials`` trials a robot, chance and all;
    ``expected`` those of the draws in which the robots' true rates are in that order, by the same names; ``pairs`` has
    the share of each pair, such as ``sr oracle>frontier``.
    """

    suite: str
    draws: int
    trials: int
    sr: float
    twsr: float
    both: float
    expected: dict[str, float] = {}
    pairs: dict[str, float] = {}
    swings: tuple[Swing, ...] = ()


class Origin(Struct, frozen=True, kw_only=True):
    """What the calibration was made of."""

    population_sha256: str
    targets_sha256: str
    suite: str
    suite_sha256: str
    simulation: int
    seed: int
    trials: int
    draws: int
    effective: float
    """Effective number of posterior draws."""
    quick: bool = False


class Evidence(Struct, frozen=True, kw_only=True):
    """Everything that a calibration can say of the population that it made. Empty parts were not worked out."""

    schema: str = SCHEMA
    origin: Origin
    predictive: tuple[Predictive, ...] = ()
    simulated_studies: int = 0
    held_out: tuple[HeldOut, ...] = ()
    parameters: tuple[ParameterFinding, ...] = ()
    coverage: Coverage | None = None
    emulator_z: float | None = None
    """Standard deviation of the emulator's standardised errors over all eight figures of whole simulated studies."""
    emulated: tuple[Emulated, ...] = ()
    abc: tuple[Shift, ...] = ()
    rankings: tuple[Ranking, ...] = ()


def encode(evidence: Evidence) -> bytes:
    """The evidence as a file for people and programs."""
    return jsonio.pretty(evidence)


def load(path: Path) -> Evidence:
    """The evidence in a file, or in the calibration's folder that holds it.

    Raises:
        RunError: when there is none, or it cannot be read.
    """
    file = path / FILE if path.is_dir() else path
    if not file.is_file():
        raise RunError(f"{path}: there is no {FILE}. Finish the calibration with 'hthor calibrate --out {path}'.")
    return documents.read(file, Evidence, RunError, schema=SCHEMA, hint="make it again with 'hthor calibrate'")
