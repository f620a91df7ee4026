"""What a validation found, as one document: every number that the page and the terminal show; draws nothing.

Fractions are fractions, times are seconds, trust is 1 to 7. ``condition`` is none, frontier or oracle.
"""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from hthor.calibration.pipeline.evidence import Band, Evidence

SCHEMA = "hthor.validation/1"
TOLERANCE = {"sr": 0.04, "twsr": 0.04, "adoption": 0.07}
"""How far a median may lie from the published figure."""
QUARTILE_S = 7.0
"""Lower quartiles of the time spent that differ by less than this count as equal."""
Verdict = Literal["passed", "failed", "not judged"]


class Subject(Struct, frozen=True, kw_only=True):
    """The people under test. ``population`` is the name of theirs, empty where the model has none."""

    name: str
    model: str
    sha256: str
    population: str = ""
    population_sha256: str = ""
    purpose: str = ""
    notes: tuple[str, ...] = ()


class Setting(Struct, frozen=True, kw_only=True):
    """What was played: so many people in each condition, ``trials`` trials in all three together.

    ``quick``: too few people for a verdict on what was played.
    """

    suite: str
    suite_sha256: str
    simulation: int
    seed: int
    participants: int
    trials: int
    code_sha256: str
    versions: dict[str, str]
    quick: bool = False


class Count(Struct, frozen=True, kw_only=True):
    """A published share ``k`` of ``n`` trials; ``inferred`` where the article prints only the percentage."""

    figure: str
    k: int
    n: int
    inferred: bool
    note: str = ""


class Published(Struct, frozen=True, kw_only=True):
    """The published study: its counts, TWSR over SR by condition, what it says in words, and the eight figures."""

    name: str
    source: str
    sha256: str
    counts: tuple[Count, ...]
    ratio: dict[str, float]
    verbal: tuple[tuple[str, str], ...]
    """(what it is about, what it says)."""
    figures: dict[str, float]
    design: str = ""
    """How the study was made, a sentence."""


class Predicted(Struct, frozen=True, kw_only=True):
    """A published figure against simulated study groups of six people: their median and 90 % interval.

    ``mean`` is that of all trials played, ``percentile`` the share of groups below the published figure (half of those
    equal to it counted in).
    """

    figure: str
    published: float
    band: Band
    mean: float
    percentile: float
    tolerance: float

    @property
    def covered(self) -> bool:
        """Whether the interval holds the published figure."""
        return self.band.low <= self.published <= self.band.high

    @property
    def close(self) -> bool:
        """Whether the median is as near as asked for."""
        return abs(self.band.median - self.published) <= self.tolerance + 1e-9


class Spent(Struct, frozen=True, kw_only=True):
    """Time spent in one condition [s], over all trials; an unsolved trial counts with the time limit."""

    condition: str
    trials: int
    least: float
    lower: float
    median: float
    upper: float
    most: float


class Difference(Struct, frozen=True, kw_only=True):
    """By how much a statistic of the time spent [s] is larger in condition ``a`` than in ``b``.

    ``value`` is that of all trials; ``group`` the median and 90 % interval among simulated study groups.
    """

    statistic: Literal["lower quartile", "minimum"]
    a: str
    b: str
    value: float
    group: Band


class Reach(Struct, frozen=True, kw_only=True):
    """How adoption came about in one condition: share of trials in which a message was shown to the person, and share
    of those in which one was confirmed (None when none was shown).
    """

    condition: str
    shown: float
    confirmed: float | None


class Curve(Struct, frozen=True, kw_only=True):
    """Trust by trial in one condition: means, their standard errors, and how many people rated each.

    ``slope`` is the mean over people of the least-squares slope [points a trial], ``slope_se`` its standard error.
    """

    condition: str
    mean: tuple[float, ...]
    se: tuple[float, ...]
    people: tuple[int, ...]
    slope: float
    slope_se: float


class Trust(Struct, frozen=True, kw_only=True):
    """Trust over a session. ``gap`` is oracle less frontier over all trials, ``above`` at how many it is positive.

    ``groups_above`` is the share of simulated study groups in which it is positive at every trial, ``groups_rising``
    that in which trust in the oracle rises.
    """

    curves: tuple[Curve, ...]
    gap: float
    gap_se: float
    above: int
    groups_above: float
    groups_rising: float


class Played(Struct, frozen=True, kw_only=True):
    """A human model's figures on a suite: means over its trials, None where there are none."""

    name: str
    figures: dict[str, float | None]
    trials: int


class Rival(Struct, frozen=True, kw_only=True):
    """A human model's log score [nats] of each condition's published counts and ratio, and the figures behind it."""

    played: Played
    log_score: dict[str, float]


class Gate(Struct, frozen=True, kw_only=True):
    """A bar: what it asks, what was found, and whether that passed."""

    name: str
    asks: str
    found: str
    verdict: Verdict


class Findings(Struct, frozen=True, kw_only=True):
    """The whole validation. ``evidence`` is None for a human model that was not calibrated."""

    schema: str = SCHEMA
    subject: Subject
    setting: Setting
    published: Published
    table: tuple[Predicted, ...]
    spent: tuple[Spent, ...]
    differences: tuple[Difference, ...]
    reach: tuple[Reach, ...]
    trust: Trust | None
    own: Rival
    rivals: tuple[Rival, ...] = ()
    kinds: tuple[Played, ...] = ()
    suites: tuple[Played, ...] = ()
    evidence: Evidence | None = None
    evidence_missing: str = ""
    """Why there is no evidence, a sentence."""
    gates: tuple[Gate, ...] = ()
    misfits: tuple[str, ...] = ()
    scope: str = ""
