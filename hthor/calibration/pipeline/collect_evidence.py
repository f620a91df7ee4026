"""From a calibration's stages to the evidence that it leaves behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hthor import rules
from hthor.calibration.pipeline.evidence import (
    FIGURES,
    Band,
    Coverage,
    Emulated,
    Evidence,
    HeldFigure,
    HeldOut,
    Origin,
    ParameterFinding,
    Predictive,
    Ranking,
    Shift,
    Swing,
)
from hthor.calibration.simulation.trial_table import CONDITIONS
from hthor.humans.population.parameter_registry import PARAMETERS

if TYPE_CHECKING:
    from hthor.calibration.pipeline.stages import Stages
    from hthor.humans.population.population import Population

Array = np.ndarray
_BAND = (0.05, 0.5, 0.95)
_DIGITS = 5
_EDGE = 1e-3
_BINS = 10
_BIN_LEAST = 30
"""Trials that a bin needs to be shown."""
_OUTCOMES = (("success", "sr"), ("adoption", "adoption"))


def evidence(stages: Stages, population: Population, *, quick: bool) -> Evidence:
    """Everything that the stages tell of the population that came out of them."""
    return Evidence(
        origin=_origin(stages, population, quick),
        predictive=_predictive(stages),
        simulated_studies=int(np.unique(stages.predicted.study).size),
        held_out=_held_out(stages),
        parameters=_parameters(stages, population),
        coverage=Coverage(
            studies=stages.quality.studies,
            mean=_r(stages.coverage.overall),
            low=_r(stages.coverage.covered.min()),
            high=_r(stages.coverage.covered.max()),
        ),
        emulator_z=_r(stages.quality.z_sd),
        emulated=(*_emulated(stages), *_ratios(stages)),
        abc=_abc(stages),
        rankings=(_ranking(stages),),
    )


def _origin(stages: Stages, population: Population, quick: bool) -> Origin:
    brief = stages.brief
    tables = (
        stages.training,
        stages.studies,
        stages.predicted,
        *((stages.correction,) if brief.sizes.correction else ()),
    )
    return Origin(
        population_sha256=population.sha256,
        targets_sha256=brief.targets.sha256,
        suite=brief.suite.name,
        suite_sha256=brief.suite.sha256,
        simulation=rules.SIMULATION,
        seed=brief.seed,
        trials=sum(len(table) for table in tables),
        draws=len(population.draws),
        effective=_r(stages.posterior.effective),
        quick=quick,
    )


def _predictive(stages: Stages) -> tuple[Predictive, ...]:
    foretold, factors = stages.foretold, stages.effects.figures()
    return tuple(
        Predictive(
            figure=name,
            prior=_band(foretold["prior"][name]),
            posterior=_band(foretold["posterior"][name]),
            simulated=_band(foretold["simulated"][name]),
            design_effect=_r(factors[name]) if name in factors else None,
        )
        for name in FIGURES
    )


def _held_out(stages: Stages) -> tuple[HeldOut, ...]:
    return tuple(
        HeldOut(
            condition=one.condition,
            fitted=one.fitted,
            figures=tuple(
                HeldFigure(
                    figure=row.name,
                    published=_r(row.observed),
                    band=Band(low=_r(row.low80), median=_r(row.median), high=_r(row.high80)),
                )
                for row in one.figures
            ),
            log_score=_r(one.log_score),
            log_score_prior=_r(one.log_score_prior),
            rivals={name: _r(score) for name, score in sorted(one.rivals.items())},
        )
        for one in stages.held_out
    )


def _parameters(stages: Stages, population: Population) -> tuple[ParameterFinding, ...]:
    after, checked = population.quantiles(_BAND), stages.coverage
    place = {name: number for number, name in enumerate(checked.names)}
    return tuple(
        ParameterFinding(
            name=spec.name,
            unit=spec.unit,
            meaning=spec.meaning,
            grade=spec.grade,
            fitted=spec.fitted,
            prior=_of([spec.prior.quantile(share) for share in _BAND]),
            posterior=_of([float(value) for value in after[:, column]]),
            contraction=_r(spec.contraction),
            recovery=_r(checked.recovery[place[spec.name]]),
            coverage=_r(checked.covered[place[spec.name]]),
            ranks=checked.histogram(place[spec.name]) if spec.fitted else (),
        )
        for column, spec in enumerate(population.specs)
    )


def _emulated(stages: Stages) -> list[Emulated]:
    """How well chances of single trials are foretold, on studies that the emulator has not seen."""
    table = stages.studies
    rates = stages.emulator.rates(table.points)
    z = stages.quality.by_figure
    found = []
    for outcome, metric in _OUTCOMES:
        for number, condition in enumerate(CONDITIONS):
            rows = table.condition == number
            if f"{metric} {condition}" not in z or not rows.any():
                continue
            said = np.clip(getattr(rates, metric)[table.point[rows], number], _EDGE, 1.0 - _EDGE)
            came = (table.met if outcome == "success" else table.adopted)[rows]
            always = np.full(len(came), np.clip(came.mean(), _EDGE, 1.0 - _EDGE))
            found.append(
                Emulated(
                    outcome=outcome,
                    condition=condition,
                    z_sd=_r(z[f"{metric} {condition}"]),
                    score=_r(log_score(said, came)),
                    baseline=_r(log_score(always, came)),
                    bins=bins(said, came),
                )
            )
    return found


def _ratios(stages: Stages) -> list[Emulated]:
    z = stages.quality.by_figure
    named = [(condition, f"ratio {condition}") for condition in CONDITIONS]
    return [
        Emulated(outcome="TWSR / SR", condition=condition, z_sd=_r(z[name])) for condition, name in named if name in z
    ]


def log_score(said: Array, came: Array) -> float:
    """Mean log chance [nats] that was given to what came. ``said`` (N,) chances, ``came`` (N,) bool."""
    return float(np.mean(np.where(came, np.log(said), np.log1p(-said))))


def bins(said: Array, came: Array) -> tuple[tuple[float, float, int], ...]:
    """What was said and how often it came so, in bins of what was said; bins with few trials are left out."""
    place = np.minimum((said * _BINS).astype(int), _BINS - 1)
    found = []
    for number in range(_BINS):
        rows = place == number
        if rows.sum() >= _BIN_LEAST:
            found.append((_r(said[rows].mean()), _r(came[rows].mean()), int(rows.sum())))
    return tuple(found)


def _abc(stages: Stages) -> tuple[Shift, ...]:
    check = stages.check
    if check is None:
        return ()
    fitted = {one.name for one in PARAMETERS if one.fitted}
    return tuple(
        Shift(name=name, shift=_r(shift), error=_r(error))
        for name, shift, error in zip(check.names, check.shift, check.error, strict=True)
        if name in fitted
    )


def _ranking(stages: Stages) -> Ranking:
    found = stages.ranking
    return Ranking(
        suite=stages.brief.suite.name,
        draws=found.draws,
        trials=found.trials,
        sr=_r(found.measured["sr"]),
        twsr=_r(found.measured["twsr"]),
        both=_r(found.measured["both"]),
        expected={name: _r(share) for name, share in sorted(found.holds.items())},
        pairs={gap.name: _r(gap.chances.mean()) for gap in found.pairs},
        swings=tuple(
            Swing(
                name=one.name,
                better=one.better,
                worse=one.worse,
                low=_r(one.low),
                high=_r(one.high),
                ordered=_r(one.ordered),
            )
            for one in stages.swings
        ),
    )


def _band(draws: Array) -> Band:
    return _of([float(value) for value in np.nanquantile(draws, _BAND)])


def _of(values: list[float]) -> Band:
    low, median, high = (_r(value) for value in values)
    return Band(low=low, median=median, high=high)


def _r(value: float) -> float:
    return round(float(value), _DIGITS) + 0.0  # never -0.0
