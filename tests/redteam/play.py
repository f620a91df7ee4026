"""Plays agents at one level and prints what became of each, as JSON; run as whoever is to be attacked."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from hthor.guest import Guest, GuestConfig, GuestFault
from tests.redteam.agents import HONEST, HOSTILE, Case, source
from tests.support.guest_agents import BRIEFING, look

SECRET = "pepper and salt"


def main(level: str, wanted: list[str]) -> None:
    """Play the agents of these names, or all."""
    os.environ["HTHOR_SALT"] = SECRET
    with tempfile.TemporaryDirectory() as folder, listening() as port:
        secret = Path(folder) / "salt.txt"
        secret.write_text(SECRET)
        jobs = [one for one in (*HOSTILE, *HONEST) if not wanted or one.name in wanted]

        hidden = tuple(str(Path(folder) / name / "official.json") for name, *_ in jobs)
        config = GuestConfig(isolation=level, hidden=hidden)

        def one(job: Case) -> dict[str, Any]:
            home = Path(folder) / job.name
            text = source(job.attack, secret=str(secret), harness=os.getpid(), port=port)
            return _play(home, job, text, config)

        with ThreadPoolExecutor(4) as pool:
            told = list(pool.map(one, jobs))
        intact = secret.read_text() == SECRET
    json.dump({"uid": os.getuid(), "intact": intact, "agents": told}, sys.stdout)


def _play(home: Path, case: Case, text: str, config: GuestConfig) -> dict[str, Any]:
    path = lay_out(home, text)
    before = sorted(home.rglob("*"))
    fault, log, held = {"kind": "", "detail": ""}, "", {}
    with Guest(
        path, step_s=2.0 if case.kinds == ("timeout",) else 30.0, bank_s=0.0, config=config, memory_mb=512, disk_mb=64
    ) as mind:
        try:
            held = {"level": mind.load().isolation.level}
            mind.begin(BRIEFING)
            for tick in range(3):
                mind.act(look(tick))
        except GuestFault as caught:
            fault, log = {"kind": caught.kind, "detail": str(caught)}, caught.log
        log = log or mind.log
        again = ""
        try:  # the next trial is played whatever became of this one
            mind.begin(BRIEFING)
        except GuestFault as caught:
            again = str(caught)
    changed = sorted(home.rglob("*")) != before or path.read_text() != text
    return {"name": case.name, **held, "fault": fault, "log": log[-2000:], "again": again, "changed": changed}


def lay_out(home: Path, text: str) -> Path:
    """An agent's file, with helpers of its own and secrets of others beside it."""
    (home / "runs").mkdir(parents=True)
    (home / "runs" / "trials.jsonl").write_text(SECRET)
    (home / "official.json").write_text(SECRET)
    (home / "weights.txt").write_text("w")
    (home / "helper.py").write_text("VALUE = 3\n")
    path = home / "agent.py"
    path.write_text(text)
    return path


@contextlib.contextmanager
def listening() -> Iterator[int]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
