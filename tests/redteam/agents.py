"""Reads agents to be attacked by, and agents that must pass: hostile.txt and honest.txt.

A line "== NAME: FAULTS | WORDS" heads what an agent does in its first ``act``, with the kinds of fault it may end with
and words of the fault. An agent whose misdeed works says BREACH and what it got. "no fault" stands for an attempt that
comes to nothing, after which the agent plays on.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

NO_FAULT = "no fault"
PIPE = """
def pipe():
    frame = sys._getframe()
    while frame:
        for value in frame.f_locals.values():
            if type(value).__name__ == "HostPipe":
                return value
        frame = frame.f_back
"""
"""How an agent finds its end of the wire."""
_IMPORTS = """
import ctypes, fcntl, glob, mmap, os, resource, signal, socket, struct, subprocess, sys, tempfile, threading, time
from pathlib import Path
from hthor.types import *
"""
HEAD = (
    f"{_IMPORTS}{PIPE}"
    + """
PIPE = pipe()
(READ, WIRE), FRAMES, TELL = PIPE.handles, PIPE.shared, int(sys.orig_argv[-2])
HERE = Path(__file__).parent
PACKAGE = Path(sys.modules["hthor"].__file__).parent
libc = ctypes.CDLL(None, use_errno=True)

def breach(what):
    raise SystemExit(f"BREACH: {what!r}")

def call(number, *values):
    result = libc.syscall(ctypes.c_long(number), *(ctypes.c_long(value) for value in values))
    if result < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result

def spin():
    while True:
        pass

def is_open(fd):
    try:
        os.fstat(fd)
    except OSError:
        return False
    return True

class Agent:
    def begin(self, briefing):
        pass

    def act(self, observation):
        if observation.tick == 0:
            self.attack()
        return Action()

    def attack(self):
"""
)


class Case(NamedTuple):
    """One agent: what it does, the kinds of fault it may end with, and words of the fault."""

    name: str
    attack: str
    kinds: tuple[str, ...]
    told: str


def _read(name: str) -> tuple[Case, ...]:
    found = []
    for block in re.split(r"^== ", Path(__file__).with_name(name).read_text(), flags=re.MULTILINE)[1:]:
        head, _, body = block.partition("\n")
        title, _, told = head.partition(" | ")
        who, _, kinds = title.partition(": ")
        body = "\n".join(line for line in body.splitlines() if not line.startswith("#"))
        found.append(Case(who, body.strip("\n"), tuple(kinds.split(", ")), told))
    return tuple(found)


HOSTILE, HONEST = _read("hostile.txt"), _read("honest.txt")


def source(attack: str, *, secret: str, harness: int, port: int) -> str:
    """The file of an agent."""
    body = "\n".join(f"        {line}" for line in attack.replace("SECRET", secret).splitlines())
    return f"HARNESS, PORT = {harness}, {port}\n{HEAD}{body}\n"
