"""What an agent leaves behind in one trial it does not find in the next, wherever it hides it."""

from __future__ import annotations

import ast
import itertools
from pathlib import Path
from typing import NamedTuple

import levels
import pytest

from hthor.guest import Guest, GuestConfig
from tests.redteam.agents import PIPE
from tests.support.guest_agents import BRIEFING, look

HEAD = """
import ctypes, fcntl, os, struct, sys, tempfile, threading, time
from hthor.types import *
{pipe}
PIPE = pipe()
SCRATCH = tempfile.gettempdir()

def first_words():
    read, write = os.pipe()
    count = ctypes.CDLL(None).syscall(276, PIPE.handles[0], write, 6, 2)
    seen = os.read(read, 6) if count > 0 else b""
    return os.read(PIPE.handles[0], 6) if seen == b"forged" else seen

SEEN = first_words()

def leave():
{leave}

def find():
{find}

class Agent:
    def begin(self, briefing):
        pass

    def act(self, observation):
        print([find(), leave()], flush=True)
        return Action()

    def __del__(self):
        at_the_end()

def at_the_end():
{end}
"""


class Case(NamedTuple):
    """What an agent does to leave a word, how it looks for one, and what it does when its trial is over."""

    leave: str
    find: str
    end: str = "pass"


CASES = {
    "a forged beginning": Case(
        leave="return b'forged'",
        find="return SEEN",
        end="""
os.write(os.open(f"/proc/self/fd/{PIPE.handles[0]}", os.O_WRONLY), b"forged")
""",
    ),
    "flags of the standard input": Case(
        leave="fcntl.fcntl(0, fcntl.F_SETFL, os.O_NONBLOCK | os.O_APPEND); return fcntl.fcntl(0, fcntl.F_GETFL)",
        find="return fcntl.fcntl(0, fcntl.F_GETFL)",
    ),
    "what it printed last": Case(
        leave="return b'a note'",
        find="""
at = os.open("/proc/self/fd/2", os.O_RDONLY | os.O_NONBLOCK)
try:
    return os.read(at, 6)
except BlockingIOError:
    return b""
""",
        end="os.write(2, b'a note')",
    ),
    "when the frames were read": Case(
        leave="os.pread(PIPE.shared, 1, 0); return os.fstat(PIPE.shared).st_atime_ns",
        find="return os.fstat(PIPE.shared).st_atime_ns",
    ),
    "which pipe it had": Case(
        leave="return [os.fstat(one).st_ino for one in (0, 1, *PIPE.handles, PIPE.shared)][1:]",
        find="return [os.fstat(one).st_ino for one in (0, 1, *PIPE.handles, PIPE.shared)][1:]",
    ),
    "when its folder was changed": Case(
        leave="os.mkdir(f'{SCRATCH}/x'); os.rmdir(f'{SCRATCH}/x'); return os.stat(SCRATCH).st_mtime_ns",
        find="return os.stat(SCRATCH).st_mtime_ns",
    ),
    "how large its folder is": Case(
        leave="""
if os.stat(SCRATCH).st_size == 4096:
    for n in range(200): os.mkdir(f"{SCRATCH}/{n:0200}")
return os.stat(SCRATCH).st_size
""",
        find="return os.stat(SCRATCH).st_size",
    ),
}


def source(case: Case) -> str:
    """The file of an agent that leaves word for itself."""
    code = {
        name: "\n".join(f"    {line}" for line in (text.strip() or "pass").splitlines())
        for name, text in case._asdict().items()
    }
    return HEAD.format(pipe=PIPE, **code)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("level", levels.CONFINED)
def test_an_agent_finds_nothing_of_the_trial_before(level: str, name: str, tmp_path: Path) -> None:
    levels.need(level)
    path = tmp_path / "agent.py"
    path.write_text(source(CASES[name]))
    told = []
    with Guest(path, config=GuestConfig(isolation=level)) as mind:
        for _ in range(4):
            mind.begin(BRIEFING)
            mind.act(look())
            told.append(ast.literal_eval(mind.log.strip().splitlines()[-1].lstrip("a note")))
    for (_, left), (found, _) in itertools.pairwise(told):
        assert found != left or found == told[0][0], told
