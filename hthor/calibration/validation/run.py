"""`hthor humans validate` as one function: plays people on the published study's tasks and sets them against it.

Any people will do: a population, a kind of people, a human model in a file. Parses and prints nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import code_identity, installation, jsonio, plugins, rules, tasks
from hthor.calibration import targets
from hthor.calibration.pipeline import evidence
from hthor.calibration.pipeline.evidence import Evidence
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import AGENTS, CONDITIONS, Table
from hthor.calibration.validation import plan
from hthor.calibration.validation.plan import SUITE, Round, ValidationOptions
from hthor.calibration.validation.report import build, measures, page, trial_tables
from hthor.calibration.validation.report.findings import Findings, Played, Setting, Subject
from hthor.eval.config.sessions import participants_needed
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import experiment
from hthor.eval.runner.progress import Watcher
from hthor.humans.population import resolve
from hthor.humans.population.resolve import PROXY, ParticipantSource
from hthor.tasks import Suite

TARGETS = "paper"
JUDGED = 18
"""Participants in each condition from which on there are enough different groups for a verdict."""
OTHERS = "The evidence at hand is of another population than these people's."
_SHIPPED = Path(__file__).parent / "evidence"


class Outcome(Struct, frozen=True, kw_only=True):
    """What was found, and the folder with `validation.html` and `validation.json`."""

    findings: Findings
    folder: Path


Watch = Callable[[str], Watcher]


def run_validation(options: ValidationOptions, watcher: Watch) -> Outcome:
    """Play what is missing, work out everything, and write the report.

    Args:
        watcher: makes who follows the run of this name.

    Raises:
        UnknownName: when there are no such people, or no such suite.
        HthorError: when there are too few participants for a study group.
        RunError: when a run's folder holds another run, or the calibration's folder no evidence.
    """
    planned = plan.rounds(options)
    found, suite = resolve.resolve_humans(options.name), tasks.load_suite(SUITE)
    known, missing = _evidence(found, options.calibration)
    folder = plan.folder(options)
    stage = _Stage(options, watcher)
    own = stage.play(planned[0])
    made = build.Materials(
        trials=own,
        least=tables.t_star(suite),
        hands=participants_needed(len(suite.tasks)),
        rivals={one.word: stage.play(one) for one in planned if one.role == "rival"},
    )
    findings = build.findings(
        _subject(found, stage.notes),
        _setting(found, suite, options, len(own)),
        targets.load(TARGETS),
        made,
        evidence=known,
        evidence_missing=missing,
        kinds=[_played(one.word, stage, one) for one in planned if one.role == "kind"],
        suites=[_played(tasks.load_suite(one.suite).name, stage, one) for one in planned if one.role == "suite"],
    )
    jsonio.write(folder / "validation.json", jsonio.pretty(findings))
    jsonio.write(folder / "validation.html", page.render(findings).encode())
    return Outcome(findings=findings, folder=folder)


class _Stage:
    """Plays people in all three conditions, each run in a folder of its own."""

    def __init__(self, options: ValidationOptions, watcher: Watch) -> None:
        self._options, self._watcher = options, watcher
        self.notes: tuple[str, ...] = ()
        """What is known to be unlike the people's calibration, of those that were played first."""

    def play(self, one: Round) -> Table:
        """The trials of some people on a suite, in every condition."""
        name = resolve.resolve_humans(one.word).name
        runs: dict[str, Sequence[TrialRecord]] = {}
        for done in experiment.run_experiment(
            plan.asked(self._options, one), lambda title: self._watcher(f"{name} people, {title}")
        ):
            condition = CONDITIONS[AGENTS.index(plugins.file_stem("agent", done.config.name))]
            runs[condition] = done.folder.records()
            self.notes = self.notes or done.config.humans.notes
        return trial_tables.table(runs, tasks.load_suite(one.suite))


def _played(name: str, stage: _Stage, one: Round) -> Played:
    return measures.played(name, stage.play(one), tables.t_star(tasks.load_suite(one.suite)))


def _subject(found: ParticipantSource, notes: Sequence[str]) -> Subject:
    return Subject(
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
        code_sha256=code_identity.code_sha256(found.model, (task.kind for task in suite.tasks)),
        versions=installation.versions(),
        quick=options.quick or options.count < JUDGED,
    )


def _evidence(found: ParticipantSource, folder: Path | None) -> tuple[Evidence | None, str]:
    """What the calibration of these people found out; otherwise a sentence that says why there is nothing."""
    if folder is not None:
        known = evidence.load(folder)
    elif found.model != PROXY:
        return None, "This human model was not calibrated, so nothing is known of a fit."
    elif found.kind is not None:
        return None, "This kind of people is made out of a population by hand and was not calibrated itself."
    elif (file := _file_of(found)) is not None:
        known = evidence.load(file)
    elif not found.population.validity.targets_sha256:
        return None, "This population was fitted to no data: it is the literature's."
    else:
        return None, "The evidence of this population's calibration is not at hand; name its folder with --calibration."
    if known.origin.population_sha256 != found.population.sha256:
        return None, OTHERS
    return known, ""


def _file_of(found: ParticipantSource) -> Path | None:
    """The evidence that lies beside a population's file, or ships with a population of ours."""
    beside = Path(found.word).parent / evidence.FILE
    if found.word.endswith((".npz", ".json")) and beside.is_file():
        return beside
    shipped = _SHIPPED / f"{found.population.name}.json"
    return shipped if shipped.is_file() else None
