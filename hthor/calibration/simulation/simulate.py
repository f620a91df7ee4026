"""Simulates sessions with several worker processes, and resumes where an earlier command ended."""

import functools
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import jsonio, seeds
from hthor.calibration.simulation import design_points, session_simulation, session_store, trial_table
from hthor.calibration.simulation.session_simulation import OUTCOMES, SessionOutcome, SessionSpec
from hthor.calibration.simulation.session_store import SessionStore, TrialIdentity
from hthor.calibration.simulation.trial_table import AGENTS, Table
from hthor.calibration.targets import CONDITIONS, Design
from hthor.errors import RunError
from hthor.eval.runner.collector import InternalFailure
from hthor.eval.runner.engines import Interrupted, stoppable
from hthor.eval.runner.engines.local import SessionLost, run_all_sessions
from hthor.eval.runner.messages import TrialDone
from hthor.eval.runner.progress import Watcher
from hthor.humans.population import parameter_registry
from hthor.tasks import Suite
from hthor.trials import sessions

_MET = OUTCOMES.index("met")


class SessionBatch(Struct, frozen=True, kw_only=True):
    """Sessions of a suite and the populations that their people come from.

    ``sessions`` has tuples (study, number of the session, row of ``points``, session), in the table's order.
    """

    suite: Suite
    identity: TrialIdentity
    points: np.ndarray
    sessions: tuple[tuple[int, int, int, SessionSpec], ...]


def simulate_sessions(
    points: np.ndarray, suite: Suite, seed: int, folder: Path, jobs: int, watch: Watcher, name: str
) -> Table:
    """One session per point, each with a person from that point; conditions take turns.

    Args:
        points: (S, P) points of the prior's unit cube.
        folder: where sessions are stored; a later call with more points simulates only the missing sessions.
        name: name of these sessions; other names give other people and random numbers.

    Raises:
        RunError: when the folder has sessions of another world or human model.
        Interrupted: on Ctrl-C or SIGTERM.
    """
    points = design_points.round_points(points)
    identity, own_seed = session_store.trials_identity(suite), seeds.derive(seed, "calibration", name)
    specs = tuple(
        (-1, number, number, make_session_spec(suite, identity, own_seed, number, point, assign_condition(number)))
        for number, point in enumerate(points.tolist())
    )
    batch = SessionBatch(suite=suite, identity=identity, points=points, sessions=specs)
    return make_table(batch, run_missing(batch, folder, jobs, watch))


def assign_condition(number: int) -> int:
    """The condition of a training session: the conditions in turn, starting one later every three sessions.

    Three people with consecutive numbers do all tasks between them, so each condition meets each third of the tasks.
    """
    return (number + number // 3) % len(CONDITIONS)


def make_session_spec(
    suite: Suite, identity: TrialIdentity, seed: int, participant: int, point: Sequence[float], condition: int
) -> SessionSpec:
    """The session of a participant of the study with this seed, drawn from the population at a point."""
    tasks = tuple(sessions.assign_tasks(suite.tasks, seed, participant))
    key = jsonio.sha256([identity.sha256, seed, participant, list(point), condition, tasks])[:16]
    return SessionSpec(
        key=key, seed=seed, participant=participant, point=tuple(point), condition=condition, tasks=tasks
    )


def run_missing(batch: SessionBatch, folder: Path, jobs: int, watch: Watcher) -> Mapping[str, SessionOutcome]:
    """Run the sessions of a batch that the folder lacks; returns all sessions of the batch by key."""
    wanted = [spec for *_, spec in batch.sessions]
    with SessionStore(folder, batch.identity) as store:
        left = [spec for spec in wanted if spec.key not in store.sessions]
        total, missing = (sum(len(spec.tasks) for spec in specs) for specs in (wanted, left))
        watch.begin(total, total - missing)
        if store.cut_bytes:
            watch.note(f"cut {store.cut_bytes} bytes of a session that was being written when the last command ended")
        if left:
            _run(batch.suite, left, store, jobs, watch)
        lost = [spec.key for spec in wanted if spec.key not in store.sessions]
        if lost:
            raise RunError(f"{folder}: {len(lost)} sessions were not simulated. Repeat the command.")
        return {spec.key: store.sessions[spec.key] for spec in wanted}


def make_table(batch: SessionBatch, outcomes: Mapping[str, SessionOutcome], **more: Any) -> Table:
    """The table of a batch's sessions; ``more`` replaces columns that have defaults for sessions outside studies."""
    rows = [
        (study, number, point, spec.condition, spec.participant, index, *row)
        for study, number, point, spec in batch.sessions
        for index, row in enumerate(outcomes[spec.key].rows)
    ]
    names = ("study", "session", "point", "condition", "participant", "index", *OUTCOMES)
    columns: dict[str, Any] = dict(zip(names, np.array(rows, dtype=np.int64).T, strict=True))
    columns |= {"valid": np.ones(len(rows), bool), "counted": columns["condition"] > 0, **more}
    return trial_table.build_table(parameter_registry.free_parameter_names(), batch.points, columns)


def _run(suite: Suite, left: Sequence[SessionSpec], store: SessionStore, jobs: int, watch: Watcher) -> None:
    # The runner's types are those of evaluations; it hands sessions and outcomes through as they are.
    make: Any = functools.partial(session_simulation.make_session_runner, suite, AGENTS, session_store.ROBOT)
    specs: Any = left
    with stoppable() as stop, closing(run_all_sessions(specs, make, jobs=jobs)) as stream:
        try:
            for message in stream:
                if isinstance(message, TrialDone):
                    outcome = store.append(message.line)
                    if not outcome.key:
                        watch.played(bool(outcome.rows[0][_MET]), False)
                watch.beat()
                if stop.is_set():
                    raise Interrupted(f"interrupted after {len(store.sessions)} sessions; the same command resumes.")
        except SessionLost as failure:
            if failure.detail:
                path = store.path.with_name("error.txt")
                jsonio.write(path, failure.detail.encode())
                raise InternalFailure(f"{failure}. The traceback is in {path}.") from None
            raise


def simulate_studies(
    points: np.ndarray, suite: Suite, seed: int, folder: Path, jobs: int, watch: Watcher, name: str, design: Design
) -> Table:
    """A study of the published ``design`` at each point; study number s has people from row s.

    It has the design's number of people per condition, with tasks as `hthor eval` assigns them, and loses as many
    trials, drawn at random. Other arguments as in `simulate_sessions`.
    """
    points, identity = design_points.round_points(points), session_store.trials_identity(suite)
    specs = []
    for study, point in enumerate(points.tolist()):
        own_seed = study_seed(seed, name, study)
        for participant in range(design.people * len(CONDITIONS)):
            condition = participant // design.people
            spec = make_session_spec(suite, identity, own_seed, participant, point, condition)
            specs.append((study, participant, study, spec))
    batch = SessionBatch(suite=suite, identity=identity, points=points, sessions=tuple(specs))
    outcomes = run_missing(batch, folder, jobs, watch)
    valid, counted = select_counted(make_table(batch, outcomes), seed, name, design)
    return make_table(batch, outcomes, valid=valid, counted=counted)


def study_seed(seed: int, name: str, study: int) -> int:
    """The seed of one study, for its people, their tasks and all its random numbers."""
    return seeds.derive(seed, "calibration", name, study)


def select_counted(table: Table, seed: int, name: str, design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Masks of the trials that count in success and in adoption rates: per group, as many as in the published study."""
    valid, counted = np.zeros(len(table), bool), np.zeros(len(table), bool)
    group = table.study.astype(np.int64) * len(CONDITIONS) + table.condition
    for number in range(len(table.points) * len(CONDITIONS)):
        study, condition = divmod(number, len(CONDITIONS))
        rows, label = np.flatnonzero(group == number), CONDITIONS[condition]
        mixed = rows[seeds.shuffled(len(rows), study_seed(seed, name, study), "kept", label)]
        valid[mixed[: design.valid.get(label, len(rows))]] = True
        counted[mixed[: design.counted.get(label, 0)]] = True
    return valid, counted
