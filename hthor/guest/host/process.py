"""A guest's process as the host sees it: its pipes, its output, and its end."""

import contextlib
import os
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping

from hthor.guest.agent.reference import AgentReference
from hthor.guest.confinement import Policy, limits, namespaces, paths
from hthor.guest.host.channel import DeadlinePassed, PeerGone
from hthor.guest.process_tools import cleanup, cpu_affinity, lasting_thread, resource_usage
from hthor.guest.protocol import trial_orders, wire
from hthor.guest.protocol.shared_frames import FrameWriter
from hthor.guest.protocol.trial_channel import HostEnds
from hthor.guest.protocol.wire import sanitize_text

_PASSED_ON = ("PATH", "LANG", "LC_ALL", "TZ", "LD_LIBRARY_PATH", "NUMBA_CACHE_DIR")
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_MEMORY = f"glibc.malloc.mmap_threshold={64 << 20}:glibc.malloc.trim_threshold={256 << 20}"
"""Makes a process keep memory that arrays have freed: every trial has a new process, for which returning and requesting
pages would take longer than its agent."""
_LOG_BYTES = 16 << 10
_LAST_S = 10.0
"""Longest wait for a process whose pipes are closed; on a busy machine its cleanup takes a while."""
_INSIDE = "/tmp/hthor-guest"
"""The scratch folder of a guest with a file system of its own (L3)."""
_HOME = "home"
"""The scratch folder at L1 and L2, inside a folder made for the guest, as the supervisor may have to replace it."""


class GuestProcess:
    """A running guest: a socket to its supervisor, a pipe for its output, and the pipes of the current trial.

    Its ``folder``, empty for none, was made for it and is removed at its end.
    """

    def __init__(self, policy: Policy, folder: str) -> None:
        self.policy, self._folder = policy, folder
        self._log = b""
        self._orders = threading.Lock()  # held while the supervisor's socket is written to or closed
        limits.make_undumpable()
        self._socket, tell = socket.socketpair()
        self._supervisor = self._socket.fileno()
        self._err, printed = os.pipe()
        for handle in (self._supervisor, self._err):
            os.set_blocking(handle, False)
        self._ends = HostEnds()
        spaces = policy.level == "L3"
        parent = 0 if spaces else os.getpid()
        words = [sys.executable, "-P", "-u", "-m", "hthor.guest", str(tell.fileno()), str(parent)]
        if spaces:
            words = namespaces.bwrap_command(policy, words)
        try:
            self._process = lasting_thread.run_in_lasting_thread(
                lambda: subprocess.Popen(
                    words,
                    stdin=subprocess.DEVNULL,
                    stdout=printed,
                    stderr=printed,
                    pass_fds=(tell.fileno(),),
                    cwd="/",
                    env=_environment(os.environ, policy),
                    start_new_session=True,
                )
            )
        except OSError:
            self._close()
            raise
        finally:
            tell.close()
            os.close(printed)
        self._cpu = resource_usage.CpuMeter(self._process.pid)
        self._buffers: dict[int, bytes] = {self._supervisor: b""}
        self._open()

    def _open(self) -> None:
        """Send the guest's ends of the new trial's pipes to the supervisor, and listen to the host's ends."""
        ends = self._ends
        ends.send_far_ends(self._socket)
        self._buffers = {ends.words: b"", self._supervisor: self._buffers[self._supervisor]}
        self._hear, self._say = select.poll(), select.poll()
        for handle in (ends.words, self._supervisor, ends.err, self._err):
            self._hear.register(handle, select.POLLIN)
        self._say.register(ends.out, select.POLLOUT)
        for handle in (ends.err, self._err):
            self._say.register(handle, select.POLLIN)

    @property
    def frames(self) -> FrameWriter | None:
        """Memory for pictures, shared with the trial's process."""
        return self._ends.frames

    @property
    def pid(self) -> int:
        return self._process.pid

    def pin(self) -> bool:
        """Run the trial that begins on the main thread's CPU; False if that is impossible, and in other threads.

        `cpu_affinity.unpin_thread` and `unpin` undo it.
        """
        if self.policy.level == "L1":  # there an agent may start processes of its own
            return False
        if (cpu := cpu_affinity.pin_thread()) < 0:
            return False
        self._order(cpu)
        return True

    def unpin(self) -> None:
        """Let the trial's process run on every CPU again."""
        self._order(trial_orders.ANYWHERE)

    def stop_trial(self) -> None:
        """End the process of the current trial, from any thread; the supervisor answers that the trial is over."""
        self._order(trial_orders.STOP)

    def _order(self, order: int) -> None:
        with self._orders:
            if self._socket.fileno() >= 0:  # else it is closed, and its number may be another file's
                trial_orders.send_order(self._supervisor, order)

    def write(self, body: bytes, end: float) -> None:
        """As `Transport` says."""
        left = memoryview(wire.add_length(body))
        while left:
            try:
                left = left[os.write(self._ends.out, left) :]
            except BlockingIOError:
                self._wait(self._say, (self._ends.out,), end)
            except OSError:
                raise PeerGone from None

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """As `Transport` says; a message of the trial comes before one of the supervisor."""
        both = (self._ends.words, self._supervisor)
        while True:
            for handle in both:
                if (found := self._next(handle, most)) is not None:
                    return handle == self._supervisor, found
            for handle in self._wait(self._hear, both, end):
                try:
                    chunk = os.read(handle, 1 << 16)
                except ConnectionResetError:  # a supervisor that ended before it had read all
                    chunk = b""
                if not chunk:
                    raise PeerGone
                self._buffers[handle] += chunk

    def next_trial(self) -> None:
        """Make new pipes for the next trial; half-sent messages are lost with the old pipes."""
        self._drain()
        self._ends.close()
        self._ends = HostEnds()
        self._open()

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
        """The ``wanted`` pipes that are ready, in that order; while waiting, reads the guest's output."""
        while True:
            ready = [handle for handle, _ in poll.poll(max(0.0, end - time.monotonic()) * 1000.0)]
            if found := [handle for handle in wanted if handle in ready]:
                return found
            if not ready or time.monotonic() > end:  # much output does not extend the wait
                raise DeadlinePassed
            if not self._drain():
                time.sleep(0.001)  # a closed log pipe is always ready: do not spin

    @property
    def lives(self) -> bool:
        """Whether the process still runs."""
        return self._process.poll() is None

    @property
    def log(self) -> str:
        """The last 16 KiB, at most, of the output."""
        self._drain()
        return sanitize_text(self._log.decode(errors="replace"))

    def _drain(self) -> bool:
        """Read the output so far; False when one of the pipes is closed."""
        from_supervisor, trials = self._taken_in(self._err), self._taken_in(self._ends.err)
        return from_supervisor and trials

    def _taken_in(self, handle: int) -> bool:
        try:
            for _ in range(64):
                if not (chunk := os.read(handle, 1 << 16)):
                    return False
                self._log = (self._log + chunk)[-_LOG_BYTES:]
        except BlockingIOError:
            return True
        return True

    def count_cpu(self) -> None:
        """Add the processor time it has taken so far to `resource_usage.uncollected_cpu_s`."""
        self._cpu.count()

    def end_reason(self) -> tuple[str, str]:
        """How the process ended: a fault's kind and description."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_LAST_S)
        code = self._process.returncode
        if code is None:
            return "died", "the agent closed its pipe"
        return cleanup.describe_exit(cleanup.unwrap_bwrap(code) if self.policy.level == "L3" else code)

    def kill(self) -> None:
        """End everything that the guest has started, close the pipes, and remove what it has written."""
        with self._cpu.ending():
            if self.policy.level == "L1":
                cleanup.end_descendants(self._process.pid)
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        self._close()

    def _close(self) -> None:
        with self._orders:
            self._socket.close()
        os.close(self._err)
        self._ends.close()
        remove_folder(self._folder)


def remove_folder(folder: str) -> None:
    """Remove the folder that a guest may have written to; an empty name stands for none."""
    if folder:
        cleanup.empty_folder(folder)
        shutil.rmtree(folder, ignore_errors=True)


def start_process(
    agent: AgentReference,
    level: str,
    *,
    hidden: tuple[str, ...],
    memory_mb: int,
    disk_mb: int,
    gpus: bool = False,
    readable: tuple[str, ...] = (),
) -> GuestProcess:
    """Start a guest at a level; its first message says whether the level is in force."""
    compiled = os.environ.get("NUMBA_CACHE_DIR", "")
    if compiled:
        os.makedirs(compiled, exist_ok=True)
    more = ([compiled] if compiled else []) + (list(paths.GPU_FACTS) if gpus else [])
    read = paths.readable_paths(agent.path, agent.root, hidden, readable)
    folder = "" if level == "L3" else tempfile.mkdtemp(prefix="hthor-guest-")
    policy = Policy(
        level=level,
        read=(*read, *more),
        listed=(*paths.listed_folders(agent.root), *(place for place in readable if os.path.isdir(place))),
        scratch=os.path.join(folder, _HOME) if folder else _INSIDE,
        memory_mb=memory_mb,
        disk_mb=disk_mb,
        execute=bool(agent.words),
        devices=paths.gpu_devices() if gpus else (),
        compiled=compiled,
    )
    try:
        if folder:
            os.mkdir(policy.scratch)
        return GuestProcess(policy, folder)
    except OSError:
        remove_folder(folder)
        raise


def _environment(ours: Mapping[str, str], policy: Policy) -> dict[str, str]:
    """The guest's environment variables: only what an interpreter needs, one thread, and a fixed hash seed."""
    passed_on = (*_PASSED_ON, *(paths.GPU_VARIABLES if policy.devices else ()))
    env = {name: ours[name] for name in passed_on if name in ours}
    env.update(dict.fromkeys(_THREADS, "1"))
    env.update(dict.fromkeys(("HOME", "TMPDIR"), policy.scratch))
    env["GLIBC_TUNABLES"] = _MEMORY
    env.update(PYTHONHASHSEED="0", PYTHONDONTWRITEBYTECODE="1", USER="agent", LOGNAME="agent")
    env["PYTHONPATH"] = os.pathsep.join([str(paths.PACKAGE.parent), *paths.library_folders()])
    return env
