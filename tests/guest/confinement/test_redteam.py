"""Agents that break rules come to nothing where they are held, and each leaves a fault of a known name."""

from __future__ import annotations

import functools
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import levels
import pytest

from hthor.guest import Guest, GuestConfig
from hthor.guest.process_tools import cleanup
from tests.redteam import nobody
from tests.redteam.agents import HONEST, HOSTILE, NO_FAULT, PIPE, Case
from tests.redteam.nobody import ROOT, runner
from tests.support.guest_agents import BRIEFING, look

EVERY_COMMIT = {
    "L1": ("numpy", "threads", "own_files", "processes_by_the_book"),
    "L2": (
        *("houses", "salt_in_a_file", "import_the_scores", "the_keepers_pipe", "change_modes", "exec"),
        *("old_machine_code", "change_itself", "crash", "patches_the_wire", "killed_by_a_limit"),
        *("numpy", "threads", "own_files"),
    ),
    "L3": (
        *("houses", "parents_memory", "tcp", "kill_the_harness", "daemon", "memory", "disk", "network_socket_pair"),
        *("the_shared_frames", "malformed", "numpy", "processes_by_the_book"),
    ),
}
"""The agents that every commit is tried with at each level, some of each sort; all others are for the night.

L3 is L2 in namespaces, so what reaches for files, processes, the network and limits is tried there.
"""


def at_night(level: str, case: Case) -> bool:
    return case.name not in EVERY_COMMIT[level]


def cases(every: tuple[Case, ...], *at: str) -> list[Any]:
    """The cases at these levels, as parameters."""
    return [
        pytest.param(level, case, marks=pytest.mark.nightly if at_night(level, case) else (), id=f"{level}-{case.name}")
        for level in at
        for case in every
    ]


@functools.cache
def played(level: str, nightly: bool) -> dict[str, Any]:
    """What became of the agents of every commit, or of all others, at a level; at L1 only honest ones are played."""
    levels.need(level)
    python, how = runner()
    every = HONEST if level == "L1" else (*HOSTILE, *HONEST)
    names = [case.name for case in every if at_night(level, case) == nightly]
    words = [*python, "-P", "-m", "tests.redteam.play", level, *names]
    done = subprocess.run(words, capture_output=True, text=True, **how)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)  # type: ignore[no-any-return]


def of(level: str, case: Case) -> dict[str, Any]:
    agents = played(level, at_night(level, case))["agents"]
    return next(one for one in agents if one["name"] == case.name)  # type: ignore[no-any-return]


@pytest.mark.parametrize(("level", "case"), cases(HOSTILE, "L2", "L3"))
def test_a_hostile_agent_comes_to_nothing(level: str, case: Case) -> None:
    one = of(level, case)
    assert one["level"] == level
    assert "BREACH" not in one["fault"]["detail"] + one["log"], one
    assert (one["fault"]["kind"] or NO_FAULT) in case.kinds, one
    assert case.told in one["fault"]["detail"], one
    assert not one["changed"], "its own folder is as it was"
    assert one["again"] == "", "the next trial is played"
    assert played(level, at_night(level, case))["intact"]


@pytest.mark.parametrize(("level", "case"), cases(HONEST, "L1", "L2", "L3"))
def test_an_honest_agent_passes(level: str, case: Case) -> None:
    one = of(level, case)
    assert one["fault"]["kind"] == "", one


SCORED = ("houses", "kill_the_harness", "malformed")
"""A few of them in scored trials; `python -m benchmarks.redteam` plays all, every night."""


@pytest.mark.parametrize("level", levels.CONFINED)
def test_a_hostile_agents_trial_is_scored_with_a_named_fault(level: str) -> None:
    done = nobody.scored(level, *SCORED)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    if found["missing"]:  # that user may have less than we have
        pytest.skip(found["missing"][level])
    idle, *agents = found["agents"]
    assert (idle["name"], idle["kind"], len(agents)) == ("nop", "", len(SCORED))
    cases = {case.name: case for case in HOSTILE}
    for one in agents:
        assert one["kind"] in cases[one["name"]].kinds, one
        assert one["counted"] == {one["kind"]: 1}, one
        assert one["scored"] == idle["scored"], "a trial like any other"
        assert one["person"] == idle["person"], "the person did as if the robot had stood still"
        assert not one["breach"], one
        assert not one["changed"]
    assert found["intact"]


def test_these_were_played_by_an_unprivileged_user() -> None:
    uid = played("L2", False)["uid"]
    if uid == 0:
        pytest.skip("the tests run as root, and no other user can start this interpreter: they were played by root")
    assert uid > 0


HOST = """
import sys
import time
from pathlib import Path
from hthor.guest import GuestConfig, Guest
from tests.support.guest_agents import BRIEFING
guest = Guest(sys.argv[1], config=GuestConfig(isolation=sys.argv[2]))
guest.load()
print(guest._process._folder or guest._process.policy.scratch, flush=True)
guest.begin(BRIEFING)
"""
DAEMON = """
import os, time
class Agent:
    def begin(self, briefing):
        try:
            if os.fork() == 0:
                os.setsid()
        except OSError:
            pass
        while True:
            time.sleep(1)
    def act(self, observation):
        pass
"""


@pytest.mark.parametrize("level", ["L1", "L2", "L3"])
def test_nothing_outlives_a_killed_host(level: str, tmp_path: Path) -> None:
    levels.need(level)
    path = tmp_path / "daemon.py"
    path.write_text(DAEMON)
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    host = subprocess.Popen([sys.executable, "-c", HOST, str(path), level], stdout=subprocess.PIPE, text=True, env=env)
    assert host.stdout is not None
    scratch = host.stdout.readline().strip()
    for _ in range(200):
        if len(below := _descendants(host.pid)) > 2:
            break
        time.sleep(0.05)
    host.kill()
    host.communicate()
    assert below
    for _ in range(200):
        left = [pid for pid in below if _lives(pid)]
        if not left and not Path(scratch).exists():
            break
        time.sleep(0.05)
    assert not left
    assert not Path(scratch).exists()


def _descendants(pid: int) -> list[int]:
    families = cleanup.children_by_parent()
    line, found = [pid], []
    while line:
        found += families.get(line[-1], [])
        line += families.get(line.pop(), [])
    return found


def _lives(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


LEAK = """
from pathlib import Path
import os, sys, tempfile
import numpy as np
from hthor.guest.protocol import wire
from hthor.types import *
FOLDER = Path(tempfile.gettempdir())
SEEN = [str(path) for path in FOLDER.iterdir()] + [name for name in vars(np) if name == "leak"]
class Agent:
    def begin(self, briefing):
        pass
    def act(self, observation):
        print(SEEN, os.getpid(), hasattr(wire, "leak"))
        (FOLDER / "deep" / "deeper").mkdir(parents=True)
        (FOLDER / "deep" / "deeper" / "note").write_text("x")
        np.leak = wire.leak = 1
        return Action()
"""


@pytest.mark.parametrize("level", ["L2", "L3"])
def test_a_trial_leaves_nothing_to_the_next(level: str, tmp_path: Path) -> None:
    levels.need(level)
    path = tmp_path / "leaky.py"
    path.write_text(LEAK)
    with Guest(path, config=GuestConfig(isolation=level)) as mind:
        for _ in range(3):
            mind.begin(BRIEFING)
            mind.act(look())
        lines = [line.split() for line in mind.log.splitlines()]
    assert [(line[0], line[-1]) for line in lines] == [("[]", "False")] * 3, lines
    assert len({line[1] for line in lines}) == 3, "each trial has a process of its own"


HALF_SAID = """
import os, sys, threading
from hthor.types import *
{pipe}
READ, WRITE = pipe().handles
class Agent:
    def begin(self, briefing):
        print(os.get_blocking(READ), os.get_blocking(WRITE), os.get_blocking(1), flush=True)
    def act(self, observation):
        def late():
            for pipe in (READ, WRITE, 1):
                os.set_blocking(pipe, False)
            os.write(WRITE, bytes([255, 0]))
        threading.Timer(0.05, late).start()
        return Action()
"""


@pytest.mark.parametrize("level", levels.EVERY)
def test_the_next_trial_finds_the_wire_as_it_was(level: str, tmp_path: Path) -> None:
    levels.need(level)
    path = tmp_path / "late.py"
    path.write_text(HALF_SAID.replace("{pipe}", PIPE))
    with Guest(path, config=GuestConfig(isolation=level)) as mind:
        for _ in range(2):
            mind.begin(BRIEFING)
            mind.act(look())
            time.sleep(0.2)
        mind.finish()
        assert mind.log.split() == ["True"] * 6


CLEARED = """
import os, sys
from hthor.guest.process_tools import cleanup
top = sys.argv[1]
scratch, foreign = top + "/scratch", top + "/foreign"
os.makedirs(scratch + "/deep/deeper")
os.mkdir(foreign)
open(foreign + "/kept", "w").close()
os.chmod(foreign + "/kept", 0o400)
os.symlink(foreign, scratch + "/link")
os.symlink(foreign, scratch + "/deep/link")
os.chmod(scratch + "/deep", 0)
os.chmod(scratch, 0o500)
cleanup.empty_folder(scratch)
print(os.listdir(scratch), os.listdir(foreign), oct(os.stat(foreign + "/kept").st_mode & 0o777))
os.symlink(foreign, top + "/instead")
cleanup.empty_folder(top + "/instead")
print(os.listdir(foreign))
"""


def test_what_is_cleared_up_ends_at_links() -> None:
    python, how = runner()
    with tempfile.TemporaryDirectory() as folder:
        if "user" in how:
            os.chown(folder, how["user"], how["group"])
        done = subprocess.run([*python, "-P", "-c", CLEARED, folder], capture_output=True, text=True, **how)
    assert done.stdout.splitlines() == ["[] ['kept'] 0o400", "['kept']"], done.stderr
