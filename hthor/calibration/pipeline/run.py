"""`hthor calibrate` on published numbers as one function: runs the stages and writes their results.

The results are the population, the evidence, the summary and the tables of simulated trials.
"""

import importlib

import msgspec
import numpy as np
from msgspec import Struct

from hthor import jsonio
from hthor.calibration import evidence
from hthor.calibration.diagnostics import acceptance
from hthor.calibration.diagnostics.acceptance import Gate, QualityFigures
from hthor.calibration.evidence import Band, Evidence
from hthor.calibration.inference import likelihood
from hthor.calibration.pipeline.collect_evidence import collect_evidence
from hthor.calibration.pipeline.config import CalibrationOptions, CalibrationSizes, reproducing_command, resolve_options
from hthor.calibration.pipeline.stages import CalibrationStages, ProgressReporter
from hthor.calibration.simulation import session_store, trial_table
from hthor.errors import MissingExtra, UnknownName
from hthor.eval.config import human_populations
from hthor.humans.population import parameter_registry, population_file
from hthor.humans.population.population import Population, Validity
from hthor.types import detector_specs

CODE_ROOT = "statistics"

SCHEMA = "hthor.calibration/1"
SIMULATED = ("training", "studies", "correction", "predicted")
"""Stages that simulate, in order; a calibration can be told to stop after one of them."""
POPULATION, RESULT = "population", "result.json"
_SUMMARY_DIGITS, _EVIDENCE_DIGITS = 4, 5
_PURPOSE = (
    "People who do the tasks of the suite as well, as fast and as open to help as those of the published study. For "
    "comparing robots with one another on that suite; no evidence about individual people, trust or memory."
)


class FigureSummary(Struct, frozen=True, kw_only=True):
    """A published figure and its predictions, all in per cent; fields as in `PredictedFigure`."""

    figure: str
    published: float
    prior: Band
    posterior: Band
    simulated: Band


class ParameterSummary(Struct, frozen=True, kw_only=True):
    """A short `ParameterFinding`; ``word`` says whether the data identify the parameter, by its contraction."""

    name: str
    unit: str
    fitted: bool
    grade: str
    prior: Band
    posterior: Band
    contraction: float
    word: str
    recovery: float


class CalibrationSummary(Struct, frozen=True, kw_only=True):
    """A calibration's result; ``population`` is the path of the population's JSON in the calibration's folder."""

    schema: str = SCHEMA
    target: str
    target_sha256: str
    suite: str
    suite_sha256: str
    seed: int
    sizes: CalibrationSizes
    trials: int
    effective: float
    population: str
    population_sha256: str
    figures: tuple[FigureSummary, ...]
    parameters: tuple[ParameterSummary, ...]
    design_effects: dict[str, float]
    gates: tuple[Gate, ...]

    @property
    def passed(self) -> bool:
        """Whether every gate was passed."""
        return all(gate.passed for gate in self.gates)


def run_calibration(options: CalibrationOptions, progress: ProgressReporter) -> CalibrationSummary | None:
    """Run a calibration, or its missing stages; None when the options say to stop before its end.

    Raises:
        MissingExtra: without scikit-learn.
        UnknownName: when there is no such target, suite or stage.
        RunError: when the folder has sessions simulated in another world or with another human model.
        Interrupted: on Ctrl-C or SIGTERM; simulated sessions are kept.
    """
    _require_libraries()
    if options.until and options.until not in SIMULATED:
        raise UnknownName("stage", options.until, SIMULATED, "Choose one with --until, or leave it out.")
    config = resolve_options(options)
    config.folder.mkdir(parents=True, exist_ok=True)
    stages = CalibrationStages(config, progress)
    if options.until:
        for name in SIMULATED[: SIMULATED.index(options.until) + 1]:
            if name != "correction" or config.sizes.correction:
                getattr(stages, name)
        return None
    return write_results(stages, reproducing_command(options))


def _require_libraries() -> None:
    """Fail before the simulation, not after it, when a library is missing."""
    for name in ("sklearn", "threadpoolctl"):
        try:
            importlib.import_module(name)
        except ImportError:
            raise MissingExtra("calibration", "calibration") from None


def write_results(stages: CalibrationStages, command: str) -> CalibrationSummary:
    """Compute the remaining stages, and write the population, the evidence, the tables and the summary."""
    folder, quick = stages.config.folder, stages.config.sizes.quick
    population = make_population(stages, command)
    population_file.save_population(population, folder / POPULATION)
    findings = collect_evidence(stages, population, quick=quick)
    document = evidence.encode_evidence(evidence.rounded(findings, _EVIDENCE_DIGITS))
    jsonio.write(folder / evidence.FILE, document)
    for name, table in stages.simulated.items():
        trial_table.save_table(folder / f"{name}.npz", table)
    summary = make_summary(stages, population, findings)
    jsonio.write(folder / RESULT, jsonio.pretty(summary))
    return summary


def make_population(stages: CalibrationStages, command: str) -> Population:
    """The posterior's draws as a population."""
    config, posterior, shifts = stages.config, stages.posterior, stages.abc_shifts
    return Population.make(
        f"{config.targets.name}-quick" if config.sizes.quick else config.targets.name,
        parameter_registry.from_quantiles(posterior.points),
        purpose=_PURPOSE,
        seed=config.seed,
        command=command,
        statistics=_statistics(stages),
        design_effects={name: _short(value) for name, value in stages.effects.figures().items()},
        figures={
            "effective": _short(posterior.effective),
            "coverage90": _short(stages.coverage.overall),
            "emulator z_sd": _short(stages.quality.z_sd),
            **({"ABC shift": _short(max(abs(one.shift) for one in shifts))} if shifts else {}),
        },
        notes=_notes(stages),
        validity=Validity(
            suite=config.suite.name,
            suite_sha256=config.suite.sha256,
            targets=config.targets.name,
            targets_sha256=config.targets.sha256,
            settings=human_populations.robot_settings(session_store.ROBOT, detector_specs.OWN),
        ),
    )


def make_summary(stages: CalibrationStages, population: Population, findings: Evidence) -> CalibrationSummary:
    """The result of a calibration in short."""
    config = stages.config
    summary = CalibrationSummary(
        target=config.targets.name,
        target_sha256=config.targets.sha256,
        suite=config.suite.name,
        suite_sha256=config.suite.sha256,
        seed=config.seed,
        sizes=config.sizes,
        trials=findings.origin.trials,
        effective=findings.origin.effective,
        population=f"{POPULATION}.json",
        population_sha256=population.sha256,
        figures=_figure_summaries(stages, findings),
        parameters=_parameter_summaries(population, findings),
        design_effects=population.design_effects,
        gates=acceptance.judge_calibration(_quality_figures(stages), quick=config.sizes.quick),
    )
    return evidence.rounded(summary, _SUMMARY_DIGITS)


def _figure_summaries(stages: CalibrationStages, findings: Evidence) -> tuple[FigureSummary, ...]:
    published = {name: float(values[0]) for name, values in stages.published.figures().items()}
    return tuple(
        FigureSummary(
            figure=row.figure,
            published=100.0 * published[row.figure],
            **{source: _percent(getattr(row, source)) for source in ("prior", "posterior", "simulated")},
        )
        for row in findings.predictive
        if np.isfinite(published[row.figure])
    )


def _parameter_summaries(population: Population, findings: Evidence) -> tuple[ParameterSummary, ...]:
    words = {spec.name: spec.word for spec in population.specs}
    shared = ("name", "unit", "fitted", "grade", "prior", "posterior", "contraction", "recovery")
    return tuple(
        ParameterSummary(word=words[one.name], **{name: getattr(one, name) for name in shared})
        for one in findings.parameters
    )


def _quality_figures(stages: CalibrationStages) -> QualityFigures:
    """The figures that the gates judge: of simulated studies, or of the emulator if there are too few studies."""
    source = "posterior" if stages.config.sizes.quick else "simulated"
    rows = likelihood.compare_figures(stages.predictions[source], stages.published, evidence.BAND90)
    return QualityFigures(
        coverage=stages.coverage.overall,
        studies=stages.quality.studies,
        z_sd=stages.quality.z_sd,
        shifts=stages.abc_shifts,
        effective=stages.posterior.effective,
        covered=acceptance.count([row.inside for row in rows]),
        close=acceptance.count([row.close for row in rows]),
    )


def _statistics(stages: CalibrationStages) -> tuple[str, ...]:
    """The numbers that the population was fitted to, in words."""
    targets = stages.config.targets
    counts = [f"sr {name} {count.k}/{count.n}" for name, count in targets.sr.items()]
    counts += [
        f"adoption {name} {count.k}/{count.n}" + (" (inferred)" if count.inferred else "")
        for name, count in targets.adoption.items()
    ]
    return (*counts, *(f"twsr/sr {name} {value:.3f}" for name, value in targets.ratio.items()))


def _notes(stages: CalibrationStages) -> tuple[str, ...]:
    notes = ["The denominators of adoption were inferred from the published percentages."]
    if stages.config.sizes.quick:
        notes.append("This is a small calibration that shows that everything works; use one without --quick.")
    return tuple(notes)


def _percent(fractions: Band) -> Band:
    return Band(**{name: 100.0 * value for name, value in msgspec.structs.asdict(fractions).items()})


def _short(value: float) -> float:
    return round(float(value), _SUMMARY_DIGITS) + 0.0
