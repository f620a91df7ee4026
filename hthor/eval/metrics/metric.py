"""What a metric is: how it is measured in a trial, what it is called, and which values it can have."""

import inspect
import math
from collections.abc import Callable, Sequence

from msgspec import UNSET, Struct, UnsetType

from hthor.episode.recording.episode_log import EpisodeLog
from hthor.types import TrialSpec

DIGITS = 6
"""Decimals that are kept of a trial's value, so that a record reads the same on every machine."""
Range = tuple[float, float]
AMOUNTS: Range = (0.0, math.inf)
"""The range of counts and other amounts without an upper bound."""
HIGHER, LOWER = "higher", "lower"

Value = float | int | None
"""A trial's value; None where the metric has none, as precision without a claim."""


class Trial(Struct, frozen=True):
    """A trial and everything that happened in it."""

    spec: TrialSpec
    log: EpisodeLog

    @property
    def people(self) -> tuple[str, ...]:
        """The seats of the people who took part."""
        return tuple(human.seat for human in self.spec.humans)


Formula = Callable[[Trial], Value | dict[str, float]]


class Unit(Struct, frozen=True, kw_only=True):
    """The unit in which values are shown: ``scale`` times the value, in ``name``; differences in ``difference``."""

    name: str = ""
    difference: str = ""
    scale: float = 1.0
    limits: Range = AMOUNTS


SHARE = Unit(name="%", difference="points", scale=100.0, limits=(0.0, 1.0))
SECONDS = Unit(name="s", difference="s")
NUMBER = Unit()


class Metric(Struct, frozen=True):
    """One metric: everything that results, tables, comparisons, reports and the documentation say about it.

    Attributes:
        name: its key in `trials.jsonl` and `result.json`.
        title: its name in tables. short: a shorter title for narrow columns. abbreviation: as in papers, such as TWSR.
        formula: the function that computes a trial's value; its docstring is the metric's documentation.
        unit: the unit in which values are shown. decimals: the number of decimals in a report.
        better: "higher" or "lower"; empty where neither is better.
        rank: the place in tables, the lowest first.
        main: whether every table and comparison has it; others are counted in detail (`hthor score --all`).
        section: the part of a report that has it, "messages" or "bodies"; every metric that is not main has one.
        part_of: the metric of which this metric counts a part; tables show this one indented below it.
        by_seat: whether a trial has several values, by name of a seat or of a pair of seats.
        several: whether only trials of several people have it; other records leave it out.
        needs_robot: whether it has no value in a trial without a robot.
        optional: whether tables leave it out where no trial has a value.
        limits: the least and the greatest value, by default those of its unit.
        timed: whether the time limit [s] of the trial is a bound too.
    """

    name: str
    title: str
    formula: Formula
    short: str = ""
    abbreviation: str = ""
    unit: Unit = NUMBER
    decimals: int = 1
    better: str = ""
    rank: int = 1000
    main: bool = False
    section: str = ""
    part_of: str = ""
    by_seat: bool = False
    several: bool = False
    needs_robot: bool = False
    optional: bool = False
    limits: Range | None = None
    timed: bool = False

    @property
    def bounds(self) -> Range:
        """The least and the greatest value, time limits aside."""
        return self.limits or self.unit.limits

    @property
    def doc(self) -> str:
        """What the metric measures in one trial, from its formula's docstring."""
        return inspect.getdoc(self.formula) or ""

    @property
    def brief(self) -> str:
        """The title for narrow columns."""
        return self.short or self.title

    @property
    def symbol(self) -> str:
        """The abbreviation, or the title of a metric that has none."""
        return self.abbreviation or self.title

    @property
    def heading(self) -> str:
        """The title with its unit, such as "time spent [s]"."""
        return f"{self.title} [{self.unit.name}]" if self.unit.name else self.title

    @property
    def gain(self) -> str:
        """The name of an improvement, with its unit, such as "time saved [s]"."""
        return f"{self.brief}{' saved' if self.better == LOWER else ''} [{self.unit.difference}]"

    @property
    def is_share(self) -> bool:
        """Whether values are shares of something, from 0 to 1."""
        return self.unit == SHARE

    @property
    def sign(self) -> float:
        """1, or -1 for a metric whose lower values are better."""
        return -1.0 if self.better == LOWER else 1.0

    def measure(self, trial: Trial) -> Value | dict[str, float] | UnsetType:
        """The value in one trial, rounded to `DIGITS`; None, an empty dict or unset where the metric has no value."""
        if self.several and len(trial.people) == 1:
            return UNSET
        if self.needs_robot and not trial.spec.robots:
            return {} if self.by_seat else None
        value = self.formula(trial)
        if isinstance(value, dict):
            return {name: round(one, DIGITS) for name, one in value.items()}
        return round(value, DIGITS) if isinstance(value, float) else value

    def range(self, limit_s: float | None = None) -> Range:
        """The range of a mean over trials with this mean time limit [s]; without a limit, a time has no upper bound."""
        return (self.bounds[0], limit_s) if self.timed and limit_s is not None else self.bounds

    def range_of(self, values: Sequence[float], limits: Sequence[float]) -> Range:
        """The range of the mean of these values, for the time limits [s] of their trials."""
        kept = all(value <= limit for value, limit in zip(values, limits, strict=True))
        return self.range(mean_limit(limits) if kept and limits else None)

    def width(self, limit_s: float | None = None) -> float:
        """How far apart two means can be at most; infinite where there is no bound."""
        low, high = self.range(limit_s)
        return high - low


def mean_limit(limits: Sequence[float]) -> float:
    """The mean of time limits [s]; exact where all are equal."""
    return limits[0] if len(set(limits)) == 1 else math.fsum(limits) / len(limits)
