"""A report as one document: every number that the page shows.

Fractions are fractions, times are seconds, trust is 1 to 7.
"""

import math
from typing import Literal

from msgspec import Struct

from hthor.eval.comparison.comparison import Comparison
from hthor.eval.config.run_config import SuiteRef
from hthor.eval.results.scores import Scores
from hthor.eval.statistics.intervals import Estimate
from hthor.report.analysis.run_provenance import Provenance


class ExampleTrial(Struct, frozen=True, kw_only=True):
    """A trial to draw on a map; ``replay`` is the command that draws the whole trial.

    ``gain_s`` is the time saved [s] against the same people without a robot, None if there is no such trial.
    """

    arm: str
    rank: Literal["best", "worst"]
    key: str
    task: str
    instruction: str
    house: str
    session: int
    index: int
    met: bool
    time_s: float
    t_star: float
    alone_met: bool | None
    alone_s: float | None
    gain_s: float | None
    replay: str


class FaultGroup(Struct, frozen=True, kw_only=True):
    """Faults of one kind in a run: ``trials`` of its ``whole`` trials had one. The rest is about the first such trial.

    ``detail`` is the traceback or a description of the fault, ``output`` the agent's last printed text; either is empty
    if the run did not keep it. ``again`` is the command that plays the trial again, ``replay`` the one that draws it.
    """

    run: str
    seat: str
    agent: str
    kind: str
    trials: int
    whole: int
    key: str
    task: str
    session: int
    index: int
    after_s: float
    detail: str
    output: str
    again: str
    replay: str


SCHEMA = "hthor.report/4"


class Share(Struct, frozen=True, kw_only=True):
    """A published share, ``k`` of ``n`` trials; ``inferred`` if ``k`` was computed from a published percentage."""

    k: int
    n: int
    inferred: bool = False

    @property
    def ci95(self) -> tuple[float, float]:
        """Wilson's interval, because nothing but the two counts is known of these trials."""
        z, share = 1.959964, self.k / self.n
        middle = (share + z * z / (2 * self.n)) / (1 + z * z / self.n)
        half = z / (1 + z * z / self.n) * math.sqrt(share * (1 - share) / self.n + z * z / (4 * self.n * self.n))
        return (middle - half, middle + half)


class Published(Struct, frozen=True, kw_only=True):
    """A study's published figures: fractions by name, such as "sr none", and the counts behind some of them.

    ``suite`` is the name of the suite with the study's tasks.
    """

    name: str
    source: str
    sha256: str
    suite: str
    figures: dict[str, float]
    counts: dict[str, Share]


class Arm(Struct, frozen=True, kw_only=True):
    """One run with the human population of the report; ``label`` is the name of its robots on the page.

    ``condition`` is none, frontier or oracle if the article had such a robot, else empty. ``folder`` is the run's name.
    """

    label: str
    condition: str
    folder: str
    trials: int
    people: int
    tasks: int
    unfinished: int
    scores: Scores


class IncomparablePair(Struct, frozen=True, kw_only=True):
    """Two runs that share no trial. ``field`` is the run config field that differs, or empty if trials are missing."""

    first: str
    second: str
    field: str


class TimeSpent(Struct, frozen=True, kw_only=True):
    """Time spent in one run [s]. Of its ``trials``, the ``unsolved`` ones count with the time limit.

    ``solved`` is the share of trials that were solved within 0, 1, 2, ... seconds.
    """

    arm: str
    trials: int
    least: float
    lower: float
    median: float
    upper: float
    most: float
    unsolved: int
    solved: tuple[float, ...]


class TrustCurve(Struct, frozen=True, kw_only=True):
    """Trust after each trial of the session: means, their 95 % intervals, and how many sessions have a rating.

    ``slope`` is the mean over sessions of the least-squares slope [points per trial], ``slope_se`` its standard error;
    both are None if fewer than two sessions have two ratings. A trial of several people counts with their mean.
    """

    arm: str
    trial: tuple[int, ...]
    mean: tuple[float, ...]
    ci95: tuple[tuple[float, float], ...]
    sessions: tuple[int, ...]
    slope: float | None
    slope_se: float | None


class Group(Struct, frozen=True, kw_only=True):
    """Success within one part of the trials, such as hard tasks: one estimate for each run's label."""

    name: str
    sr: dict[str, Estimate]


class Split(Struct, frozen=True, kw_only=True):
    """All trials divided into groups by one property, such as difficulty; ``word`` names the property."""

    word: str
    groups: tuple[Group, ...]


class Findings(Struct, frozen=True, kw_only=True):
    """The whole document.

    ``people`` is the human population that most of the report is about; ``by_people`` has success with all populations.
    ``baseline`` is the label of the run without a robot, empty if there is none. ``comparisons`` are between runs with
    ``people``, by label, the baseline first; ``apart`` has the pairs of runs that cannot be compared. ``people_uplift``
    has the comparisons with the baseline for each population.
    """

    schema: str = SCHEMA
    suite: SuiteRef
    people: str
    baseline: str
    published: Published | None
    arms: tuple[Arm, ...]
    comparisons: tuple[Comparison, ...]
    apart: tuple[IncomparablePair, ...]
    spent: tuple[TimeSpent, ...]
    trust: tuple[TrustCurve, ...]
    splits: tuple[Split, ...]
    by_people: Split | None
    people_uplift: dict[str, tuple[Comparison, ...]]
    shown: tuple[ExampleTrial, ...]
    failures: tuple[FaultGroup, ...]
    origins: tuple[Provenance, ...]

    @property
    def uplift(self) -> tuple[Comparison, ...]:
        """The comparisons of each robot with no robot."""
        return tuple(pair for pair in self.comparisons if self.baseline and pair.first == self.baseline)
