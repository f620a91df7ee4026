"""A guest's process as the host sees it: its pipes, what it prints, and its end; knows nothing of what is said."""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping

from hthor.guest import affinity, clearing, cost, ending, frames, wire
from hthor.guest.confinement import Policy, devices, limits, namespaces, paths
from hthor.guest.lines import HungUp, TimeIsUp
from hthor.guest.reference import Reference
from hthor.guest.showing import shown

_PASSED_ON = ("PATH", "LANG", "LC_ALL", "TZ", "LD_LIBRARY_PATH", "NUMBA_CACHE_DIR")
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_MEMORY = f"glibc.malloc.mmap_threshold={64 << 20}:glibc.malloc.trim_threshold={256 << 20}"
"""Keep what arrays have freed, as a process that has lived for long does anyway: each trial's is new, and pages that
are given back and taken again cost it more than its agent."""
_LOG_BYTES = 16 << 10
_PIPE_BYTES = 1 << 20
_F_SETPIPE_SZ = 1031
_LAST_S = 10.0
"""Longest wait for a process whose pipes are closed. On a busy machine it takes a while to clear up behind it."""
_INSIDE = "/tmp/hthor-guest"
"""The scratch folder where the guest has a file system of its own."""


class Process:
    """A running guest. Pipes: to it, from its trials, with its keeper, one for what it prints; shared frames."""

    def __init__(self, policy: Policy, scratch: str) -> None:
        self.policy, self._scratch = policy, scratch
        self._log = b""
        limits.undumpable()
        guest_in, self._out = os.pipe()
        self._words, guest_out = os.pipe()
        self._keeper, tell = (end.detach() for end in socket.socketpair())
        self._err, printed = os.pipe()
        self.frames = frames.window()
        for handle in (self._out, self._words, self._keeper, self._err):
            os.set_blocking(handle, False)
        with contextlib.suppress(OSError):  # only speed depends on it
            fcntl.fcntl(self._out, _F_SETPIPE_SZ, _PIPE_BYTES)
        env = _environment(os.environ, policy)
        passed: tuple[int, ...] = (guest_in, tell, guest_out)
        if self.frames is not None:
            env[frames.VARIABLE] = str(self.frames.handle)
            passed += (self.frames.handle,)
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
                pass_fds=passed,
                cwd="/",
                env=env,
                start_new_session=True,
            )
        except OSError:
            self._close()
            raise
        finally:
            for handle in (guest_in, tell, guest_out, printed):
                os.close(handle)
        self._buffers = {self._words: b"", self._keeper: b""}
        self._hear, self._say = select.poll(), select.poll()
        for handle in (self._words, self._keeper, self._err):
            self._hear.register(handle, select.POLLIN)
        self._say.register(self._out, select.POLLOUT)
        self._say.register(self._err, select.POLLIN)

    @property
    def pid(self) -> int:
        return self._process.pid

    def gather(self) -> bool:
        """Play the trial that begins on one CPU with this thread, if that can be; then `affinity.leave` ends it."""
        if self.policy.level == "L1" or (cpu := affinity.stay()) < 0:  # at L1 an agent may start processes of its own
            return False
        affinity.tell(self._keeper, cpu)
        return True

    def write(self, body: bytes, end: float) -> None:
        """As `Line` says."""
        left = memoryview(wire.framed(body))
        while left:
            try:
                left = left[os.write(self._out, left) :]
            except BlockingIOError:
                self._wait(self._say, (self._out,), end)
            except OSError:
                raise HungUp from None

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """As `Line` says; a message of a trial comes before one of the keeper."""
        while True:
            for handle in (self._words, self._keeper):
                if (found := self._next(handle, most)) is not None:
                    return handle == self._keeper, found
            for handle in self._wait(self._hear, (self._words, self._keeper), end):
                try:
                    chunk = os.read(handle, 1 << 16)
                except ConnectionResetError:  # a keeper that ended before it had read all
                    chunk = b""
                if not chunk:
                    raise HungUp
                self._buffers[handle] += chunk

    def forget(self) -> None:
        """Drop what a trial that has ended left half said."""
        with contextlib.suppress(BlockingIOError):
            while os.read(self._words, 1 << 16):
                pass  # however much it is
        self._buffers[self._words] = b""

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

    def _wait(self, poll: select.poll, wanted: tuple[int, ...], end: float) -> list[int]:
        """Which pipes are ready, in the order asked for, reading along what is printed."""
        while True:
            ready = [handle for handle, _ in poll.poll(max(0.0, end - time.monotonic()) * 1000.0)]
            if found := [handle for handle in wanted if handle in ready]:
                return found
            if not ready or time.monotonic() > end:  # a flood of words does not lengthen it
                raise TimeIsUp
            if not self._drain():
                time.sleep(0.001)  # the log was closed; do not spin on it

    @property
    def lives(self) -> bool:
        """Whether it still runs."""
        return self._process.poll() is None

    @property
    def log(self) -> str:
        """The end of what was printed, 16 KiB at most."""
        self._drain()
        return shown(self._log.decode(errors="replace"))

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

    def obituary(self) -> tuple[str, str]:
        """How the process ended: a fault's kind and its words."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_LAST_S)
        code = self._process.returncode
        if code is None:
            return "died", "the agent closed its pipe"
        return ending.told(ending.unwrapped(code) if self.policy.level == "L3" else code)

    def kill(self) -> None:
        """End everything that the guest has started, close the pipes, and remove what it wrote."""
        with cost.ending(self._process.pid):
            if self.policy.level == "L1":
                clearing.end_descendants(self._process.pid)
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        self._close()

    def _close(self) -> None:
        for handle in (self._out, self._words, self._keeper, self._err):
            os.close(handle)
        if self.frames is not None:
            self.frames.close()
        if self._scratch:
            clearing.empty(self._scratch)
            shutil.rmtree(self._scratch, ignore_errors=True)


def start(
    agent: Reference,
    level: str,
    *,
    hidden: tuple[str, ...],
    memory_mb: int,
    disk_mb: int,
    gpus: bool = False,
    readable: tuple[str, ...] = (),
) -> Process:
    """A fresh guest on this level; what it says first tells whether the level is in force."""
    scratch = "" if level == "L3" else tempfile.mkdtemp(prefix="hthor-guest-")
    compiled = os.environ.get("NUMBA_CACHE_DIR", "")
    if compiled:
        os.makedirs(compiled, exist_ok=True)
    more = ([compiled] if compiled else []) + (list(devices.FACTS) if gpus else [])
    policy = Policy(
        level=level,
        read=(*paths.readable(agent.path, agent.root, hidden, readable), *more),
        listed=(*paths.listed(agent.root), *(place for place in readable if os.path.isdir(place))),
        scratch=scratch or _INSIDE,
        memory_mb=memory_mb,
        disk_mb=disk_mb,
        execute=bool(agent.words),
        devices=devices.gpus() if gpus else (),
    )
    return Process(policy, scratch)


def _environment(ours: Mapping[str, str], policy: Policy) -> dict[str, str]:
    """Nothing of ours but what an interpreter needs; one thread, and the same hash seed every time."""
    passed_on = (*_PASSED_ON, *(devices.VARIABLES if policy.devices else ()))
    env = {name: ours[name] for name in passed_on if name in ours}
    env.update(dict.fromkeys(_THREADS, "1"))
    env.update(dict.fromkeys(("HOME", "TMPDIR"), policy.scratch))
    env["GLIBC_TUNABLES"] = _MEMORY
    env.update(PYTHONHASHSEED="0", PYTHONDONTWRITEBYTECODE="1", USER="agent", LOGNAME="agent")
    env["PYTHONPATH"] = os.pathsep.join([str(paths.PACKAGE.parent), *paths.libraries()])
    return env
