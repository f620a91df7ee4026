"""Tries something in a process of its own, so that a crash or a hang is a result."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

import msgspec

from hthor import code_identity
from hthor.eval.runner import worker

_LIMIT_S = 120.0
"""The first command after an update compiles for some seconds."""
_Answer = TypeVar("_Answer")


class Probe:
    """A process that was started."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self._process = process

    def answer(self, kind: type[_Answer]) -> _Answer | str:
        """What it found, as the last line of its output says; the reason where it did not come to an end."""
        try:
            out, errors = self._process.communicate(timeout=_LIMIT_S)
        except subprocess.TimeoutExpired:
            return f"it did not end within {_LIMIT_S:.0f} s"
        code = self._process.returncode
        try:
            return msgspec.json.decode(out.strip().splitlines()[-1], type=kind)
        except (IndexError, msgspec.DecodeError):
            words = errors.decode("utf-8", "replace").strip().splitlines()
            ended = f"signal {-code}" if code < 0 else f"exit status {code}"
            return f"it ended with {ended}{': ' + words[-1] if words else ''}"


@contextmanager
def start_probe(module: str) -> Iterator[Probe]:
    """Run a module as a script, in the environment that workers have; it ends with the block."""
    environment = {**os.environ, **worker.ONE_THREAD, "PYTHONHASHSEED": "0"}
    environment.setdefault("NUMBA_CACHE_DIR", str(code_identity.compiled()))
    paths = [str(code_identity.PACKAGE.parent), os.environ.get("PYTHONPATH", "")]  # also in another working folder
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    command = [sys.executable, "-m", module]
    process = subprocess.Popen(
        command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        yield Probe(process)
    finally:
        process.kill()
        process.communicate()
