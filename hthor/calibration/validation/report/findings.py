"""The findings of a validation as one document: every number that the page and the terminal show.

Fractions are fractions, times are seconds, trust is 1 to 7. ``condition`` is none, frontier or oracle.
"""

from typing import Literal

from msgspec import Struct

from hthor.calibration.evidence import Band, Evidence, HeldOutFigure

SCHEMA = "hthor.validation/1"
QUARTILE_S = 7.0
"""Difference [s] below which two lower quartiles of the time spent count as equal."""
Verdict = Literal["passed", "failed", "not judged"]


class ModelUnderTest(Struct, frozen=True, kw_only=True):
    """The human model under test. ``population`` is the name of its population, empty without one."""

    name: str
    model: str
    sha256: str
    population: str = ""
    population_sha256: str = ""
    purpose: str = ""
    notes: tuple[str, ...] = ()


class Setting(Struct, frozen=True, kw_only=True):
    """The runs and their number of participants per condition; ``quick``: too few people for a verdict on the runs."""

    suite: str
    suite_sha256: str
    simulation: int
    seed: int
    participants: int
    trials: int
    code_sha256: str
    versions: dict[str, str]
    quick: bool = False


class PublishedCount(Struct, frozen=True, kw_only=True):
    """A published share ``k`` of ``n`` trials; ``inferred`` if the article prints only the percentage."""

    figure: str
    k: int
    n: int
    inferred: bool
    note: str = ""


class PublishedStudy(Struct, frozen=True, kw_only=True):
    """The published study, as in `Targets`; ``figures`` are the eight published figures."""

    name: str
    source: str
    sha256: str
    counts: tuple[PublishedCount, ...]
    ratio: dict[str, float]
    verbal: tuple[tuple[str, str], ...]
    """(topic, statement)."""
    figures: dict[str, float]
    design: str = ""


class FigurePrediction(HeldOutFigure, frozen=True, kw_only=True):
    """A published figure against simulated study groups of six people: their median and 90 % interval.

    ``mean`` is the figure over all trials, ``percentile`` the share of groups below the published figure (equal groups
    count half).
    """

    mean: float
    percentile: float
    tolerance: float

    @property
    def close(self) -> bool:
        """Whether the median is within the tolerance."""
        return abs(self.band.median - self.published) <= self.tolerance + 1e-9


class TimeSpent(Struct, frozen=True, kw_only=True):
    """Time spent in one condition [s], over all trials; an unsolved trial counts with the time limit."""

    condition: str
    trials: int
    least: float
    lower: float
    median: float
    upper: float
    most: float


class TimeDifference(Struct, frozen=True, kw_only=True):
    """How much larger a statistic of the time spent [s] is in condition ``a`` than in ``b``.

    ``value`` is the difference over all trials; ``group`` the median and 90 % interval among simulated study groups.
    """

    statistic: Literal["lower quartile", "minimum"]
    a: str
    b: str
    value: float
    group: Band


class MessageReach(Struct, frozen=True, kw_only=True):
    """How adoption arises: share of trials with a message shown, and share of these with one accepted, if any."""

    condition: str
    shown: float
    accepted: float | None


class TrustCurve(Struct, frozen=True, kw_only=True):
    """Trust by trial in one condition: means, their standard errors, and how many people rated each.

    ``slope`` is the mean over people of the least-squares slope [points per trial], ``slope_se`` its standard error.
    """

    condition: str
    mean: tuple[float, ...]
    se: tuple[float, ...]
    people: tuple[int, ...]
    slope: float
    slope_se: float


class TrustFindings(Struct, frozen=True, kw_only=True):
    """Trust over a session. ``gap`` is oracle minus frontier over all trials, positive in ``above`` of the trials.

    ``groups_above`` is the share of groups in which it is always positive, ``groups_rising`` with rising oracle trust.
    """

    curves: tuple[TrustCurve, ...]
    gap: float
    gap_se: float
    above: int
    groups_above: float
    groups_rising: float


class ModelFigures(Struct, frozen=True, kw_only=True):
    """A human model's figures on a suite: means over its trials, None without trials."""

    name: str
    figures: dict[str, float | None]
    trials: int


class ModelScore(Struct, frozen=True, kw_only=True):
    """A human model's log score [nats] of each condition's published counts and ratio, and the model's figures."""

    played: ModelFigures
    log_score: dict[str, float]


class Gate(Struct, frozen=True, kw_only=True):
    """A criterion: its requirement (``asks``), the finding, and the verdict."""

    name: str
    asks: str
    found: str
    verdict: Verdict


class Findings(Struct, frozen=True, kw_only=True):
    """The whole validation. ``evidence`` is None for a human model that was not calibrated."""

    schema: str = SCHEMA
    subject: ModelUnderTest
    setting: Setting
    published: PublishedStudy
    table: tuple[FigurePrediction, ...]
    spent: tuple[TimeSpent, ...]
    differences: tuple[TimeDifference, ...]
    reach: tuple[MessageReach, ...]
    trust: TrustFindings | None
    own: ModelScore
    rivals: tuple[ModelScore, ...] = ()
    kinds: tuple[ModelFigures, ...] = ()
    suites: tuple[ModelFigures, ...] = ()
    evidence: Evidence | None = None
    evidence_missing: str = ""
    """A sentence that says why there is no evidence."""
    gates: tuple[Gate, ...] = ()
    misfits: tuple[str, ...] = ()
    scope: str = ""
