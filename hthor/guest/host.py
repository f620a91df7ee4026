"""The host's side of a submitted agent: a mind that lives elsewhere; knows nothing of what it is used for."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor.errors import AgentError
from hthor.guest import wire
from hthor.types import Action, Briefing, Observation

_ROOT = Path(__file__).resolve().parents[2]
_PASSED_ON = ("PATH", "HOME", "LANG", "LC_ALL", "TZ", "TMPDIR", "VIRTUAL_ENV", "LD_LIBRARY_PATH", "NUMBA_CACHE_DIR")
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_LOG_BYTES = 16 << 10
_PIPE_BYTES = 1 << 20
_F_SETPIPE_SZ = 1031
_guests_words = msgspec.msgpack.Decoder(wire.ToHost)


class GuestFault(Exception):
    """A submitted agent failed; its process is gone.

    Attributes:
        kind: raised, timeout, died, garbage, wrong_type, oversized or not_finite.
        detail: what happened; for "raised" the traceback of the agent's own frames.
        traceback: the same traceback, empty for the other kinds.
        log: the end of what the agent printed.
    """

    def __init__(self, kind: str, detail: str, traceback: str = "", log: str = "") -> None:
        self.kind, self.traceback, self.log = kind, traceback, log
        self.detail = traceback or detail
        super().__init__(f"{kind}: {detail}")


class GuestInfo(Struct, frozen=True, kw_only=True):
    """What a file says of its agent. ``robots`` names the bodies it is made for (empty: any); ``absent`` means none.

    ``sha256`` is the hash of the file alone: what it imports is not covered.
    """

    name: str
    source: str
    sha256: str
    privileges: tuple[str, ...] = ()
    robots: tuple[str, ...] = ()
    absent: bool = False
    doc: str = ""


def load_info(path: str | Path, cls: str | None = None, *, start_s: float = 60.0) -> GuestInfo:
    """Load an agent's file in a process of its own, and say what it is.

    Args:
        path: of the file, or ``file.py:Class``.

    Raises:
        AgentError: as `Guest.load`.
    """
    guest = Guest(path, cls, start_s=start_s)
    try:
        return guest.load()
    finally:
        guest.close()


class Guest:
    """A submitted agent as a mind. Every trial gets a new agent object and, unless ``persistent``, a fresh process.

    Not for use from several threads; on Linux the process dies when the thread that started it ends.

    Args:
        path: the agent's file, or ``file.py:Class``.
        cls: the class to use when the file has several.
        start_s: seconds for loading the file, and again for every ``begin``.
        step_s: seconds for each ``act``; what the host takes to answer (rendering) does not count.
    """

    def __init__(self, path: str | Path, cls: str | None = None, *, start_s: float = 60.0, step_s: float = 5.0) -> None:
        self._path, self._class = _parse(path, cls)
        self._start_s, self._step_s = start_s, step_s
        self._process: subprocess.Popen[bytes] | None = None
        self._info: GuestInfo | None = None
        self._in = self._out = self._err = -1
        self._playing = False
        self._buffer, self._log = b"", b""

    def load(self) -> GuestInfo:
        """Start the process and load the file, unless that is done.

        Raises:
            AgentError: when the file is missing, does not compile, cannot be imported in time, or has no agent class.
        """
        if self._process is not None and self._info is not None:
            return self._info
        digest = _digest(self._path)
        self._spawn()
        try:
            self._send(wire.Load(path=str(self._path), cls=self._class), self._start_s)
            ready, _ = self._receive(self._start_s)
        except GuestFault as fault:
            raise AgentError(f"{self._path}: loading it failed ({fault}).\n{fault.log}".rstrip()) from None
        if not isinstance(ready, wire.Ready):
            self._kill()
            detail = ready.detail if isinstance(ready, wire.Failed) else f"unexpected {type(ready).__name__}"
            raise AgentError(detail)
        self._info = GuestInfo(
            name=ready.name if not self._class else f"{ready.name}:{self._class}",
            source=str(self._path),
            sha256=digest,
            privileges=ready.privileges,
            robots=ready.robots,
            absent=ready.absent,
            doc=ready.doc,
        )
        return self._info

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with a new agent.

        Raises:
            GuestFault: when the agent fails. AgentError: when its file cannot be loaded.
        """
        if self._playing:
            self._send(wire.End(), self._step_s)
            self._playing = False
        self.load()
        self._send(wire.Begin(briefing=briefing), self._start_s)
        answer, _ = self._receive(self._start_s)
        if not isinstance(answer, wire.Done):
            raise self._fault("garbage", f"begin was answered by {type(answer).__name__}")
        self._playing = True

    def act(self, observation: Observation) -> Action:
        """The agent's action.

        Raises:
            GuestFault: when it raises, hangs, dies, or sends what is no action; its process is then gone.
        """
        if not self._playing:
            raise GuestFault("died", "the agent has no trial: begin was not called, or it failed before")
        slim = tuple(msgspec.structs.replace(message, image=None) for message in observation.inbox)
        self._send(wire.Look(observation=msgspec.structs.replace(observation, senses=None, inbox=slim)), self._step_s)
        left = self._step_s
        while True:
            answer, left = self._receive(left)
            if isinstance(answer, wire.Ask):
                self._send(wire.Given(value=msgspec.Raw(wire.encode(self._sense(observation, answer)))), self._step_s)
            elif isinstance(answer, wire.Acted):
                wrong = wire.objection(answer.action)
                if wrong:
                    raise self._fault(*wrong)
                return answer.action
            else:
                raise self._fault("garbage", f"act was answered by {type(answer).__name__}")

    def close(self) -> None:
        """End the process; a later ``begin`` starts another."""
        self._kill()

    @property
    def log(self) -> str:
        """The end of what the agent printed, 16 KiB at most."""
        self._drain()
        return self._log.decode(errors="replace")

    def __enter__(self) -> Guest:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_process", None) is not None:
            with contextlib.suppress(Exception):  # the interpreter may be half gone
                self._kill()

    def _sense(self, observation: Observation, ask: wire.Ask) -> Any:
        """What was asked for. A failure to sense is ours, so the guest is let go and the error passed on."""
        try:
            if ask.what in ("detections", "scan", "rgb", "depth", "segmentation", "camera"):
                return getattr(observation.senses, ask.what)()
            pictures = [message.image for message in observation.inbox if message.id == ask.which]
            if ask.what == "image" and pictures and callable(pictures[0]):
                return pictures[0]()
        except Exception:
            self._kill()
            raise
        raise self._fault("garbage", f"asked for '{ask.what[:80]}', which there is not")

    def _spawn(self) -> None:
        """A fresh interpreter with two pipes, one more for what it prints, a small environment and its own group."""
        guest_in, self._out = os.pipe()
        self._in, guest_out = os.pipe()
        self._err, printed = os.pipe()
        for handle in (self._in, self._out, self._err):
            os.set_blocking(handle, False)
        with contextlib.suppress(OSError):  # only speed depends on it
            fcntl.fcntl(self._out, _F_SETPIPE_SZ, _PIPE_BYTES)
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-u", "-m", "hthor.guest", str(guest_in), str(guest_out), str(os.getpid())],
                stdin=subprocess.DEVNULL,
                stdout=printed,
                stderr=printed,
                pass_fds=(guest_in, guest_out),
                cwd=self._path.parent,
                env=_environment(os.environ),
                start_new_session=True,
            )
        finally:
            for handle in (guest_in, guest_out, printed):
                os.close(handle)
        self._buffer, self._log = b"", b""

    def _send(self, message: wire.ToGuest, seconds: float) -> None:
        data, end = memoryview(wire.frame(message)), time.monotonic() + seconds
        while data:
            try:
                data = data[os.write(self._out, data) :]
            except BlockingIOError:
                if not self._wait(self._out, select.POLLOUT, end):
                    raise self._fault("timeout", f"the agent read nothing for {seconds:g} s") from None
            except OSError:
                raise self._fault("died", self._obituary()) from None

    def _receive(self, seconds: float) -> tuple[wire.ToHost, float]:
        """The guest's next message, and what is left of the time."""
        end = time.monotonic() + seconds
        while (body := self._next()) is None:
            if not self._wait(self._in, select.POLLIN, end):
                raise self._fault("timeout", f"the agent gave no answer within {seconds:g} s")
            chunk = os.read(self._in, 1 << 16)
            if not chunk:
                raise self._fault("died", self._obituary())
            self._buffer += chunk
        try:
            message: wire.ToHost = _guests_words.decode(body)
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            raise self._fault("garbage", f"what came is no message: {error}") from None
        if isinstance(message, wire.Failed) and self._info is not None:
            raise self._fault(message.kind, message.detail, message.traceback)
        return message, max(0.0, end - time.monotonic())

    def _next(self) -> bytes | None:
        """The next whole frame of the buffer."""
        if len(self._buffer) < 4:
            return None
        size = int.from_bytes(self._buffer[:4], "little")
        if size > wire.MOST_BYTES:
            raise self._fault("oversized", f"a message of {size} bytes, at most {wire.MOST_BYTES} are taken")
        if len(self._buffer) < 4 + size:
            return None
        body, self._buffer = self._buffer[4 : 4 + size], self._buffer[4 + size :]
        return body

    def _wait(self, handle: int, event: int, end: float) -> bool:
        """Wait until a pipe is ready, reading along what the agent prints; false when time is up."""
        while True:
            poll = select.poll()
            poll.register(handle, event)
            poll.register(self._err, select.POLLIN)
            ready = dict(poll.poll(max(0.0, end - time.monotonic()) * 1000.0))
            if handle in ready:
                return True
            if not ready:
                return False
            if not self._drain():
                time.sleep(0.001)  # the log was closed; do not spin on it

    def _drain(self) -> bool:
        """Take in what the agent printed; false when nothing more can come."""
        try:
            while self._err >= 0 and (chunk := os.read(self._err, 1 << 16)):
                self._log = (self._log + chunk)[-_LOG_BYTES:]
        except BlockingIOError:
            return True
        return False

    def _obituary(self) -> str:
        process = self._process
        if process is None:
            return "the agent's process is gone"
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(0.5)
        code = process.returncode
        if code is None:
            return "the agent closed its pipe"
        return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exited with status {code}"

    def _fault(self, kind: str, detail: str, traceback: str = "") -> GuestFault:
        """End the process, and say why."""
        log = self.log
        self._kill()
        return GuestFault(kind, detail[:8000], traceback, log)

    def _kill(self) -> None:
        """End the whole process group and close the pipes."""
        process, self._process, self._playing = self._process, None, False
        if process is None:
            return
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        for handle in (self._in, self._out, self._err):
            os.close(handle)
        self._in = self._out = self._err = -1


def _parse(path: str | Path, cls: str | None) -> tuple[Path, str]:
    """File and class of ``file.py:Class``."""
    text = str(path)
    if cls is None and ".py:" in text:
        text, _, cls = text.rpartition(":")
    return Path(text).resolve(), cls or ""


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        hint = "Write one to start from: hthor agent new my_agent.py"
        raise AgentError(f"cannot read the agent's file {path}: {error.strerror}. {hint}") from None


def _environment(ours: Mapping[str, str]) -> dict[str, str]:
    """Nothing of ours but what an interpreter needs; one thread, and the same hash seed every time."""
    env = {name: ours[name] for name in _PASSED_ON if name in ours}
    env.update(dict.fromkeys(_THREADS, "1"))
    env["PYTHONHASHSEED"] = "0"
    env["PYTHONPATH"] = str(_ROOT)
    return env
