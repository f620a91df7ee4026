"""The document that `hthor compare` gives, and the runs that it is made from."""

from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.eval.config.run_config import RunConfig, SuiteRef
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results.paired_difference import Difference, McNemar
from hthor.eval.statistics.intervals import LEVEL

SCHEMA = "hthor.compare/1"


class WinCounts(Struct, frozen=True, kw_only=True):
    """Trials in which the second robot's time-weighted success was higher, the same, and lower."""

    wins: int
    ties: int
    losses: int


class GroupSize(Struct, frozen=True, kw_only=True):
    """How many trials and people a group of a between-subjects study has."""

    trials: int
    people: int


class ComparedRun(Struct, frozen=True, kw_only=True):
    """One of the runs: its name, its folder's name, its trials so far and planned, and its configuration's hash.

    Trials that a correction voided for good are not planned any more.

    ``voided`` counts attempts at trials that were voided and do not count, ``corrections`` the corrections in effect;
    they are absent if there are none.
    """

    name: str
    folder: str
    trials: int
    planned: int
    run: str
    voided: int | msgspec.UnsetType = msgspec.UNSET
    corrections: int | msgspec.UnsetType = msgspec.UNSET


class Comparison(Struct, frozen=True, kw_only=True):
    """The second run compared with the first.

    Attributes:
        n: how many trials both runs have; ``dropped``: how many of the first and of the second have no partner. For
            groups of a between-subjects study, the trials of both; none is dropped.
        groups_of: set for such groups only, which had different people: the sizes of both. ``mcnemar`` and ``tally``
            are then None, as no trial has a partner.
        tasks, people, sessions: how many different tasks, people and sessions these trials have.
        differences: the difference in each metric, by its name.
        groups: differences in success by "kind", "split", "difficulty" and "scene", where there are several of these.
        among: how many pairs of runs are compared at once; the verdict is adjusted for this number.
        p_holm: the p-value of the difference in success, adjusted for these comparisons by Holm's method.
        level, interval: the interval of the difference in success that belongs to the verdict, and its level: 0.95 for
            one pair, higher for several pairs. It excludes 0 exactly when one run is better.
        better: the name of the run that is better in success; empty when these data cannot tell.
        sentence: the verdict in words.
    """

    first: str
    second: str
    n: int
    dropped: tuple[int, int]
    tasks: int
    people: int
    sessions: int
    differences: dict[str, Difference]
    groups_of: tuple[GroupSize, GroupSize] | msgspec.UnsetType = msgspec.UNSET
    mcnemar: McNemar | None
    tally: WinCounts | None
    groups: dict[str, dict[str, Difference]]
    among: int = 1
    p_holm: float | None
    level: float = LEVEL
    interval: tuple[float, float] | None = None
    better: str
    sentence: str

    @property
    def success(self) -> Difference:
        """The difference in success with the p-value and the interval of the verdict."""
        return msgspec.structs.replace(self.differences["sr"], ci95=self.interval, p=self.p_holm)


class Comparisons(Struct, frozen=True, kw_only=True):
    """The document that `hthor compare` gives: every pair of runs, in the order in which they were named."""

    schema: str = SCHEMA
    suite: SuiteRef
    seed: int
    runs: tuple[ComparedRun, ...]
    pairs: tuple[Comparison, ...]

    @property
    def worse(self) -> tuple[Comparison, ...]:
        """The comparisons in which a run is worse than the first run."""
        baseline = self.runs[0].name
        return tuple(pair for pair in self.pairs if pair.first == pair.better == baseline)


class LoadedRun(Struct, frozen=True, kw_only=True):
    """A run read from its folder, with a name that no other run here has."""

    name: str
    folder: Path
    plan: RunConfig
    records: tuple[ScoredTrial, ...]
    voided: int = 0
    corrections: int = 0
    given_up: int = 0
