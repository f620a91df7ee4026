"""A guest's process as the host sees it: its pipes, what it prints, and its end; knows nothing of what is said."""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from hthor.guest import cost, keeper
from hthor.guest.confinement import Policy, limits, namespaces, paths

_PASSED_ON = ("PATH", "LANG", "LC_ALL", "TZ", "LD_LIBRARY_PATH", "NUMBA_CACHE_DIR")
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_LOG_BYTES = 16 << 10
_PIPE_BYTES = 1 << 20
_F_SETPIPE_SZ = 1031
_INSIDE = "/tmp/hthor-guest"
"""The scratch folder where the guest has a file system of its own."""


class TimeIsUp(Exception):
    """A pipe was not ready in time."""


class HungUp(Exception):
    """The other end of a pipe is closed."""


class Process:
    """A running guest. Three pipes: to it, from its trials, from its keeper; and one for what it prints."""

    def __init__(self, policy: Policy, scratch: str) -> None:
        self.policy, self._scratch = policy, scratch
        self._log = b""
        limits.undumpable()
        guest_in, self._out = os.pipe()
        self._words, guest_out = os.pipe()
        self._keeper, tell = os.pipe()
        self._err, printed = os.pipe()
        for handle in (self._out, self._words, self._keeper, self._err):
            os.set_blocking(handle, False)
        with contextlib.suppress(OSError):  # only speed depends on it
            fcntl.fcntl(self._out, _F_SETPIPE_SZ, _PIPE_BYTES)
        env = _environment(os.environ, policy.scratch)
        spaces = policy.level == "L3"
        words = [sys.executable, "-P", "-u", "-m", "hthor.guest", str(guest_in), str(tell), str(guest_out)]
        words.append("0" if spaces else str(os.getpid()))
        if spaces:
            words = namespaces.command(policy, words, [env[name] for name in ("NUMBA_CACHE_DIR",) if name in env])
        try:
            self._process = subprocess.Popen(
                words,
                stdin=subprocess.DEVNULL,
                stdout=printed,
                stderr=printed,
                pass_fds=(guest_in, tell, guest_out),
                cwd="/",
                env=env,
                start_new_session=True,
            )
        finally:
            for handle in (guest_in, tell, guest_out, printed):
                os.close(handle)
        self._buffers = {self._words: b"", self._keeper: b""}

    @property
    def pid(self) -> int:
        return self._process.pid

    def write(self, data: bytes, end: float) -> None:
        """Send bytes before a moment of the monotonic clock.

        Raises:
            TimeIsUp, HungUp: when it cannot.
        """
        left = memoryview(data)
        while left:
            try:
                left = left[os.write(self._out, left) :]
            except BlockingIOError:
                self._wait({self._out: select.POLLOUT}, end)
            except OSError:
                raise HungUp from None

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """The next whole message of a trial, or else of the keeper: whether it is the keeper's, and its bytes.

        For a message of more than ``most`` bytes its size is given instead.

        Raises:
            TimeIsUp, HungUp: when there is none.
        """
        while True:
            for handle in (self._words, self._keeper):
                if (found := self._next(handle, most)) is not None:
                    return handle == self._keeper, found
            ready = self._wait({self._words: select.POLLIN, self._keeper: select.POLLIN}, end)
            for handle in ready:
                chunk = os.read(handle, 1 << 16)
                if not chunk:
                    raise HungUp
                self._buffers[handle] += chunk

    def _next(self, handle: int, most: int) -> bytes | int | None:
        buffer = self._buffers[handle]
        if len(buffer) < 4:
            return None
        size = int.from_bytes(buffer[:4], "little")
        if size > most:
            return size
        if len(buffer) < 4 + size:
            return None
        self._buffers[handle] = buffer[4 + size :]
        return buffer[4 : 4 + size]

    def _wait(self, wanted: Mapping[int, int], end: float) -> list[int]:
        """Which pipes are ready, in the order asked for, reading along what is printed."""
        while True:
            poll = select.poll()
            for handle, event in wanted.items():
                poll.register(handle, event)
            poll.register(self._err, select.POLLIN)
            ready = {handle for handle, _ in poll.poll(max(0.0, end - time.monotonic()) * 1000.0)}
            if found := [handle for handle in wanted if handle in ready]:
                return found
            if not ready:
                raise TimeIsUp
            if not self._drain():
                time.sleep(0.001)  # the log was closed; do not spin on it

    @property
    def log(self) -> str:
        """The end of what was printed, 16 KiB at most."""
        self._drain()
        return self._log.decode(errors="replace")

    def _drain(self) -> bool:
        """Take in what was printed, as much of it as has come by now; false when nothing more can come."""
        try:
            for _ in range(64):
                if not (chunk := os.read(self._err, 1 << 16)):
                    return False
                self._log = (self._log + chunk)[-_LOG_BYTES:]
        except BlockingIOError:
            return True
        return True

    def obituary(self) -> str:
        """How the process ended."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(0.5)
        code = self._process.returncode
        if code is None:
            return "the agent closed its pipe"
        return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exited with status {code}"

    def kill(self) -> None:
        """End everything that the guest has started, close the pipes, and remove what it wrote."""
        with cost.ending(self._process.pid):
            if self.policy.level == "L1":
                keeper.end_descendants(self._process.pid)
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        for handle in (self._out, self._words, self._keeper, self._err):
            os.close(handle)
        if self._scratch:
            keeper.empty(self._scratch)
            shutil.rmtree(self._scratch, ignore_errors=True)


def start(agent: Path, level: str, *, hidden: tuple[str, ...], memory_mb: int, disk_mb: int) -> Process:
    """A fresh guest on this level; what it says first tells whether the level is in force."""
    scratch = "" if level == "L3" else tempfile.mkdtemp(prefix="hthor-guest-")
    compiled = os.environ.get("NUMBA_CACHE_DIR", "")
    if compiled:
        os.makedirs(compiled, exist_ok=True)
    policy = Policy(
        level=level,
        read=(*paths.readable(agent, hidden), *([compiled] if compiled else [])),
        listed=paths.listed(agent),
        scratch=scratch or _INSIDE,
        memory_mb=memory_mb,
        disk_mb=disk_mb,
    )
    return Process(policy, scratch)


def _environment(ours: Mapping[str, str], scratch: str) -> dict[str, str]:
    """Nothing of ours but what an interpreter needs; one thread, and the same hash seed every time."""
    env = {name: ours[name] for name in _PASSED_ON if name in ours}
    env.update(dict.fromkeys(_THREADS, "1"))
    env.update(dict.fromkeys(("HOME", "TMPDIR"), scratch))
    env.update(PYTHONHASHSEED="0", PYTHONDONTWRITEBYTECODE="1", USER="agent", LOGNAME="agent")
    env["PYTHONPATH"] = os.pathsep.join([str(paths.PACKAGE.parent), *paths.libraries()])
    return env
