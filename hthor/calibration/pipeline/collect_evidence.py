"""Collects the evidence from a calibration's stages."""

import msgspec
import numpy as np

from hthor import rules
from hthor.calibration.evidence import (
    BAND90,
    FIGURES,
    CoverageFinding,
    EmulatorFit,
    Evidence,
    Origin,
    ParameterFinding,
    PredictedFigure,
    band,
)
from hthor.calibration.pipeline.stages import CalibrationStages
from hthor.calibration.targets import CONDITIONS
from hthor.humans.population.population import Population

Array = np.ndarray
_EDGE = 1e-3
_BINS = 10
_BIN_LEAST = 30
"""Least number of trials of a bin that the reliability diagram shows."""
_OUTCOMES = (("success", "sr"), ("adoption", "adoption"))


def collect_evidence(stages: CalibrationStages, population: Population, *, quick: bool) -> Evidence:
    """Everything that the stages say about the population that they produced; not rounded."""
    return Evidence(
        origin=_origin(stages, population, quick),
        predictive=_predictive(stages),
        simulated_studies=int(np.unique(stages.predicted.study).size),
        held_out=stages.held_out,
        parameters=_parameters(stages, population),
        coverage=CoverageFinding(
            studies=stages.quality.studies,
            mean=stages.coverage.overall,
            low=float(stages.coverage.covered.min()),
            high=float(stages.coverage.covered.max()),
        ),
        emulator_z=stages.quality.z_sd,
        emulated=(*_emulated(stages), *_ratios(stages)),
        abc=stages.abc_shifts,
        rankings=(msgspec.structs.replace(stages.ranking, swings=stages.swings),),
    )


def _origin(stages: CalibrationStages, population: Population, quick: bool) -> Origin:
    config = stages.config
    return Origin(
        population_sha256=population.sha256,
        targets_sha256=config.targets.sha256,
        suite=config.suite.name,
        suite_sha256=config.suite.sha256,
        simulation=rules.SIMULATION,
        seed=config.seed,
        trials=sum(map(len, stages.simulated.values())),
        draws=len(population.draws),
        effective=stages.posterior.effective,
        quick=quick,
    )


def _predictive(stages: CalibrationStages) -> tuple[PredictedFigure, ...]:
    factors = stages.effects.figures()
    return tuple(
        PredictedFigure(
            figure=name,
            **{source: band(np.nanquantile(figures[name], BAND90)) for source, figures in stages.predictions.items()},
            design_effect=factors.get(name),
        )
        for name in FIGURES
    )


def _parameters(stages: CalibrationStages, population: Population) -> tuple[ParameterFinding, ...]:
    posterior, checked = population.quantiles(BAND90), stages.coverage
    column_of = {name: number for number, name in enumerate(checked.names)}
    return tuple(
        ParameterFinding(
            **{name: getattr(spec, name) for name in ("name", "unit", "meaning", "grade", "fitted", "contraction")},
            prior=band([spec.prior.quantile(share) for share in BAND90]),
            posterior=band(posterior[:, number]),
            recovery=float(checked.recovery[column_of[spec.name]]),
            coverage=float(checked.covered[column_of[spec.name]]),
            ranks=checked.histogram(column_of[spec.name]) if spec.fitted else (),
        )
        for number, spec in enumerate(population.specs)
    )


def _emulated(stages: CalibrationStages) -> list[EmulatorFit]:
    """How well outcomes of single trials are predicted, on studies that the emulator has not seen."""
    table, z = stages.studies, stages.quality.by_figure
    rates = stages.emulator.rates(table.points)
    fits = []
    for outcome, metric in _OUTCOMES:
        for number, condition in enumerate(CONDITIONS):
            rows = table.condition == number
            if f"{metric} {condition}" not in z or not rows.any():
                continue
            predicted = np.clip(getattr(rates, metric)[table.point[rows], number], _EDGE, 1.0 - _EDGE)
            observed = (table.met if outcome == "success" else table.adopted)[rows]
            mean = np.full(len(observed), np.clip(observed.mean(), _EDGE, 1.0 - _EDGE))
            fits.append(
                EmulatorFit(
                    outcome=outcome,
                    condition=condition,
                    z_sd=z[f"{metric} {condition}"],
                    score=log_score(predicted, observed),
                    baseline=log_score(mean, observed),
                    bins=reliability_bins(predicted, observed),
                )
            )
    return fits


def _ratios(stages: CalibrationStages) -> list[EmulatorFit]:
    z = {condition: stages.quality.by_figure.get(f"ratio {condition}") for condition in CONDITIONS}
    return [EmulatorFit(outcome="TWSR / SR", condition=name, z_sd=sd) for name, sd in z.items() if sd is not None]


def log_score(predicted: Array, observed: Array) -> float:
    """Mean log probability [nats] of the ``observed`` outcomes (N,) bool under ``predicted`` probabilities (N,)."""
    return float(np.mean(np.where(observed, np.log(predicted), np.log1p(-predicted))))


def reliability_bins(predicted: Array, observed: Array) -> tuple[tuple[float, float, int], ...]:
    """Reliability diagram of outcomes (N,): predicted and observed frequency, and trials; small bins are left out."""
    bin_of = np.minimum((predicted * _BINS).astype(int), _BINS - 1)
    inside = [bin_of == number for number in range(_BINS)]
    return tuple(
        (float(predicted[rows].mean()), float(observed[rows].mean()), int(rows.sum()))
        for rows in inside
        if rows.sum() >= _BIN_LEAST
    )
