"""The report's numbers from trials: figures, time spent, trust, log scores."""

import itertools
import math
from collections.abc import Mapping
from typing import Literal

import numpy as np

from hthor.calibration.evidence import FIGURES, TOLERANCE, Band
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS
from hthor.calibration.validation.report import study_groups
from hthor.calibration.validation.report.findings import (
    FigurePrediction,
    MessageReach,
    ModelFigures,
    ModelScore,
    PublishedStudy,
    TimeDifference,
    TimeSpent,
    TrustCurve,
    TrustFindings,
)
from hthor.calibration.validation.report.study_groups import StudyGroups

Array = np.ndarray
_DIGITS = 6


def central_band(draws: Array, level: float = 0.90) -> Band:
    """Median and central interval of draws; NaN is left out."""
    tail = (1.0 - level) / 2.0
    low, middle, high = np.nanquantile(draws, [tail, 0.5, 1.0 - tail])
    return Band(low=_r(low), median=_r(middle), high=_r(high))


def mean_figures(played: Table, t_star: Array) -> dict[str, float | None]:
    """The eight figures over all trials, None for a condition that was not run."""
    twsr = tables.twsr(played, t_star)
    values: dict[str, Array] = {"sr": played.met, "twsr": twsr, "adoption": played.adopted}
    found: dict[str, float | None] = {}
    for name in FIGURES:
        metric, condition = name.split()
        rows = played.condition == CONDITIONS.index(condition)
        found[name] = _r(values[metric][rows].mean()) if rows.any() else None
    return found


def predict_figures(
    published: PublishedStudy, played: Table, t_star: Array, made: Mapping[str, StudyGroups]
) -> tuple[FigurePrediction, ...]:
    """The eight published figures, each compared with simulated study groups."""
    average = mean_figures(played, t_star)
    rows = []
    for name, draws in study_groups.group_figures(made).items():
        goal = published.figures[name]
        below = float((draws < goal - 5e-4).mean() + 0.5 * (abs(draws - goal) <= 5e-4).mean())
        rows.append(
            FigurePrediction(
                figure=name,
                published=goal,
                band=central_band(draws),
                mean=average[name] or 0.0,
                percentile=_r(below),
                tolerance=TOLERANCE[name.split()[0]],
            )
        )
    return tuple(rows)


def model_figures(name: str, run: Table, t_star: Array) -> ModelFigures:
    """A model's figures on a suite."""
    return ModelFigures(name=name, figures=mean_figures(run, t_star), trials=len(run))


def time_spent(run: Table) -> tuple[TimeSpent, ...]:
    """Time spent by condition."""
    found = []
    for number, condition in enumerate(CONDITIONS):
        seconds = tables.time_spent_s(run)[run.condition == number]
        if seconds.size:
            marks = {"least": 0, "lower": 25, "median": 50, "upper": 75, "most": 100}
            quantiles = {name: _r(np.percentile(seconds, share)) for name, share in marks.items()}
            found.append(TimeSpent(condition=condition, trials=int(seconds.size), **quantiles))
    return tuple(found)


def time_differences(run: Table, made: Mapping[str, StudyGroups]) -> tuple[TimeDifference, ...]:
    """Differences of lower quartiles and minima of the time spent, of each condition from each before it."""
    whole = {one.condition: one for one in time_spent(run)}
    statistics: tuple[tuple[Literal["lower quartile", "minimum"], str], ...] = (
        ("lower quartile", "lower"),
        ("minimum", "least"),
    )
    return tuple(
        TimeDifference(
            statistic=statistic,
            a=a,
            b=b,
            value=_r(getattr(whole[a], field) - getattr(whole[b], field)),
            group=central_band(getattr(made[a], field) - getattr(made[b], field)),
        )
        for statistic, field in statistics
        for b, a in itertools.combinations(made, 2)
    )


def message_reach(run: Table) -> tuple[MessageReach, ...]:
    """How often messages were shown and accepted, for each condition with a robot."""
    found = []
    for number, condition in enumerate(CONDITIONS):
        rows = (run.condition == number) & run.counted
        if rows.any():
            shown = rows & (run.shown >= 0)
            accepted = _r(run.adopted[shown].mean()) if shown.any() else None
            found.append(MessageReach(condition=condition, shown=_r(shown.sum() / rows.sum()), accepted=accepted))
    return tuple(found)


def trust_findings(run: Table, made: Mapping[str, StudyGroups]) -> TrustFindings | None:
    """Trust in the frontier robot and the oracle over a session; None when the people did not rate both."""
    rated = {name: _ratings(run, name) for name in CONDITIONS if name in made}
    curves = {name: ratings for name, ratings in rated.items() if ratings.size and ratings.min() > 0}
    if not {"frontier", "oracle"} <= set(curves):
        return None
    gap = curves["oracle"].mean(axis=0) - curves["frontier"].mean(axis=0)
    spread = [_se(ratings.mean(axis=1)) for ratings in (curves["frontier"], curves["oracle"])]
    apart = made["oracle"].trust - made["frontier"].trust
    return TrustFindings(
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


def _curve(condition: str, ratings: Array) -> TrustCurve:
    slopes = study_groups.slopes(ratings)
    people, trials = ratings.shape
    return TrustCurve(
        condition=condition,
        mean=tuple(_r(value) for value in ratings.mean(axis=0)),
        se=tuple(_se(ratings[:, trial]) for trial in range(trials)),
        people=(people,) * trials,
        slope=_r(slopes.mean()),
        slope_se=_se(slopes),
    )


def score_model(
    name: str, published: PublishedStudy, run: Table, t_star: Array, made: Mapping[str, StudyGroups]
) -> ModelScore:
    """A model's figures, and how well it predicts each condition's published counts and ratio.

    Counts are beta-binomial around the model's mean, with the overdispersion of its study groups; ratios are normal.
    """
    average = mean_figures(run, t_star)
    return ModelScore(
        played=model_figures(name, run, t_star),
        log_score={condition: _r(_log_score(condition, published, average, made[condition])) for condition in made},
    )


def _log_score(
    condition: str, published: PublishedStudy, average: Mapping[str, float | None], made: StudyGroups
) -> float:
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
