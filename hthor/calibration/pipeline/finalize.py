"""From the stages of a calibration to its population, its evidence and its summary; simulates and fits nothing."""

from __future__ import annotations

import math

import numpy as np

from hthor import jsonio
from hthor.calibration.diagnostics import acceptance
from hthor.calibration.diagnostics.acceptance import Figures
from hthor.calibration.inference import predictive
from hthor.calibration.inference.summary_statistics import FIGURES
from hthor.calibration.pipeline.stages import FITTED, Stages
from hthor.calibration.pipeline.summary import Foretold, Learned, Span, Summary
from hthor.calibration.simulation import trial_identity, trial_table
from hthor.eval.config import human_populations
from hthor.humans.population import parameter_registry, population_file
from hthor.humans.population.population import Population, Validity
from hthor.types import detector_specs

POPULATION, RESULT = "population", "result.json"
_BAND = (0.05, 0.5, 0.95)
_DIGITS = 4
_PURPOSE = (
    "People who do the tasks of the suite as well, as fast and as open to help as those of the published study. For "
    "comparing robots with one another on that suite; no evidence about individual people, trust or memory."
)


def settle(stages: Stages, command: str) -> Summary:
    """Run what is left of the stages, and write the population, the evidence, the tables and the result."""
    from hthor.calibration.pipeline import collect_evidence, evidence

    folder, quick = stages.brief.folder, stages.brief.sizes.quick
    people = population(stages, command)
    population_file.save_population(people, folder / POPULATION)
    jsonio.write(folder / evidence.FILE, evidence.encode(collect_evidence.evidence(stages, people, quick=quick)))
    for name in ("training", "studies", "predicted", *(("correction",) if stages.brief.sizes.correction else ())):
        trial_table.store(folder / f"{name}.npz", getattr(stages, name))
    found = summary(stages, people)
    jsonio.write(folder / RESULT, jsonio.pretty(found))
    return found


def population(stages: Stages, command: str) -> Population:
    """The posterior's draws as a population."""
    brief, found = stages.brief, stages.posterior
    return Population.make(
        f"{brief.targets.name}-quick" if brief.sizes.quick else brief.targets.name,
        parameter_registry.from_quantiles(found.points),
        purpose=_PURPOSE,
        seed=brief.seed,
        command=command,
        statistics=_statistics(stages),
        design_effects={name: _short(value) for name, value in stages.effects.figures().items()},
        figures={
            "effective": _short(found.effective),
            "coverage90": _short(stages.coverage.overall),
            "emulator z_sd": _short(stages.quality.z_sd),
            **({"ABC shift": _short(_shift(stages)[0])} if stages.check is not None else {}),
        },
        notes=_notes(stages),
        validity=Validity(
            suite=brief.suite.name,
            suite_sha256=brief.suite.sha256,
            targets=brief.targets.name,
            targets_sha256=brief.targets.sha256,
            settings=human_populations.robot_settings(trial_identity.ROBOT, detector_specs.OWN),
        ),
    )


def summary(stages: Stages, people: Population) -> Summary:
    """What to tell of a calibration."""
    brief, foretold = stages.brief, stages.foretold
    trials = (stages.training, stages.studies, stages.predicted)
    more = len(stages.correction) if brief.sizes.correction else 0
    return Summary(
        target=brief.targets.name,
        target_sha256=brief.targets.sha256,
        suite=brief.suite.name,
        suite_sha256=brief.suite.sha256,
        seed=brief.seed,
        sizes=brief.sizes,
        trials=sum(len(some) for some in trials) + more,
        effective=_short(stages.posterior.effective),
        population=f"{POPULATION}.json",
        population_sha256=people.sha256,
        figures=tuple(
            Foretold(
                figure=name,
                published=_short(100.0 * float(values[0])),
                **{source: _span(100.0 * foretold[source][name]) for source in ("prior", "posterior", "simulated")},
            )
            for name, values in stages.published.figures().items()
            if name in FIGURES and np.isfinite(values[0])
        ),
        parameters=_learned(stages, people),
        design_effects=people.design_effects,
        gates=acceptance.judge(_figures(stages), quick=brief.sizes.quick),
    )


def _figures(stages: Stages) -> Figures:
    """What the gates look at. A few simulated studies have no median to speak of; then the emulator's are judged."""
    source = "posterior" if stages.brief.sizes.quick else "simulated"
    rows = predictive.compare(stages.foretold[source], stages.published)
    shift, worst = _shift(stages)
    return Figures(
        coverage=stages.coverage.overall,
        studies=stages.quality.studies,
        z_sd=stages.quality.z_sd,
        shift=shift,
        worst=worst,
        effective=stages.posterior.effective,
        covered=acceptance.count({row.name: row.inside for row in rows}),
        close=acceptance.count({row.name: row.close for row in rows}),
    )


def _shift(stages: Stages) -> tuple[float, str]:
    """The greatest shift of a fitted parameter by ABC [posterior sd], and whose it is; NaN when it was not tried."""
    if stages.check is None:
        return math.nan, ""
    sizes = {name: abs(float(shift)) for name, shift in zip(stages.check.names, stages.check.shift, strict=True)}
    worst = max(FITTED, key=lambda name: sizes[name])
    return sizes[worst], worst


def _learned(stages: Stages, people: Population) -> tuple[Learned, ...]:
    after, recovery = people.quantiles(_BAND), stages.coverage.recovery
    found = []
    for place, spec in enumerate(people.specs):
        before = [spec.prior.quantile(share) for share in _BAND]
        found.append(
            Learned(
                name=spec.name,
                unit=spec.unit,
                fitted=spec.fitted,
                grade=spec.grade,
                prior=_of(before),
                posterior=_of(after[:, place].tolist()),
                contraction=spec.contraction,
                word=spec.word,
                recovery=_short(float(recovery[place])),
            )
        )
    return tuple(found)


def _statistics(stages: Stages) -> tuple[str, ...]:
    """What was fitted to, in words."""
    aims = stages.brief.targets
    counts = [f"sr {name} {count.k}/{count.n}" for name, count in aims.sr.items()]
    counts += [
        f"adoption {name} {count.k}/{count.n}" + (" (inferred)" if count.inferred else "")
        for name, count in aims.adoption.items()
    ]
    return (*counts, *(f"twsr/sr {name} {value:.3f}" for name, value in aims.ratio.items()))


def _notes(stages: Stages) -> tuple[str, ...]:
    notes = ["The denominators of adoption were inferred from the published percentages."]
    if stages.brief.sizes.quick:
        notes.append("This is a small calibration that shows that everything works; use one without --quick.")
    return tuple(notes)


def _span(values: np.ndarray) -> Span:
    return _of(np.nanquantile(values, _BAND).tolist())


def _of(values: list[float]) -> Span:
    low, median, high = (_short(value) for value in values)
    return Span(low=low, median=median, high=high)


def _short(value: float) -> float:
    return round(float(value), _DIGITS) + 0.0
