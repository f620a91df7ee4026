"""Where one run came from: everything that decides its records, and how its agents were isolated."""

import msgspec
from msgspec import Struct

from hthor import code_identity, documents
from hthor.errors import RunError
from hthor.eval.config import cli_command
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.run_config import AssetsRef, KindRef, SuiteRef
from hthor.eval.config.study_design import StudyDesign
from hthor.eval.records import run_isolation
from hthor.guest import Isolation
from hthor.log_corrections import CorrectAdoption, VoidTrial
from hthor.report.analysis.load_runs import Run
from hthor.types import RobotSeat
from hthor.types.specs import LOCKSTEP

_PLATFORM = "platform.json"


class Platform(Struct, frozen=True, kw_only=True):
    """A machine that played a part of a run: system, processor architecture and model, vector units, C library."""

    system: str = ""
    machine: str = ""
    cpu: str = ""
    simd: str = ""
    libc: str = ""


class CorrectedTrial(Struct, frozen=True, kw_only=True):
    """A correction in effect, and the task, the session and the place there of its trial."""

    correction: VoidTrial | CorrectAdoption
    task: str
    session: int
    index: int


class Provenance(Struct, frozen=True, kw_only=True):
    """Where one run came from.

    ``name`` is its folder's name. ``beside`` is true if the report found the run by itself, as another run's baseline.
    ``isolation`` is None if all agents are built in. ``platforms`` is empty if the run did not record them. ``command``
    plays the run again; ``alone`` plays the same people and tasks without a robot. ``mode`` is the decision clock.
    ``design`` is the between-subjects study that the run is a group of; absent if it is none.
    ``voided`` counts attempts at trials that do not count, and ``corrections`` lists the corrections in effect.
    ``code_sha256`` is of the code that played the trials, ``scoring_sha256`` of the code that judged them here.
    """

    name: str
    label: str
    beside: bool
    agent: str
    robots: tuple[RobotSeat, ...]
    humans: HumanModelRef
    suite: SuiteRef
    kind: KindRef | None
    seed: int
    mode: str
    participants: int
    trials: int
    whole: int
    faulty: int
    voided: int
    corrections: tuple[CorrectedTrial, ...] = ()
    design: StudyDesign | msgspec.UnsetType = msgspec.UNSET
    assets: AssetsRef
    versions: dict[str, str]
    isolation: Isolation | None
    platforms: tuple[Platform, ...]
    command: str
    alone: str
    run_sha256: str
    rules_sha256: str
    code_sha256: str
    scoring_sha256: str
    trials_sha256: str


def run_provenance(run: Run) -> Provenance:
    """Where a run came from.

    Raises:
        RunError: if a file next to the run's log cannot be read.
    """
    plan = run.plan
    return Provenance(
        name=run.name,
        label=run.label,
        beside=run.beside,
        agent=plan.name,
        robots=plan.robots,
        humans=plan.humans,
        suite=plan.suite,
        kind=plan.kind,
        seed=plan.seed,
        mode=getattr(plan, "mode", LOCKSTEP),
        participants=plan.participants,
        trials=len(run.records),
        whole=run.planned,
        faulty=sum(bool(record.faults) for record in run.records),
        voided=len(run.voided),
        corrections=_corrections(run),
        design=plan.design,
        assets=plan.assets,
        versions=plan.versions,
        isolation=run_isolation.load_isolation(run.folder),
        platforms=_platforms(run),
        alone=cli_command.baseline_command(plan),
        command=cli_command.resume_command(run.folder, plan, cli_command.relative_path(run.folder)),
        run_sha256=plan.sha256,
        rules_sha256=plan.rules_sha256,
        code_sha256=plan.code_sha256,
        scoring_sha256=code_identity.scoring_sha256(),
        trials_sha256=run.sha256,
    )


def _corrections(run: Run) -> tuple[CorrectedTrial, ...]:
    specs = {record.key: record.spec for record in run.records}
    places = {key: (spec.task.id, spec.session, spec.index) for key, spec in specs.items()}
    places |= {one.key: (one.task, one.session, one.index) for one in run.voided}
    return tuple(
        CorrectedTrial(
            correction=line,
            task=places[line.trial][0],
            session=places[line.trial][1],
            index=places[line.trial][2],
        )
        for line in run.corrections
    )


def _platforms(run: Run) -> tuple[Platform, ...]:
    path = run.folder / _PLATFORM
    if not path.is_file():
        return ()
    hint = "delete the file; the run is then of unknown platforms"
    return tuple(dict.fromkeys(documents.read(path, list[Platform], RunError, hint=hint)))
