"""`hthor humans validate` as one function: runs people on the published study's tasks and compares them with the study.

Any people can be validated: a population, a kind of people, or a human model in a file.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import code_identity, installation, jsonio, plugins, rules, tasks
from hthor.calibration import evidence, targets
from hthor.calibration.evidence import Evidence
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import AGENTS, Table
from hthor.calibration.targets import CONDITIONS
from hthor.calibration.validation import plan
from hthor.calibration.validation.plan import SUITE, ValidationOptions, ValidationRun
from hthor.calibration.validation.report import build, measures, page
from hthor.calibration.validation.report.findings import Findings, ModelFigures, ModelUnderTest, Setting
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import experiment
from hthor.eval.runner.progress import Watcher
from hthor.humans.population import resolve
from hthor.humans.population.resolve import PROXY, ParticipantSource
from hthor.tasks import Suite
from hthor.trials.sessions import sessions_needed

TARGETS = "paper"
JUDGED = 18
"""Least participants per condition that give enough different groups for a verdict."""
OTHERS = "The evidence belongs to another population than that of these people."
_SHIPPED = Path(__file__).parent / "evidence"


class ValidationResult(Struct, frozen=True, kw_only=True):
    """The findings, and the folder with `validation.html` and `validation.json`."""

    findings: Findings
    folder: Path


WatcherFactory = Callable[[str], Watcher]


def run_validation(options: ValidationOptions, watcher: WatcherFactory) -> ValidationResult:
    """Run the missing trials, compute the findings, and write the report.

    Args:
        watcher: makes the progress display of a run, from its title.

    Raises:
        UnknownName: when no people or no suite have that name.
        HthorError: when there are too few participants for a study group.
        RunError: when a run's folder has another run, or the calibration's folder has no evidence.
    """
    planned = plan.planned_runs(options)
    found, suite = resolve.resolve_humans(options.name), tasks.load_suite(SUITE)
    known, missing = _evidence(found, options.calibration)
    folder = plan.report_folder(options)
    runs = _ConditionRuns(options, watcher)
    own = runs.trials(planned[0])
    made = build.PlayedTrials(
        trials=own,
        t_star=tables.suite_t_star(suite),
        round_size=sessions_needed(len(suite.tasks)),
        rivals={one.word: runs.trials(one) for one in planned if one.role == "rival"},
    )
    findings = build.make_findings(
        _subject(found, runs.notes),
        _setting(found, suite, options, len(own)),
        targets.load_targets(TARGETS),
        made,
        evidence=known,
        evidence_missing=missing,
        kinds=[_figures_of(one.word, runs, one) for one in planned if one.role == "kind"],
        suites=[_figures_of(tasks.load_suite(one.suite).name, runs, one) for one in planned if one.role == "suite"],
    )
    jsonio.write(folder / "validation.json", jsonio.pretty(findings))
    jsonio.write(folder / "validation.html", page.render(findings).encode())
    return ValidationResult(findings=findings, folder=folder)


class _ConditionRuns:
    """Runs people in all three conditions, each run in a folder of its own."""

    def __init__(self, options: ValidationOptions, watcher: WatcherFactory) -> None:
        self._options, self._watcher = options, watcher
        self.notes: tuple[str, ...] = ()
        """How the runs of the people under test differ from the setting of their calibration."""

    def trials(self, one: ValidationRun) -> Table:
        """The trials of these people on their suite, in every condition."""
        name = resolve.resolve_humans(one.word).name
        records: dict[str, Sequence[TrialRecord]] = {}
        for done in experiment.run_experiment(
            plan.resolve_run(self._options, one), lambda title: self._watcher(f"{name} people, {title}")
        ):
            condition = CONDITIONS[AGENTS.index(plugins.file_stem("agent", done.config.name))]
            records[condition] = done.folder.records()
            self.notes = self.notes or done.config.humans.notes
        return build.records_table(records, tasks.load_suite(one.suite))


def _figures_of(name: str, runs: _ConditionRuns, one: ValidationRun) -> ModelFigures:
    return measures.model_figures(name, runs.trials(one), tables.suite_t_star(tasks.load_suite(one.suite)))


def _subject(found: ParticipantSource, notes: Sequence[str]) -> ModelUnderTest:
    return ModelUnderTest(
        name=found.name,
        model=Path(found.model).name,
        sha256=found.sha256,
        population=found.population.name,
        population_sha256=found.population.sha256,
        purpose=found.purpose,
        notes=tuple(f"{note[:1].upper()}{note[1:]}." for note in notes),
    )


def _setting(found: ParticipantSource, suite: Suite, options: ValidationOptions, trials: int) -> Setting:
    return Setting(
        suite=suite.name,
        suite_sha256=suite.sha256,
        simulation=rules.SIMULATION,
        seed=options.seed,
        participants=options.count,
        trials=trials,
        code_sha256=code_identity.code_sha256([found.model], (task.kind for task in suite.tasks)),
        versions=installation.versions(),
        quick=options.quick or options.count < JUDGED,
    )


def _evidence(found: ParticipantSource, folder: Path | None) -> tuple[Evidence | None, str]:
    """The evidence of these people's calibration; without one, a sentence that says why."""
    if folder is not None:
        known = evidence.load_evidence(folder)
    elif found.model != PROXY:
        return None, "This human model was not calibrated, so nothing is known of a fit."
    elif found.kind is not None:
        return None, "This kind of people is a population changed by hand, and was not calibrated itself."
    elif (file := _file_of(found)) is not None:
        known = evidence.load_evidence(file)
    elif not found.population.validity.targets_sha256:
        return None, "This population was not fitted to data; it comes from the literature."
    else:
        return None, "The evidence of this population's calibration was not found; name its folder with --calibration."
    if known.origin.population_sha256 != found.population.sha256:
        return None, OTHERS
    return known, ""


def _file_of(found: ParticipantSource) -> Path | None:
    """The evidence in the folder of a population's file, or shipped with one of our populations."""
    beside = Path(found.word).parent / evidence.FILE
    if found.word.endswith((".npz", ".json")) and beside.is_file():
        return beside
    shipped = _SHIPPED / f"{found.population.name}.json"
    return shipped if shipped.is_file() else None
