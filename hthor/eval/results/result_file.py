"""A run's `result.json`: its contents, reading and writing."""

from __future__ import annotations

from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import RunError
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.run_config import AssetsRef, KindRef, SuiteRef
from hthor.eval.config.study_design import StudyDesign
from hthor.eval.results.paired_difference import Difference
from hthor.eval.results.scores import Scores
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import Isolation, Manifest
from hthor.trials import robot_team
from hthor.types import RobotSeat
from hthor.types.specs import LOCKSTEP, Clock

SCHEMA = "hthor.result/6"
OLD_SCHEMA = "hthor.result/5"
"""The schema of results that `hthor migrate` converts: ``mode`` had other words."""
UPLIFT_METRICS = ("sr", "twsr", "time_s")
"""The metrics that an uplift is given in."""


class Counts(Struct, frozen=True, kw_only=True):
    """Counts of trials, distinct tasks, successes, robots' messages, and trials with a fault.

    ``faults_by_seat`` counts the trials in which each seat's robot failed, ``faults_by_kind`` all faults by kind.
    ``replays`` counts sessions that began again because an agent's process was killed: each gave the agent another try.
    ``voided`` counts attempts at trials that were voided and do not count; it is absent if there were none.
    """

    trials: int
    tasks: int
    successes: int
    messages: int
    faults: int
    faults_by_seat: dict[str, int]
    faults_by_kind: dict[str, int] = {}
    replays: int = 0
    voided: int | msgspec.UnsetType = msgspec.UNSET


class AppliedCorrections(Struct, frozen=True, kw_only=True):
    """The corrections that are in effect, and the file that they are from.

    ``voided`` counts trials that are void and over, ``repeated`` void trials that are repeated, ``adoptions``
    judgements of an adoption. ``lines`` is the number of lines of the file, withdrawn corrections among them, and
    ``sha256`` its hash.
    """

    voided: int
    repeated: int
    adoptions: int
    lines: int
    sha256: str

    @property
    def count(self) -> int:
        """How many corrections are in effect."""
        return self.voided + self.repeated + self.adoptions


class Hashes(Struct, frozen=True, kw_only=True):
    """Hashes of what determines the records, and of the records themselves in order of participant and trial.

    ``code`` covers hthor's own code that can change a trial; hashes of a user's own files are with the robots and the
    kind of task. ``scoring`` covers the code that can only change how trials are judged, and made this result of them
    (`hthor.code_identity.scoring_sha256`); it is empty in results of versions that did not tell the two apart.
    """

    run: str
    human: str
    rules: str
    code: str
    scoring: str = ""
    trials: str


class Uplift(Struct, frozen=True, kw_only=True):
    """Differences from the baseline, trial by trial: the same participants, days and tasks.

    ``control`` is the hash of the baseline's configuration, ``hashes.run`` in its result.
    """

    control: str
    sr: Difference
    twsr: Difference
    time_s: Difference


class StoredUplift(Uplift, frozen=True, kw_only=True):
    """An uplift as it stands in a run's result.

    ``note`` is present only if the baseline's log was not found when the run was scored; the numbers are then those of
    an earlier scoring.
    """

    note: str | msgspec.UnsetType = msgspec.UNSET


class Effort(Struct, frozen=True, kw_only=True):
    """The cost of the command that finished the run: wall-clock time, CPU time, and trials.

    ``replays`` counts sessions that began again because a worker or an agent's process was ended from outside.
    """

    wall_s: float
    cpu_s: float
    trials: int
    replays: int = 0


class RunResult(Struct, frozen=True, kw_only=True):
    """The run's `result.json`.

    ``trust_by_trial`` is the rating after the first, second, ... trial of a session, empty without a robot. ``uplift``
    is None if no complete run without a robot was ever found. ``corrections`` is absent if none is in effect, and
    ``design`` unless the run is a group of a between-subjects study. ``mode``
    is the decision clock of its trials; with any other than "lockstep", no second run gives the same bytes. ``agents``
    lists the files of every agent that is not built in, including those that it opened only during trials.
    """

    schema: str = SCHEMA
    name: str
    robots: tuple[RobotSeat, ...]
    agents: tuple[Manifest, ...] = ()
    humans: HumanModelRef
    suite: SuiteRef
    kind: KindRef | None = None
    seed: int
    mode: Clock = LOCKSTEP
    participants: int
    design: StudyDesign | msgspec.UnsetType = msgspec.UNSET
    metrics: Scores
    by_kind: dict[str, Scores]
    trust_by_trial: tuple[Estimate, ...] = ()
    uplift: StoredUplift | None = None
    counts: Counts
    corrections: AppliedCorrections | msgspec.UnsetType = msgspec.UNSET
    versions: dict[str, str]
    hashes: Hashes
    assets: AssetsRef
    isolation: Isolation | None = None
    effort: Effort | None = None

    @property
    def label(self) -> str:
        """The run's name in tables and sentences."""
        return robot_team.display_name(self.name, self.robots)

    @property
    def over(self) -> int:
        """How many trials are over: those that count, and those that a correction voided for good."""
        return self.counts.trials + (self.corrections.voided if self.corrections else 0)


def load_result(folder: Path) -> RunResult | None:
    """The stored result of a run, None when there is none. Raises RunError for a damaged file."""
    hint = f"delete the file, and 'hthor score {folder}' writes it again"
    return documents.read_or_none(folder / "result.json", RunResult, RunError, schema=SCHEMA, hint=hint)


def load_current(folder: Path) -> RunResult | None:
    """The stored result of a run as by `load_result`; None also for a result in another version of the format."""
    return None if is_outdated(folder / "result.json") else load_result(folder)


class _Named(Struct, frozen=True):
    run: str = ""
    scoring: str = ""


class _Gained(Struct, frozen=True):
    """The part of a result that is read from every version of the format."""

    hashes: _Named = _Named()
    uplift: StoredUplift | None = None


def stored_uplift(folder: Path, *, run: str) -> StoredUplift | None:
    """The uplift in a run's stored result of any version; None if it has none for this run's hash."""
    held = _stored_part(folder)
    return held.uplift if held.hashes.run == run else None


def stored_scoring(folder: Path) -> str:
    """The scoring version that made a run's stored result of any version; empty if that is not known."""
    return _stored_part(folder).hashes.scoring


def _stored_part(folder: Path) -> _Gained:
    try:
        return documents.decode((folder / "result.json").read_bytes(), _Gained)
    except (OSError, documents.Unreadable):
        return _Gained()


def to_stored(one: Uplift | None) -> StoredUplift | None:
    """The uplift as it stands in a result."""
    if one is None or isinstance(one, StoredUplift):
        return one
    return StoredUplift(control=one.control, sr=one.sr, twsr=one.twsr, time_s=one.time_s)


def is_outdated(path: Path) -> bool:
    """Whether a file is a result of another version of the format."""
    name = documents.schema_of(path)
    return name != SCHEMA and name.startswith(SCHEMA.partition("/")[0])


def store_result(folder: Path, result: RunResult) -> None:
    """Write `result.json`."""
    jsonio.write(folder / "result.json", jsonio.pretty(result))
