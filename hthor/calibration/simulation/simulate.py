"""Sessions simulated in the real world, by several workers, resumed where an earlier command ended."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import jsonio, seeds
from hthor.calibration.simulation import design_points, session_simulation, trial_identity, trial_table
from hthor.calibration.simulation.session_simulation import OUTCOMES, SessionOutcome, SessionSpec
from hthor.calibration.simulation.session_store import SessionStore
from hthor.calibration.simulation.trial_identity import Identity
from hthor.calibration.simulation.trial_table import AGENTS, CONDITIONS, Table
from hthor.errors import RunError
from hthor.eval.config import robot_team, sessions
from hthor.eval.runner.collector import InternalFailure
from hthor.eval.runner.engines.local import SessionLost, run_all_sessions
from hthor.eval.runner.interrupt import Interrupted, stoppable
from hthor.eval.runner.messages import TrialDone
from hthor.eval.runner.progress import Watcher
from hthor.humans.population import parameter_registry
from hthor.tasks import Suite
from hthor.types import RobotSeat

"""The robots' body. Its speed is the system setting that the published study does not tell."""

_MET = OUTCOMES.index("met")


class Plan(Struct, frozen=True, kw_only=True):
    """Sessions of a suite: whose, and where their people come from.

    ``sittings`` are (study, session, row of ``points``, sitting), in the table's order.
    """

    suite: Suite
    identity: Identity
    points: np.ndarray
    sittings: tuple[tuple[int, int, int, SessionSpec], ...]


def training(suite: Suite, seed: int, sessions: int, folder: Path, jobs: int, watch: Watcher) -> Table:
    """Sessions of people from all over the prior, one person from each point.

    The first sessions are the same for every number of them. The rest as `at` has it.
    """
    where = design_points.spread(sessions, len(parameter_registry.free_parameter_names()), seed, "training")
    return at(where, suite, seed, folder, jobs, watch, "training")


def at(where: np.ndarray, suite: Suite, seed: int, folder: Path, jobs: int, watch: Watcher, name: str) -> Table:
    """A session of one person from each point, the conditions in turn.

    Args:
        where: (S, P) points of the prior's unit cube.
        folder: where played sessions are kept; a later call with more of them plays only what is missing.
        name: of these sessions; their people and chances are their own.

    Raises:
        RunError: when the folder holds sessions of another world or person.
        Interrupted: on Ctrl-C or SIGTERM.
    """
    spots = design_points.tidy(where)
    known, own = trial_identity.trials_identity(suite), seeds.derive(seed, "calibration", name)
    dealt = tuple(
        (-1, number, number, place(suite, known, own, number, row, turn(number)))
        for number, row in enumerate(spots.tolist())
    )
    plan = Plan(suite=suite, identity=known, points=spots, sittings=dealt)
    return tabulate(plan, perform(plan, folder, jobs, watch))


def turn(number: int) -> int:
    """The condition of a training session: each in turn, and in every third round of hands another first."""
    return (number + number // 3) % len(CONDITIONS)


def place(
    suite: Suite, known: Identity, seed: int, participant: int, point: Sequence[float], condition: int
) -> SessionSpec:
    """The session of a participant of the study with this seed, drawn from the population at a point."""
    tasks = tuple(sessions.assign_tasks(suite.tasks, seed, participant))
    what = [known.sha256, seed, participant, list(point), condition, tasks]
    key = jsonio.sha256(what)[:16]
    return SessionSpec(
        key=key, seed=seed, participant=participant, point=tuple(point), condition=condition, tasks=tasks
    )


def perform(plan: Plan, folder: Path, jobs: int, watch: Watcher) -> Mapping[str, SessionOutcome]:
    """Play what a plan still lacks; every session by its key."""
    wanted = [one for *_, one in plan.sittings]
    with SessionStore(folder, plan.identity) as ledger:
        left = [one for one in wanted if one.key not in ledger.held]
        total, lacking = (sum(len(one.tasks) for one in some) for some in (wanted, left))
        watch.begin(total, total - lacking)
        if ledger.torn:
            watch.note(f"cut {ledger.torn} bytes of a session that was being written when the last command ended")
        if left:
            _play(plan.suite, left, ledger, jobs, watch)
        missing = [one.key for one in wanted if one.key not in ledger.held]
        if missing:
            raise RunError(f"{folder}: {len(missing)} sessions were not played. Repeat the command.")
        return {one.key: ledger.held[one.key] for one in wanted}


def tabulate(plan: Plan, sats: Mapping[str, SessionOutcome], **more: Any) -> Table:
    """The table of a plan's sessions.

    Args:
        more: columns instead of the ones that a session outside any study has.
    """
    rows = [
        (study, number, point, one.condition, one.participant, index, *row)
        for study, number, point, one in plan.sittings
        for index, row in enumerate(sats[one.key].rows)
    ]
    names = ("study", "session", "point", "condition", "participant", "index", *OUTCOMES)
    columns: dict[str, Any] = dict(zip(names, np.array(rows, dtype=np.int64).T, strict=True))
    columns |= {"valid": np.ones(len(rows), bool), "counted": columns["condition"] > 0, **more}
    return trial_table.build(parameter_registry.free_parameter_names(), plan.points, columns)


def robots() -> tuple[tuple[RobotSeat, ...], ...]:
    """The robots of each condition."""
    return tuple(robot_team.form_team([trial_identity.ROBOT], [agent]).seats for agent in AGENTS)


def _play(suite: Suite, left: Sequence[SessionSpec], ledger: SessionStore, jobs: int, watch: Watcher) -> None:
    make: Any = functools.partial(
        session_simulation.player, suite, robots()
    )  # what it plays and gives is ours to choose
    some: Any = left
    with stoppable() as stop, closing(run_all_sessions(some, make, jobs=jobs)) as stream:
        try:
            for news in stream:
                if isinstance(news, TrialDone):
                    sat = ledger.append(news.line)
                    if not sat.key:
                        watch.played(bool(sat.rows[0][_MET]), False)
                watch.beat()
                if stop.is_set():
                    raise Interrupted(f"interrupted after {len(ledger.held)} sessions; the same command resumes.")
        except SessionLost as failure:
            if failure.detail:
                jsonio.write(ledger.path.with_name("error.txt"), failure.detail.encode())
                raise InternalFailure(f"{failure}. The traceback is in {ledger.path.with_name('error.txt')}.") from None
            raise
