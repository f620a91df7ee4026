"""Runs a command in this process and judges how it ended."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import signal
import sys
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from hthor import cli
from hthor.console import exit_status

LIMIT_S = 120
_NO_NUMBER = re.compile(r"(?<![\w.])-?(nan|inf|infinity)(?![\w.])", re.IGNORECASE)
_TRACEBACK = "Traceback (most recent call last)"
_CHECKS = ("check", "validate", "verify", "merge", "build", "calibrate", "census", "doctor", "make", "generate", "eval")
"""Words of commands that may end with code 1: they check something, or lack trials."""


class TooLong(BaseException):
    """A command that does not come to an end."""


@dataclass(frozen=True)
class Said:
    """How a command ended: its exit code, and what it wrote. ``broken`` is a traceback that reached its caller."""

    words: tuple[str, ...]
    code: int
    out: str
    err: str
    broken: str = ""

    def problems(self) -> list[str]:
        """What is wrong with how it ended, in words."""
        found = []
        if self.broken or _TRACEBACK in self.err:
            found.append(f"traceback: {(self.broken or self.err).strip().splitlines()[-1]}")
        if self.code not in exit_status.CODES:
            found.append(f"exit code {self.code} is not documented")
        if (
            self.code == exit_status.INTERNAL
            and not self.broken
            and not any(word in self.words[:2] for word in _CHECKS)
        ):
            found.append("exit code 1 of a command that checks nothing")
        if self.code == 0 and (number := _NO_NUMBER.search(self.out)):
            found.append(f"no number on standard output: {number.group()}")
        if "--json" in self.words and "--help" not in self.words and self.code != 0 and not self.broken:
            try:
                json.loads(self.out, parse_constant=_refuse)
            except ValueError as error:
                found.append(f"--json: {error}: {self.out[:80]!r}")
        if self.code == exit_status.USAGE and not self.err.strip():
            found.append("refused without a word")
        return found


def _refuse(word: str) -> float:
    raise ValueError(f"{word} is no number")


def ask(folder: Path, words: Sequence[str], limit_s: int = LIMIT_S) -> Said:
    """Run `hthor` with these words in a folder."""
    out, err, broken, code = io.StringIO(), io.StringIO(), "", 0
    with _alone(folder, words), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), _limited(limit_s):
        try:
            cli.main()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else exit_status.INTERNAL if end.code else 0
        except TooLong:
            code, broken = -1, f"no end within {limit_s} s"
        except BaseException:
            code, broken = exit_status.INTERNAL, traceback.format_exc()
    return Said(tuple(words), code, out.getvalue(), err.getvalue(), broken)


@contextlib.contextmanager
def _alone(folder: Path, words: Sequence[str]) -> Iterator[None]:
    """What one command leaves behind in a process is taken away before the next."""
    before = (os.getcwd(), list(sys.argv), dict(os.environ), set(sys.modules))
    os.chdir(folder)
    sys.argv = ["hthor", *words]
    os.environ["XDG_CACHE_HOME"] = str(folder / ".cache")
    try:
        yield
    finally:
        os.chdir(before[0])
        sys.argv = before[1]
        os.environ.clear()
        os.environ.update(before[2])
        for name in set(sys.modules) - before[3]:
            if str(getattr(sys.modules[name], "__file__", None) or "").startswith(str(folder)):
                del sys.modules[name]


@contextlib.contextmanager
def _limited(seconds: int) -> Iterator[None]:
    def stop(_number: int, _frame: FrameType | None) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
