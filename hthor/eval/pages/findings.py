"""What several runs say together, as one document: every number that the report shows; draws and computes nothing.

Fractions are fractions, times are seconds, trust is 1 to 7.
"""

from __future__ import annotations

import math
from typing import Literal

from msgspec import Struct

from hthor.eval.peoples import HumansRef
from hthor.eval.score import Scores
from hthor.eval.setup import AssetsRef, KindRef, SuiteRef
from hthor.eval.stats import Estimate
from hthor.types import RobotSeat

SCHEMA = "hthor.report/1"
NONE = "no robot"


class Share(Struct, frozen=True, kw_only=True):
    """A published share ``k`` of ``n`` trials; ``inferred`` where the study prints only the percentage."""

    k: int
    n: int
    inferred: bool = False

    @property
    def ci95(self) -> tuple[float, float]:
        """Wilson's interval: all that is known of these trials is how many there were."""
        z, share = 1.959964, self.k / self.n
        middle = (share + z * z / (2 * self.n)) / (1 + z * z / self.n)
        half = z / (1 + z * z / self.n) * math.sqrt(share * (1 - share) / self.n + z * z / (4 * self.n * self.n))
        return (middle - half, middle + half)


class Published(Struct, frozen=True, kw_only=True):
    """What a study printed: figures as fractions by name, such as "sr none", and the counts behind some of them.

    ``suite`` is the name of the suite that has its tasks.
    """

    name: str
    source: str
    sha256: str
    suite: str
    figures: dict[str, float]
    counts: dict[str, Share]


class Arm(Struct, frozen=True, kw_only=True):
    """One run's robots with the report's people: ``label`` is their name on the page.

    ``condition`` is none, frontier or oracle where the paper had such a robot, else empty; ``folder`` the run's name.
    """

    label: str
    condition: str
    folder: str
    trials: int
    people: int
    tasks: int
    unfinished: int
    scores: Scores


class Uplift(Struct, frozen=True, kw_only=True):
    """What a run's robots change against no robot, over the same people at the same tasks in the same order.

    ``pairs`` is how many trials both runs have. ``sr``, ``twsr`` and ``saved_s`` are differences, positive where the
    robots help.
    """

    arm: str
    pairs: int
    sr: Estimate
    twsr: Estimate
    saved_s: Estimate
    wins: int
    losses: int


class Spent(Struct, frozen=True, kw_only=True):
    """Time spent in one run [s]; an unsolved trial counts with the time limit. ``unsolved`` of ``trials`` did."""

    arm: str
    trials: int
    least: float
    lower: float
    median: float
    upper: float
    most: float
    unsolved: int


class Curve(Struct, frozen=True, kw_only=True):
    """Trust by trial of the session: means, their standard errors over people, and how many people rated each.

    ``slope`` is the mean over people of the least-squares slope [points a trial], ``slope_se`` its standard error;
    None where fewer than two people rated two trials.
    """

    arm: str
    trial: tuple[int, ...]
    mean: tuple[float, ...]
    se: tuple[float | None, ...]
    people: tuple[int, ...]
    slope: float | None
    slope_se: float | None


class Group(Struct, frozen=True, kw_only=True):
    """Success within one part of the trials, such as hard tasks, by the arm's label."""

    name: str
    sr: dict[str, Estimate]


class Split(Struct, frozen=True, kw_only=True):
    """All trials parted by one thing; ``word`` says by what."""

    word: str
    groups: tuple[Group, ...]


class Shown(Struct, frozen=True, kw_only=True):
    """A trial worth a map. ``gain_s`` is the time saved [s] against the same person without a robot, None without one.

    ``replay`` is the command that draws it whole.
    """

    arm: str
    rank: Literal["best", "worst"]
    key: str
    task: str
    instruction: str
    house: str
    participant: int
    index: int
    met: bool
    time_s: float
    t_star: float
    alone_met: bool | None
    alone_s: float | None
    gain_s: float | None
    replay: str


class Failure(Struct, frozen=True, kw_only=True):
    """One way in which a run's robots failed: in how many trials, and the first of them."""

    run: str
    seat: str
    agent: str
    kind: str
    trials: int
    key: str
    task: str
    after_s: float
    last: str
    replay: str


class Origin(Struct, frozen=True, kw_only=True):
    """Where one run came from: everything that decides its records. ``name`` is that of its folder."""

    name: str
    agent: str
    robots: tuple[RobotSeat, ...]
    humans: HumansRef
    suite: SuiteRef
    kind: KindRef | None
    seed: int
    participants: int
    trials: int
    whole: int
    faulty: int
    assets: AssetsRef
    versions: dict[str, str]
    run_sha256: str
    rules_sha256: str
    code_sha256: str
    trials_sha256: str


class Findings(Struct, frozen=True, kw_only=True):
    """The whole document.

    ``people`` are those whom most of the report is of; ``by_people`` has all. ``baseline`` is the label of the run
    without a robot, empty where there is none.
    """

    schema: str = SCHEMA
    suite: SuiteRef
    people: str
    baseline: str
    published: Published | None
    arms: tuple[Arm, ...]
    uplift: tuple[Uplift, ...]
    spent: tuple[Spent, ...]
    trust: tuple[Curve, ...]
    splits: tuple[Split, ...]
    by_people: Split | None
    shown: tuple[Shown, ...]
    failures: tuple[Failure, ...]
    origins: tuple[Origin, ...]
