"""Played trials as the report's numbers: table, time spent, trust, log scores."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np

from hthor.calibration.pipeline.evidence import FIGURES, Band
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import CONDITIONS, Table
from hthor.calibration.validation.report import study_groups
from hthor.calibration.validation.report.findings import (
    TOLERANCE,
    Curve,
    Difference,
    Played,
    Predicted,
    Published,
    Reach,
    Rival,
    Spent,
    Trust,
)
from hthor.calibration.validation.report.study_groups import Groups

Array = np.ndarray
_DIGITS = 6


def band(draws: Array, level: float = 0.90) -> Band:
    """Median and central interval of draws; those that are nan do not count."""
    tail = (1.0 - level) / 2.0
    low, middle, high = np.nanquantile(draws, [tail, 0.5, 1.0 - tail])
    return Band(low=_r(low), median=_r(middle), high=_r(high))


def means(played: Table, least: Array) -> dict[str, float | None]:
    """The eight figures over all trials, None for a condition that was not played."""
    worth = tables.twsr(played, least)
    values: dict[str, Array] = {"sr": played.met, "twsr": worth, "adoption": played.adopted}
    found: dict[str, float | None] = {}
    for name in FIGURES:
        metric, condition = name.split()
        rows = played.condition == CONDITIONS.index(condition)
        found[name] = _r(values[metric][rows].mean()) if rows.any() else None
    return found


def table(published: Published, played: Table, least: Array, made: Mapping[str, Groups]) -> tuple[Predicted, ...]:
    """The eight published figures against simulated study groups."""
    average = means(played, least)
    rows = []
    for name, draws in study_groups.figures(made).items():
        goal = published.figures[name]
        below = float((draws < goal - 5e-4).mean() + 0.5 * (abs(draws - goal) <= 5e-4).mean())
        rows.append(
            Predicted(
                figure=name,
                published=goal,
                band=band(draws),
                mean=average[name] or 0.0,
                percentile=_r(below),
                tolerance=TOLERANCE[name.split()[0]],
            )
        )
    return tuple(rows)


def played(name: str, run: Table, least: Array) -> Played:
    """A model's figures on a suite."""
    return Played(name=name, figures=means(run, least), trials=len(run))


def spent(run: Table) -> tuple[Spent, ...]:
    """Time spent by condition."""
    found = []
    for number, condition in enumerate(CONDITIONS):
        seconds = tables.seconds(run)[run.condition == number]
        if seconds.size:
            least, lower, middle, upper, most = (_r(np.percentile(seconds, part)) for part in (0, 25, 50, 75, 100))
            found.append(
                Spent(
                    condition=condition,
                    trials=int(seconds.size),
                    least=least,
                    lower=lower,
                    median=middle,
                    upper=upper,
                    most=most,
                )
            )
    return tuple(found)


def differences(run: Table, made: Mapping[str, Groups]) -> tuple[Difference, ...]:
    """Lower quartiles and minima of the time spent, each condition against each before it."""
    whole = {one.condition: one for one in spent(run)}
    pairs = [(a, b) for b, a in itertools.combinations(made, 2)]
    quartiles = [
        Difference(
            statistic="lower quartile",
            a=a,
            b=b,
            value=_r(whole[a].lower - whole[b].lower),
            group=band(made[a].lower - made[b].lower),
        )
        for a, b in pairs
    ]
    minima = [
        Difference(
            statistic="minimum",
            a=a,
            b=b,
            value=_r(whole[a].least - whole[b].least),
            group=band(made[a].least - made[b].least),
        )
        for a, b in pairs
    ]
    return (*quartiles, *minima)


def reach(run: Table) -> tuple[Reach, ...]:
    """How adoption came about, for each condition with a robot."""
    found = []
    for number, condition in enumerate(CONDITIONS):
        rows = (run.condition == number) & run.counted
        if rows.any():
            shown = rows & (run.shown >= 0)
            confirmed = _r(run.adopted[shown].mean()) if shown.any() else None
            found.append(Reach(condition=condition, shown=_r(shown.sum() / rows.sum()), confirmed=confirmed))
    return tuple(found)


def trust(run: Table, made: Mapping[str, Groups]) -> Trust | None:
    """Trust in the frontier robot and the oracle over a session; None when nobody rated both."""
    rated = {name: _ratings(run, name) for name in CONDITIONS if name in made}
    curves = {name: ratings for name, ratings in rated.items() if ratings.size and ratings.min() > 0}
    if not {"frontier", "oracle"} <= set(curves):
        return None
    gap = curves["oracle"].mean(axis=0) - curves["frontier"].mean(axis=0)
    spread = [_se(ratings.mean(axis=1)) for ratings in (curves["frontier"], curves["oracle"])]
    apart = made["oracle"].trust - made["frontier"].trust
    return Trust(
        curves=tuple(_curve(name, ratings) for name, ratings in curves.items()),
        gap=_r(gap.mean()),
        gap_se=_r(math.hypot(*spread)),
        above=int((gap > 0.0).sum()),
        groups_above=_r((apart > 0.0).all(axis=1).mean()),
        groups_rising=_r((made["oracle"].slope > 0.0).mean()),
    )


def _ratings(run: Table, condition: str) -> Array:
    """(people, T) ratings in a condition."""
    one = run.take(run.condition == CONDITIONS.index(condition))
    order = np.lexsort((one.index, one.participant))
    found: Array = one.trust[order].astype(float).reshape(len(np.unique(one.participant)), -1)
    return found


def _curve(condition: str, ratings: Array) -> Curve:
    slopes = study_groups.slopes(ratings)
    people, trials = ratings.shape
    return Curve(
        condition=condition,
        mean=tuple(_r(value) for value in ratings.mean(axis=0)),
        se=tuple(_se(ratings[:, trial]) for trial in range(trials)),
        people=(people,) * trials,
        slope=_r(slopes.mean()),
        slope_se=_se(slopes),
    )


def rival(name: str, published: Published, run: Table, least: Array, made: Mapping[str, Groups]) -> Rival:
    """A model's figures, and how well each condition's published counts and ratio were foretold by it.

    Success and adoption are beta-binomial around the model's mean, as clustered as its own study groups are; the ratio
    TWSR / SR is normal around the groups' mean.
    """
    average = means(run, least)
    return Rival(
        played=played(name, run, least),
        log_score={condition: _r(_log_score(condition, published, average, made[condition])) for condition in made},
    )


def _log_score(condition: str, published: Published, average: Mapping[str, float | None], made: Groups) -> float:
    total = 0.0
    for count in published.counts:
        metric, where = count.figure.split()
        share = average.get(count.figure)
        if where == condition and share is not None:
            binomial = max(share * (1.0 - share), 1e-9) / count.n
            phi = max(1.0, float(np.var(getattr(made, metric))) / binomial)
            total += study_groups.log_count(count.k, count.n, share, min(phi, 6.0))
    held = made.ratio[~np.isnan(made.ratio)]
    if condition in published.ratio and held.size:
        total += study_groups.log_normal(published.ratio[condition], float(held.mean()), max(0.01, float(held.std())))
    return total


def _se(values: Array) -> float:
    """Standard error of a mean; 0 for a single value."""
    return _r(float(values.std(ddof=1)) / math.sqrt(len(values))) if len(values) > 1 else 0.0


def _r(value: float) -> float:
    return round(float(value), _DIGITS) + 0.0  # never -0.0
