"""The command line in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import msgspec

FAKES = Path(__file__).with_name("command_fakes.py")


class Said(msgspec.Struct):
    """What a command left: exit code, standard output, standard error."""

    code: int
    out: str
    err: str


def start(*words: str, play: str = "player") -> subprocess.Popen[str]:
    command = [sys.executable, str(FAKES), play, *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def run(*words: str, play: str = "player") -> tuple[int, object, str]:
    """Exit code, the one document on standard output, and what is said to people."""
    process = start(*words, "--json", play=play)
    out, err = process.communicate(timeout=900)
    return process.returncode, json.loads(out), err
