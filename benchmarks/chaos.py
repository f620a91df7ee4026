"""``python -m benchmarks.chaos``: a run whose processes are killed, whose log is torn and whose disk fills.

What is left must be every record once, each as in a run that nobody disturbed, and no process. By default trials and
agents are made up, so that only the keeping of records is tried. With ``--agents held`` agents are real guests, with
``--agents whole`` all of 'hthor eval' is real.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import resource
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks import family

ROOT = Path(__file__).resolve().parents[1]
FAKES = ROOT / "tests" / "support" / "eval_fakes.py"
MARK = "HTHOR_CHAOS"
_PATIENCE_S = 300.0
_IDLE_MAX = 5
"""Ends of the command in a row that played nothing new; more means that it cannot run."""


@dataclass
class Report:
    """What was done to a run, and what is left of it."""

    killed: dict[str, int] = field(default_factory=lambda: {"runner": 0, "worker": 0, "guest": 0})
    torn: int = 0
    full: int = 0
    commands: int = 0
    ended: list[str] = field(default_factory=list)
    orphans: list[str] = field(default_factory=list)


def fake(folder: Path, trials: int) -> list[str]:
    """The command that plays made-up trials with made-up guests."""
    return [sys.executable, str(FAKES), "guarded", str(folder), str(trials)]


def held(folder: Path, trials: int, agent: Path, level: str) -> list[str]:
    """The command that plays trials of a made-up world with real guests."""
    return [sys.executable, str(FAKES), "hosted", str(folder), str(trials), str(agent), level]


def whole(folder: Path, trials: int, agent: Path, level: str) -> list[str]:
    """The command that plays real trials with a submitted agent."""
    words = f"--suite smoke --participants {trials // 10} --no-control --quiet --jobs 2 --isolation {level}"
    return [sys.executable, "-m", "hthor", "eval", "--agent", str(agent), "--out", str(folder), *words.split()]


class Chaos:
    """Disturbs the runs of one folder.

    Args:
        command: plays what is missing in ``folder``.
        seed: of what happens when, as far as the machine lets it be chosen.
    """

    def __init__(self, command: Sequence[str], folder: Path, *, seed: int = 0) -> None:
        self.report = Report()
        self._command, self._folder, self._chance = list(command), folder, random.Random(seed)
        self._mark = uuid.uuid4().hex
        libraries = os.pathsep.join(filter(None, [os.environ.get("LD_LIBRARY_PATH"), f"/nowhere/{self._mark}"]))
        self._environment = {  # of all this, guests get to see the last
            **os.environ,
            MARK: self._mark,
            "TMPDIR": str(folder.parent),
            "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests" / "support"), str(ROOT / "tests")]),
            "LD_LIBRARY_PATH": libraries,
        }
        self._known: set[tuple[int, str]] = set()
        self._log = folder / "trials.jsonl"

    def kill(self, kills: int, total: int, room: int) -> None:
        """Kill so many processes at random moments over a run of ``total`` trials: one guest, else runners and workers.

        A run has one do-over for a guest that is killed; of another it would have the fault.
        After the first two deaths of the runner the disk has ``room`` for so many more bytes.
        """
        kinds = ["guest", *(("runner", "worker", "worker")[number % 3] for number in range(kills - 1))]
        self._chance.shuffle(kinds)
        aims = sorted(self._chance.uniform(0.02, 0.85) * total for _ in kinds)
        process: subprocess.Popen[str] | None = None
        for kind, aim in zip(kinds, aims, strict=True):
            process = self._until(process, int(aim))
            time.sleep(self._chance.uniform(0.0, 0.1))
            self._known |= {(pid, born) for pid in family.of(process.pid) if (born := family.born(pid))}
            if kind == "runner":
                process.kill()
                process.communicate()
                process = None
                self.report.killed[kind] += 1
                self._expect_nobody()
                if self.report.torn < 3:
                    self._tear()
                if self.report.full < 2:
                    self.fill(room)
            else:
                self.report.killed[kind] += self._kill_one(process, kind)
        if process is not None:
            self._note(process)

    def fill(self, room: int) -> None:
        """Run with a disk that has room for so many more bytes than the whole lines of the log."""
        lines = self._log.read_bytes() if self._log.exists() else b""
        limit = (lines.rfind(b"\n") + 1 + room,) * 2  # a torn line makes way, so that its bytes are no room
        process = self._start(preexec=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
        self._note(process)
        self.report.full += 1
        self._expect_nobody()

    def finish(self) -> None:
        """Let the run come to its end."""
        for _ in range(5):
            process = self._start()
            self._note(process)
            if process.returncode == 0:
                break
        self._expect_nobody()

    def played(self) -> int:
        """How many whole lines the log has."""
        return self._log.read_bytes().count(b"\n") if self._log.exists() else 0

    def _start(self, preexec=None) -> subprocess.Popen[str]:  # type: ignore[no-untyped-def]
        self.report.commands += 1
        return subprocess.Popen(
            self._command, env=self._environment, stderr=subprocess.PIPE, text=True, preexec_fn=preexec
        )

    def _until(self, process: subprocess.Popen[str] | None, trials: int) -> subprocess.Popen[str]:
        """Have a run going that has come so far. Raises RuntimeError when it keeps ending before it plays anything."""
        end, idle, played = time.monotonic() + _PATIENCE_S, 0, self.played()
        while True:
            if process is None:
                process = self._start()
            if process.poll() is not None:
                self._note(process)
                idle = 0 if self.played() > played else idle + 1
                if process.returncode == 0:
                    self._cut(trials)  # it was faster than what should have disturbed it
                process, played = None, self.played()
                if idle == _IDLE_MAX:
                    raise RuntimeError(f"the command ended {idle} times without a new trial: {self.report.ended[-1:]}")
            elif self.played() >= trials and family.children(process.pid):
                return process
            if time.monotonic() > end:
                raise TimeoutError(f"the run does not get beyond {self.played()} trials: {self.report}")
            time.sleep(0.003)

    def _kill_one(self, process: subprocess.Popen[str], kind: str) -> bool:
        """Kill a worker or a guest; false when there was none within a while."""
        end = time.monotonic() + 5.0
        while time.monotonic() < end and process.poll() is None:
            workers = [pid for pid in family.children(process.pid) if "spawn_main" in family.words(pid)]
            found = workers if kind == "worker" else [pid for one in workers for pid in family.of(one)[1:]]
            if found:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(self._chance.choice(found), 9)
                    return True
            time.sleep(0.001)
        return False

    def _tear(self) -> None:
        """Cut a part of the last line, as a machine that loses power does."""
        if lines := self._log.read_bytes().splitlines(keepends=True):
            os.truncate(self._log, self._log.stat().st_size - self._chance.randint(1, len(lines[-1]) - 1))
            self.report.torn += 1

    def _cut(self, trials: int) -> None:
        """Leave the log with so many trials."""
        lines = self._log.read_bytes().splitlines(keepends=True)
        os.truncate(self._log, sum(map(len, lines[:trials])))

    def _note(self, process: subprocess.Popen[str]) -> None:
        """Wait for a command's end, and keep its last words when it failed."""
        words = process.communicate(timeout=_PATIENCE_S)[1].strip()
        if process.returncode:
            self.report.ended.append(f"{process.returncode}: {words.splitlines()[-1] if words else ''}")

    def _expect_nobody(self) -> None:
        end = time.monotonic() + 10.0
        while found := [
            *family.marked(self._mark),
            *(f"process {pid}" for pid, born in self._known if family.born(pid) == born),
        ]:
            if time.monotonic() > end:
                self.report.orphans += found
                return
            time.sleep(0.005)


def differences(folder: Path, reference: Path) -> list[str]:
    """What is not as in the reference, none when all is."""
    here, there = (
        sorted((one / "trials.jsonl").read_bytes().splitlines(keepends=True), key=lambda line: json.loads(line)["key"])
        for one in (folder, reference)
    )
    keys = [json.loads(line)["key"] for line in here]
    told = []
    if len(set(keys)) < len(keys):
        told.append(f"{len(keys) - len(set(keys))} records are there more than once")
    if here != there:
        told.append(f"{len(set(there) - set(here))} of {len(there)} records are missing or not the same")
    mine, other = (json.loads((one / "result.json").read_bytes()) for one in (folder, reference))
    for result in (mine, other):
        del (
            result["effort"],
            result["counts"]["replays"],
        )  # what it cost, and what kills made necessary
    if mine != other:
        told.append("result.json is another")
    return told


def main() -> None:
    """Disturb a run and print what is left."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.chaos", description=__doc__.split("\n\n")[0])
    options.add_argument("--trials", type=int, default=2000)
    options.add_argument("--kills", type=int, default=15)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--agents", choices=("made-up", "held", "whole"), default="made-up")
    options.add_argument("--isolation", default="L3", help="level of agents that are not made up")
    options.add_argument("--room", type=int, default=30_000, help="bytes that a full disk has left")
    given = options.parse_args()
    with tempfile.TemporaryDirectory(prefix="hthor-chaos-") as name:
        reference, folder = Path(name, "undisturbed"), Path(name, "disturbed")
        sys.path[:0] = [str(ROOT / "tests" / "support"), str(ROOT / "tests")]
        import guest_fakes

        agent = guest_fakes.write(Path(name, "agent"))

        def command(where: Path) -> list[str]:
            if given.agents == "made-up":
                return fake(where, given.trials)
            make = held if given.agents == "held" else whole
            return make(where, given.trials, agent, given.isolation)

        began = time.monotonic()
        Chaos(command(reference), reference).finish()
        middle = time.monotonic()
        chaos = Chaos(command(folder), folder, seed=given.seed)
        chaos.kill(given.kills, given.trials, given.room)
        chaos.finish()
        told, report = differences(folder, reference), chaos.report
        print(f"agents: {given.agents}{'' if given.agents == 'made-up' else ', held at ' + given.isolation}")
        print(f"undisturbed {middle - began:.1f} s, disturbed {time.monotonic() - middle:.1f} s")
        print(f"killed: {report.killed}; torn tails: {report.torn}; full disks: {report.full}")
        print(f"commands: {report.commands}; ended with: {report.ended}")
        print(f"records: {chaos.played()}; {'; '.join(told) or 'all as in the undisturbed run, each once'}")
        print(f"processes left: {len(report.orphans)} {report.orphans or ''}")
    sys.exit(bool(told or report.orphans))


if __name__ == "__main__":
    main()
