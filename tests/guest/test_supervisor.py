"""The trusted part of a guest is held too, and imports libraries alone."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import levels
import pytest

from hthor.guest.supervisor import preloading
from tests.redteam.nobody import ROOT, runner
from tests.support.guest_agents import HEAD, PROCESS_CHAINS, agent, process_chain, start_trial

TRIED = """
import json, os, resource, socket, subprocess, sys
from hthor.guest.confinement import Policy, enforcement, limits, paths
scratch = sys.argv[1] + "/home"
os.mkdir(scratch)
limits.drop_privileges()
read = paths.readable_paths("", "", [])
enforcement.confine_supervisor(Policy(level="L2", read=read, listed=(), scratch=scratch, memory_mb=1, disk_mb=1))
done = {}
for name, what in {
    "read the machine": lambda: open("/etc/passwd").read(1),
    "write beside": lambda: open(sys.argv[1] + "/../beside", "w"),
    "make a folder in the root": lambda: os.mkdir("/hthor-was-here"),
    "connect": lambda: socket.create_connection(("127.0.0.1", 9), 1),
    "look up a name": lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM),
    "start a program": lambda: subprocess.run(["true"]),
    "import the world": lambda: open(str(paths.PACKAGE / "world" / "__init__.py")),
    "clear up": lambda: os.rmdir(scratch),
    "start a process": lambda: os.fork() or os._exit(0),
    "look after it": lambda: open("/proc/1/stat").read(),
}.items():
    try:
        what()
    except OSError as error:
        done[name] = type(error).__name__
    else:
        done[name] = ""
print(json.dumps(done))
"""


def test_what_imports_libraries_for_an_agent_can_do_little_else() -> None:
    levels.need("L2")
    python, how = runner()
    with tempfile.TemporaryDirectory() as folder:
        if "user" in how:
            os.chown(folder, how["user"], how["group"])
        words = [*python, "-P", "-c", TRIED, folder]
        done = subprocess.run(words, capture_output=True, text=True, **{**how, "cwd": "/"})
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    allowed = ("clear up", "start a process", "look after it")
    assert [name for name, error in found.items() if not error] == list(allowed), found


@pytest.mark.parametrize("level", ["L2", pytest.param("L3", marks=PROCESS_CHAINS[2].marks)])  # type: ignore[union-attr]
def test_the_supervisor_of_a_guest_is_confined(level: str, tmp_path: Path) -> None:
    levels.need(level)
    with start_trial(tmp_path / "agent.py", level) as mind:
        supervisor = process_chain(mind.pid)[-2]
        status = Path(f"/proc/{supervisor}/status").read_text()
    assert "Seccomp:\t2" in status
    assert "NoNewPrivs:\t1" in status


PRELOADED = """
import sys
from pathlib import Path
from hthor.guest.supervisor.preloading import preload
sys.argv = ["7", "8"]
preload(Path(PATH))
print([name for name in NAMES if name in sys.modules], sys.argv)
"""


def test_what_does_something_when_it_is_imported_is_not_preloaded(tmp_path: Path) -> None:
    quiet = ("venv", "json.tool", "colorsys")
    loud = ("venv.__main__", "this", "antigravity", "idlelib.idle", "turtledemo", "test.support", "unittest.__main__")
    path = tmp_path / "agent.py"
    path.write_text("\n".join(f"import {name}" for name in (*loud, *quiet)) + "\n" + HEAD + agent("return Action()"))
    text = PRELOADED.replace("PATH", repr(str(path))).replace("NAMES", repr((*loud, *quiet)))
    done = subprocess.run(
        [sys.executable, "-c", text],
        capture_output=True,
        text=True,
        check=True,
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT)},
    )
    assert done.stdout.strip() == f"{list(quiet)} ['']"


@pytest.mark.parametrize("name", ["numpy", "torch.nn", "attest", "hthor.types"])
def test_libraries_are_quiet(name: str) -> None:
    assert preloading._quiet(name)
