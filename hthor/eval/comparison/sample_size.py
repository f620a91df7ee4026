"""How large a study must be, from two success rates or from two runs."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import HthorError
from hthor.eval.comparison import compare
from hthor.eval.comparison.comparison import LoadedRun
from hthor.eval.results import group_difference, paired_difference, pairing
from hthor.eval.results.paired_difference import Noise
from hthor.eval.statistics import power
from hthor.eval.statistics.power import SampleSize, Scatter

SCHEMA = "hthor.power/2"
USUAL = 0.5
"""Correlation that is assumed when none was measured; docs/statistics.md has measured values."""


class StudyPlan(Struct, frozen=True, kw_only=True):
    """Sample sizes to detect a difference of two success rates, paired (same participants and tasks) and unpaired.

    For two runs, ``shared`` is how many trials they share, and ``more`` how many more tasks would show the difference,
    as in `hthor compare`; None if two rates were given.
    """

    schema: str = SCHEMA
    first: float
    second: float
    measured: bool
    paired: SampleSize
    unpaired: SampleSize
    shared: int | None = None
    more: int | None = None
    sentence: str


class _Known(Struct, frozen=True):
    """Two rates and the correlation of outcomes; for two runs also the scatter and the number of shared trials."""

    first: float
    second: float
    correlation: float | None = None
    noise: Noise | None = None
    shared: int | None = None


def plan_study(
    folders: Sequence[Path], rates: str, correlation: float | None, difference: float | None, wanted: float
) -> StudyPlan:
    """The plan for two runs, or for two rates as the user typed them.

    Raises:
        HthorError: unless exactly one of the two is given, or when a rate or the correlation is impossible.
    """
    if bool(folders) == bool(rates) or len(folders) not in (0, 2):
        raise HthorError("name two runs, hthor power RUN RUN, or two rates, hthor power --rates 0.73,0.76; not both.")
    known = _measured(folders) if folders else _rates(rates)
    first, second = known.first, known.second if difference is None else known.first + difference
    power.check_rates(first, second)
    low, high = power.correlation_range(first, second)
    if correlation is None:
        correlation = min(USUAL, high) if known.correlation is None else min(max(low, known.correlation), high)
    paired, unpaired = _needs(known, first, second, correlation, wanted)
    more = None if known.shared is None else max(0, paired.trials - known.shared)
    return StudyPlan(
        first=round(first, 6),
        second=round(second, 6),
        measured=bool(folders),
        paired=paired,
        unpaired=unpaired,
        shared=known.shared,
        more=more,
        sentence=(
            f"{100.0 * first:.1f} % against {100.0 * second:.1f} % shows in {100.0 * wanted:.0f} of 100 studies with "
            f"{paired.trials} tasks where both robots meet the same people at the same tasks (correlation "
            f"{correlation:.2f}), and with {unpaired.trials} tasks each where they do not." + _added(known.shared, more)
        ),
    )


def _added(shared: int | None, more: int | None) -> str:
    if shared is None or more is None:
        return ""
    if more == 0:
        return f" The {shared} that these runs share are enough for that."
    return f" That is about {power.rounded_count(more)} more than the {shared} that these runs share."


def _needs(
    known: _Known, first: float, second: float, correlation: float, wanted: float
) -> tuple[SampleSize, SampleSize]:
    """Sample sizes, paired and unpaired; measured scatter is scaled to rates or a correlation that the runs lack."""
    paired = unpaired = None
    if known.noise is not None and known.correlation is not None:
        here, there = (first, second), (known.first, known.second)
        paired = _scaled(known.noise.paired, (*there, known.correlation), (*here, correlation))
        unpaired = _scaled(known.noise.unpaired, (*there, 0.0), (*here, 0.0))
    return (
        power.sample_size(first, second, correlation=correlation, power=wanted, scatter=paired),
        power.sample_size(first, second, power=wanted, scatter=unpaired),
    )


def _scaled(held: Scatter, measured: tuple[float, float, float], wanted: tuple[float, float, float]) -> Scatter:
    """The scatter at other rates and another correlation; its ratio to that of independent trials is kept."""
    before = power.variance_of_difference(*measured)
    if wanted == measured or before <= 0.0:
        return held
    variance = held.variance * power.variance_of_difference(*wanted) / before
    return msgspec.structs.replace(held, variance=variance)


def _measured(folders: Sequence[Path]) -> _Known:
    """The rates of two runs, the correlation of their outcomes and the scatter of their trials."""
    one, other = compare.load_runs(folders)
    pairing.check_comparable((one.folder, one.plan), (other.folder, other.plan))
    if group_difference.are_groups(one.plan, other.plan):
        return _of_groups(one, other)
    pairs = pairing.pair_trials(one.records, other.records).pairs
    found = paired_difference.paired_difference(pairs, "sr")
    if found is None:
        raise HthorError(
            f"{one.folder} and {other.folder} have no trials in common yet. Finish both with 'hthor eval'."
        )
    noise = paired_difference.trial_noise(pairs, "sr")
    return _Known(found.first, found.second, found.correlation or 0.0, noise, len(pairs))


def _of_groups(one: LoadedRun, other: LoadedRun) -> _Known:
    """The rates of two groups of a between-subjects study, which say nothing about a correlation."""
    found = group_difference.group_difference(one.records, other.records, "sr")
    if found is None:
        raise HthorError(f"{one.folder} and {other.folder} are not both begun yet. Finish both with 'hthor eval'.")
    return _Known(found.first, found.second)


def _rates(words: str) -> _Known:
    try:
        first, second = (float(word) for word in words.split(","))
    except ValueError:
        raise HthorError(f"--rates '{words}' is not two rates; expected something like 0.73,0.76.") from None
    return _Known(first, second)
