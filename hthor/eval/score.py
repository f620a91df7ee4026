"""A run's result from its log: metrics with intervals, counts and hashes; knows nothing of how trials are played."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from operator import attrgetter
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.errors import RunError
from hthor.eval import control, guarded, log, metrics, setup, stats
from hthor.eval.log import Place
from hthor.eval.metrics import TrialMetrics
from hthor.eval.peoples import HumansRef
from hthor.eval.record import Record
from hthor.eval.setup import AssetsRef, KindRef, Setup, SuiteRef
from hthor.eval.stats import Estimate
from hthor.eval.uplift import Uplift
from hthor.guest import Isolation
from hthor.types import RobotSeat

SCHEMA = "hthor.result/4"


class Scores(Struct, frozen=True, kw_only=True):
    """The run's metrics as fractions, seconds, trust points and counts a trial; see `hthor.eval.metrics`.

    ``work`` has a share for each seat, ``hindered_by`` seconds for each pair, such as "human by robot".
    """

    sr: Estimate
    twsr: Estimate
    adoption: Estimate
    time_s: Estimate
    trust: Estimate
    progress: Estimate
    idle_s: Estimate
    in_way: Estimate
    hindered_s: Estimate
    sent: Estimate
    accepted: Estimate
    declined: Estimate
    covered: Estimate
    unanswered: Estimate
    false_claims: Estimate
    precision: Estimate
    first_useful_s: Estimate
    interruptions_per_min: Estimate
    work: dict[str, Estimate]
    hindered_by: dict[str, Estimate]


class Counts(Struct, frozen=True, kw_only=True):
    """How much there is: trials, distinct tasks, successes, messages sent by robots, and trials with a fault.

    ``faults_by_seat`` counts the trials in which the robot of each seat failed, ``faults_by_kind`` all faults by what
    they were.
    """

    trials: int
    tasks: int
    successes: int
    messages: int
    faults: int
    faults_by_seat: dict[str, int]
    faults_by_kind: dict[str, int] = {}


class Hashes(Struct, frozen=True, kw_only=True):
    """Hashes of what decides the records, and of the records themselves, whatever their order in the log.

    ``code`` covers everything that ships with hthor; the hashes of a user's own files are with the robots and the kind.
    """

    run: str
    human: str
    rules: str
    code: str
    trials: str


class Effort(Struct, frozen=True, kw_only=True):
    """What it took the command that finished the run: time on the wall, CPU time, and how many trials it played.

    ``replays`` counts sessions that began again, as a worker or an agent's process was ended from outside.
    """

    wall_s: float
    cpu_s: float
    trials: int
    replays: int = 0


class Result(Struct, frozen=True, kw_only=True):
    """The run's `result.json`.

    ``trust_by_trial`` is the rating after the first, second, ... trial of a person's session, empty without a robot.
    ``uplift`` is None where no whole run without a robot lay beside this one. ``mode`` is "realtime" where thinking
    took time of the trials, which no second run repeats byte for byte, else "lockstep".
    """

    schema: str = SCHEMA
    name: str
    robots: tuple[RobotSeat, ...]
    humans: HumansRef
    suite: SuiteRef
    kind: KindRef | None = None
    seed: int
    mode: str = setup.LOCKSTEP
    participants: int
    metrics: Scores
    by_kind: dict[str, Scores]
    trust_by_trial: tuple[Estimate, ...] = ()
    uplift: Uplift | None = None
    counts: Counts
    versions: dict[str, str]
    hashes: Hashes
    assets: AssetsRef
    isolation: Isolation | None = None
    effort: Effort | None = None


def records(folder: Path, plan: Setup) -> tuple[list[bytes], list[Record]]:
    """Every line of a run's log and its record, in the order of people and their trials.

    Raises:
        RunError: when a line is damaged, or is a trial of another run.
    """
    found = sorted(log.read(folder / "trials.jsonl"), key=lambda pair: (pair[1].spec.participant, pair[1].spec.index))
    for _, record in found:
        check_origin(folder, record, plan)
    _check_once(folder, [record.key for _, record in found])
    return [line for line, _ in found], [record for _, record in found]


def digest(folder: Path, plan: Setup) -> tuple[list[Place], list[Record]]:
    """As `records`, for runs of any length: lines stay on the disk, and records come without paths and journal.

    Raises:
        RunError: as `records`.
    """
    found: list[tuple[Place, Record]] = []
    for place, _, record in log.places(folder / "trials.jsonl"):
        check_origin(folder, record, plan)
        found.append((place, msgspec.structs.replace(record, paths={}, journal=())))
    found.sort(key=lambda pair: (pair[1].spec.participant, pair[1].spec.index))
    _check_once(folder, [record.key for _, record in found])
    return [place for place, _ in found], [record for _, record in found]


def _check_once(folder: Path, keys: Sequence[str]) -> None:
    twice = next((key for key in keys if keys.count(key) > 1), "") if len(set(keys)) < len(keys) else ""
    if twice:
        raise RunError(f"{folder / 'trials.jsonl'}: trial {twice} is there twice. Delete one of the two lines.")


def check_origin(folder: Path, record: Record, plan: Setup) -> None:
    """See that a record is one of this run's."""
    spec = record.spec
    pairs = {
        "seed": (spec.seed, plan.seed),
        "human_sha256": (spec.human_sha256, plan.humans.sha256),
        "suite_sha256": (spec.suite_sha256, plan.suite.sha256),
        "rules_sha256": (spec.rules_sha256, plan.rules_sha256),
        "code_sha256": (spec.code_sha256, plan.code_sha256),
        "robots": (spec.robots, plan.seats),
        "kind_sha256": (spec.kind_sha256, plan.kind.sha256 if plan.kind else ""),
        "realtime": (bool(spec.realtime), bool(plan.realtime)),
    }
    for field, (here, there) in pairs.items():
        if here != there:
            raise RunError(
                f"{folder / 'trials.jsonl'}: trial {record.key}: spec.{field} is not the one in run.json. "
                "The line belongs to another run; delete it."
            )


def summarise(
    plan: Setup,
    lines: Iterable[bytes],
    records: Sequence[Record],
    effort: Effort | None = None,
    *,
    uplift: Uplift | None = None,
    isolation: Isolation | None = None,
) -> Result:
    """The result of the records of a run, whole or not."""
    trials = hashlib.sha256()
    for line in lines:
        trials.update(line)
    kinds = sorted({record.spec.task.kind for record in records})
    whole = scores(records)
    by_kind = {
        kind: whole if len(kinds) == 1 else scores([record for record in records if record.spec.task.kind == kind])
        for kind in kinds
    }
    return Result(
        name=plan.name,
        robots=plan.robots,
        humans=plan.humans,
        suite=plan.suite,
        kind=plan.kind,
        seed=plan.seed,
        mode=plan.mode,
        participants=plan.participants,
        metrics=whole,
        by_kind=by_kind,
        trust_by_trial=_by_trial(records),
        uplift=uplift,
        counts=Counts(
            trials=len(records),
            tasks=len({record.spec.task.id for record in records}),
            successes=sum(record.met for record in records),
            messages=sum(event.kind == "sent" for record in records for event in record.events),
            faults=sum(bool(record.faults) for record in records),
            faults_by_seat={
                robot.seat: sum(any(fault.seat == robot.seat for fault in record.faults) for record in records)
                for robot in plan.seats
            },
            faults_by_kind=dict(sorted(Counter(fault.kind for one in records for fault in one.faults).items())),
        ),
        versions=plan.versions,
        hashes=Hashes(
            run=plan.sha256,
            human=plan.humans.sha256,
            rules=plan.rules_sha256,
            code=plan.code_sha256,
            trials=trials.hexdigest(),
        ),
        assets=plan.assets,
        isolation=isolation,
        effort=effort,
    )


def scores(records: Sequence[Record]) -> Scores:
    """Means and intervals of every metric; trials for which a metric has no value do not count for it."""
    single = {name: _score(records, name, attrgetter(name)) for name in metrics.NAMES}
    return Scores(**single, work=_by_name(records, "work"), hindered_by=_by_name(records, "hindered_by"))


def _by_trial(records: Sequence[Record]) -> tuple[Estimate, ...]:
    """Trust after each trial of a session, in their order."""
    rated = [record for record in records if record.metrics.trust is not None]
    last = max((record.spec.index for record in rated), default=-1)
    return tuple(
        _score([record for record in rated if record.spec.index == index], "trust", attrgetter("trust"))
        for index in range(last + 1)
    )


def _by_name(records: Sequence[Record], metric: str) -> dict[str, Estimate]:
    """An estimate for each name that the metric has values for, in the order in which they first come."""
    names = dict.fromkeys(name for record in records for name in getattr(record.metrics, metric))
    return {name: _score(records, metric, partial(_named, metric, name)) for name in names}


def _named(metric: str, name: str, one: TrialMetrics) -> float | None:
    values: dict[str, float] = getattr(one, metric)
    return values.get(name)


def _score(records: Sequence[Record], name: str, value: Callable[[TrialMetrics], float | None]) -> Estimate:
    measured = [(value(record.metrics), record.spec) for record in records]
    held = [(float(found), spec) for found, spec in measured if found is not None]
    return stats.estimate(
        [found for found, _ in held],
        [spec.task.id for _, spec in held],
        [spec.participant for _, spec in held],
        within=metrics.RANGES.get(name, metrics.AMOUNT),
    )


def rescore(folder: Path) -> tuple[Setup, Result, Result | None]:
    """Score a run again from its log alone: its configuration, the new result, and the stored one if there is any.

    Every trial's metrics are worked out anew from its events. The stored effort is kept, as no log has it. A stored
    result of another version of the format counts as none: the log has all that it takes.
    """
    plan = setup.load(folder)
    lines, kept = records(folder, plan)
    fresh, stored = _measured(kept), None if _outdated(folder / "result.json") else load(folder)
    effort = stored.effort if stored else None
    beside, held = control.beside(folder, plan, fresh), guarded.load(folder)
    return plan, summarise(plan, lines, fresh, effort, uplift=beside, isolation=held), stored


def measured(folder: Path) -> tuple[Setup, list[Record]]:
    """A run's configuration and its records, every trial's metrics worked out anew from its events."""
    plan = setup.load(folder)
    return plan, _measured(records(folder, plan)[1])


def _measured(kept: Iterable[Record]) -> list[Record]:
    return [msgspec.structs.replace(record, metrics=metrics.measure(record.spec, record.log)) for record in kept]


def load(folder: Path) -> Result | None:
    """The stored result of a run, None when there is none.

    Raises:
        RunError: when it cannot be read.
    """
    path = folder / "result.json"
    if not path.is_file():
        return None
    try:
        return msgspec.json.decode(path.read_bytes(), type=Result)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RunError(f"{path}: {error}. Delete the file; 'hthor score {folder}' writes it anew.") from None


def _outdated(path: Path) -> bool:
    """Whether a file is a result of another version of the format."""
    try:
        schema = msgspec.json.decode(path.read_bytes(), type=dict[str, msgspec.Raw]).get("schema", msgspec.Raw(b'""'))
        name = msgspec.json.decode(schema, type=str)
    except (OSError, msgspec.DecodeError, UnicodeDecodeError):
        return False
    return name != SCHEMA and name.startswith(SCHEMA.partition("/")[0])


def store(folder: Path, result: Result) -> None:
    """Write `result.json`."""
    jsonio.write(folder / "result.json", jsonio.pretty(result))
