"""Runs all checks of the machine in one order, some in a process of their own: a crash or a hang is a result too."""

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import msgspec

from hthor import code_identity
from hthor.eval.doctor import hardware, isolation_levels, libraries, rendering, reproducibility
from hthor.eval.doctor.check_result import CheckResult, DoctorReport
from hthor.eval.runner import worker
from hthor.guest.confinement import check_level

_LIMIT_S = 600.0
"""How long [s] a check may take: the first command after an update compiles, for minutes on a busy machine."""
_Answer = TypeVar("_Answer")


def run_checks(runs: Path, required: str = "L1", more: Sequence[CheckResult] = ()) -> DoctorReport:
    """Check everything.

    Args:
        runs: the folder for runs; it need not exist.
        required: the lowest acceptable level of isolation.
        more: checks of parts of hthor that this one does not know.

    Raises:
        UnknownName: when ``required`` is not an isolation level.
    """
    check_level(required, auto=False)
    with (
        start_probe(rendering.__name__) as picture,
        start_probe(reproducibility.__name__) as course,
    ):
        findings = [
            *libraries.check_libraries(),
            *isolation_levels.check_isolation(required),
            *hardware.check_hardware(runs),
            *reproducibility.check_reproducibility(course.answer(reproducibility.TrialFingerprint)),
            *rendering.check_rendering(picture.answer(rendering.RenderingProbe)),
            *more,
        ]
    return DoctorReport(well=all(one.status != "fail" for one in findings), findings=tuple(findings))


class Probe:
    """A process that runs a check."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self._process = process

    def answer(self, kind: type[_Answer]) -> _Answer | str:
        """The result in the last line of the process's output, or the reason why there is none."""
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
    """Run a module as a script, in the environment that workers have; the process ends with the block."""
    environment = {**os.environ, **worker.ONE_THREAD, "PYTHONHASHSEED": "0"}
    environment.setdefault("NUMBA_CACHE_DIR", str(code_identity.compiled()))
    paths = [str(code_identity.PACKAGE.parent), os.environ.get("PYTHONPATH", "")]  # found from every folder
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
