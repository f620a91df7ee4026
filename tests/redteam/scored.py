"""Plays agents in real trials as `hthor eval` does, each in a run of its own, and prints what became of each, as JSON.

The world, the person, the task and the scoring are real; the task is cut short. Run as whoever is to be attacked.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import sys
import tempfile
from collections.abc import Generator
from pathlib import Path
from typing import Any

import msgspec

from hthor import guest, jsonio, tasks
from hthor.eval.config import run_config
from hthor.eval.records import run_isolation
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_log import read
from hthor.eval.runner import fault_report, progress, run, session_runner, worker
from hthor.eval.runner.worker import News
from hthor.guest import Guest, GuestConfig, GuestPool, IsolationError
from hthor.tasks.suite import make_suite
from hthor.trials import Sources, TrialRunner, Worlds, make_sources, robot_team, sessions
from hthor.types import HUMAN, AgentRef
from tests.redteam.agents import HONEST, HOSTILE, NO_FAULT, Case, source
from tests.redteam.play import SECRET, lay_out, listening

NOP = Case("nop", "pass", (NO_FAULT,), "")
_TASK, _LIMIT_S = "smoke/alder/manipulation-01", 3.0
_WORLDS = Worlds()


class _Runner(TrialRunner):
    """Keeps its world for the next run too, which saves building it for every agent."""

    def __init__(self, sources: Sources | None = None, pool: GuestPool | None = None, loop: None = None) -> None:
        super().__init__(sources, pool, _WORLDS, loop)


class _Here:
    """An engine that plays in this process."""

    def run_sessions(self, sessions: Any, make: Any) -> Generator[News | None, None, None]:
        player = worker.SessionPlayer(make)
        for one in sessions:
            yield from player.run(one)


def main(levels: list[str], wanted: list[str]) -> None:
    """Play the agents of these names, or all, at each level, with one that does nothing first."""
    os.environ["HTHOR_SALT"] = SECRET
    session_runner.TrialRunner = _Runner  # type: ignore[misc]
    cases = [one for one in (*HOSTILE, *HONEST) if not wanted or one.name in wanted]
    told: list[dict[str, Any]] = []
    missing: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as name, listening() as port:
        folder = Path(name)
        secret = folder / "salt.txt"
        secret.write_text(SECRET)
        for level in levels:
            try:
                held = guest.in_force(level)
            except IsolationError as error:
                missing[level] = str(error)
                continue
            for case in (NOP, *cases):
                text = source(case.attack, secret=str(secret), harness=os.getpid(), port=port)
                told.append(_play(folder / level / case.name, case, text, held))
        intact = secret.read_text() == SECRET
    json.dump({"uid": os.getuid(), "intact": intact, "missing": missing, "agents": told}, sys.stdout)


def _play(home: Path, case: Case, text: str, held: guest.Isolation) -> dict[str, Any]:
    """One agent's run: one person, one task; what its log, its result and its remains say."""
    path, runs = lay_out(home, text), home / "runs" / "mine"
    before = sorted(one for one in home.rglob("*"))
    step_s = 1.0 if "timeout" in case.kinds and len(case.kinds) == 1 else 20.0
    guest.Guest = functools.partial(Guest, step_s=step_s, bank_s=0.0, memory_mb=512, disk_mb=64)  # type: ignore[misc]
    task = next(task for task in tasks.load_suite("smoke").tasks if task.id == _TASK)
    suite = make_suite("short", 1, (msgspec.structs.replace(task, time_limit=_LIMIT_S),))
    ref = AgentRef(name="agent", source="agent.py", sha256=hashlib.sha256(text.encode()).hexdigest())
    crew = robot_team.form_team(["scout"], [robot_team.AgentInfo(ref=ref, path=str(path))])
    plan = run_config.build_config(suite, crew, humans="proxy", seed=0, participants=None)
    hidden = (str(home / "runs"), str(home / "official.json"))
    config = GuestConfig(isolation=held.level, hidden=hidden)
    make = functools.partial(session_runner.make_runner, make_sources(crew, guests=config))
    result = run.run_evaluation(
        plan,
        sessions.make_sessions(suite, agent=crew),
        make,
        folder=RunFolder(runs),
        engine=_Here(),
        watcher=progress.Silent(),
        extra={run_isolation.NAME: jsonio.pretty(held)},
    )
    ((_, record),) = read(runs / "trials.jsonl")
    fault = record.faults[0] if record.faults else None
    after = sorted(one for one in home.rglob("*") if runs not in (one, *one.parents))
    return {
        "name": case.name,
        "level": result.isolation.level if result.isolation else "",
        "kind": fault.kind if fault else "",
        "detail": fault.detail if fault else "",
        "breach": _breached(fault.detail if fault else "", record.key, runs),
        "counted": result.counts.faults_by_kind,
        "scored": [result.counts.trials, result.metrics.sr.n, result.metrics.time_s.mean],
        "ticks": record.ticks,
        "person": hashlib.sha256(repr(record.paths[HUMAN]).encode()).hexdigest()[:16],
        "changed": after != before or path.read_text() != text,
    }


def _breached(detail: str, key: str, runs: Path) -> bool:
    """Whether it says so with its last words; a traceback may also show the line that would have said it."""
    left = runs / fault_report.FOLDER / f"{key}.json"
    output = fault_report.load_fault_report(left).failures[0].output if left.exists() else ""
    return any("BREACH" in line for line in (*detail.strip().splitlines()[-1:], *output.splitlines()))


if __name__ == "__main__":
    main(sys.argv[1].split(","), sys.argv[2:])
