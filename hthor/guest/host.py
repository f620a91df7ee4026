"""The host's side of a submitted agent: a mind that lives elsewhere; knows nothing of what it is used for."""

from __future__ import annotations

import contextlib
import hashlib
import time
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor.errors import AgentError
from hthor.guest import choosing, wire
from hthor.guest.confinement import Isolation
from hthor.guest.process import HungUp, Process, TimeIsUp
from hthor.types import Action, Briefing, Observation

_ENTER_S = 120.0
"""Seconds until a process must say what holds it: the start of an interpreter, and the libraries an agent names."""
_ASKS = 100
"""How often an agent may ask for something within one ``act``; what it has read once it need not ask for again."""
_GUESTS_FAULTS = ("raised", "wrong_type", "garbage", "oversized", "contract", "confinement")
"""Kinds of fault that a guest may report of itself; the others are for its keeper and the host to find."""
_WORDS = 8000
_guests_words = msgspec.msgpack.Decoder(wire.ToHost)
_keepers_words = msgspec.msgpack.Decoder(wire.KeeperToHost)


class GuestFault(Exception):
    """A submitted agent failed; its process is gone.

    Attributes:
        kind: raised, timeout, died, memory, disk, garbage, wrong_type, oversized or not_finite.
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

    ``persistent`` agents keep one process for all their trials. ``sha256`` is the hash of the file alone: what it
    imports is not covered. ``isolation`` is what held the agent while it was asked.
    """

    name: str
    source: str
    sha256: str
    privileges: tuple[str, ...] = ()
    robots: tuple[str, ...] = ()
    absent: bool = False
    persistent: bool = False
    doc: str = ""
    isolation: Isolation


def load_info(
    path: str | Path, cls: str | None = None, *, start_s: float = 60.0, isolation: str | None = None
) -> GuestInfo:
    """Load an agent's file in a process of its own, and say what it is.

    Args:
        path: of the file, or ``file.py:Class``.

    Raises:
        AgentError, IsolationError: as `Guest.load`.
    """
    guest = Guest(path, cls, start_s=start_s, isolation=isolation)
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
        bank_s: seconds in a trial by which its ``act`` may take longer than that, all together.
        isolation: "L1", "L2", "L3", or "auto" for the strongest that the machine gives; by default what
            `confine_guests` has laid down for this process.
        memory_mb: memory that it may hold. disk_mb: what it may write in a trial.
    """

    def __init__(
        self,
        path: str | Path,
        cls: str | None = None,
        *,
        start_s: float = 60.0,
        step_s: float = 5.0,
        bank_s: float = 60.0,
        isolation: str | None = None,
        memory_mb: int = 4096,
        disk_mb: int = 256,
    ) -> None:
        self._path, self._class = _parse(path, cls)
        self._start_s, self._step_s, self._bank_s = start_s, step_s, bank_s
        self._bank = bank_s
        self._isolation, self._memory_mb, self._disk_mb = isolation, memory_mb, disk_mb
        self._process: Process | None = None
        self._info: GuestInfo | None = None
        self._playing = False
        self._log = ""

    def load(self) -> GuestInfo:
        """Start the process and load the file, unless that is done.

        Raises:
            AgentError: when the file is missing, does not compile, cannot be imported in time, or has no agent class.
            IsolationError: when the level that was asked for cannot be had.
        """
        if self._process is not None and self._info is not None:
            return self._info
        digest = _digest(self._path)
        held = choosing.start(self._path, self._isolation, self._enter, self._memory_mb, self._disk_mb)
        try:
            ready = self._receive(self._start_s)[0]
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
            persistent=ready.persistent,
            doc=ready.doc,
            isolation=held,
        )
        return self._info

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with a new agent.

        Raises:
            GuestFault: when the agent fails. AgentError: when its file cannot be loaded.
        """
        if self._playing:
            self._end()
        self.load()
        self._send(wire.Begin(briefing=briefing), self._start_s)
        answer, _ = self._receive(self._start_s)
        if not isinstance(answer, wire.Done):
            raise self._wrong("begin", answer)
        self._playing, self._bank = True, self._bank_s

    def act(self, observation: Observation) -> Action:
        """The agent's action.

        Raises:
            GuestFault: when it raises, hangs, dies, or sends what is no action; its process is then gone.
        """
        if not self._playing:
            raise GuestFault("died", "the agent has no trial: begin was not called, or it failed before")
        slim = tuple(msgspec.structs.replace(message, image=None) for message in observation.inbox)
        self._send(wire.Look(observation=msgspec.structs.replace(observation, senses=None, inbox=slim)), self._step_s)
        left = granted = self._step_s + self._bank
        for _ in range(_ASKS):
            answer, left = self._receive(left)
            if isinstance(answer, wire.Ask):
                self._send(wire.Given(value=msgspec.Raw(wire.encode(self._sense(observation, answer)))), self._step_s)
            elif isinstance(answer, wire.Acted):
                wrong = wire.objection(answer.action)
                if wrong:
                    raise self._fault(*wrong)
                self._bank -= max(0.0, granted - left - self._step_s)
                return answer.action
            else:
                raise self._wrong("act", answer)
        raise self._fault("garbage", f"asked for more than {_ASKS} things within one act")

    def close(self) -> None:
        """End the process; a later ``begin`` starts another."""
        self._kill()

    @property
    def pid(self) -> int:
        """The first of its processes, 0 when there is none."""
        return self._process.pid if self._process is not None else 0

    @property
    def log(self) -> str:
        """The end of what the agent printed, 16 KiB at most."""
        return self._log if self._process is None else self._process.log

    def __enter__(self) -> Guest:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_process", None) is not None:
            with contextlib.suppress(Exception):  # the interpreter may be half gone
                self._kill()

    def _enter(self, process: Process) -> wire.Confined | str:
        """What a process that has just started says of its confinement, or why it has none."""
        self._process, self._info = process, None
        load = wire.Load(path=str(self._path), cls=self._class, policy=process.policy)
        try:
            self._send(load, _ENTER_S)
            said, _ = self._receive(_ENTER_S)
        except GuestFault as fault:
            return fault.log.strip() or str(fault)
        if isinstance(said, wire.Confined):
            return said
        self._kill()
        return said.detail if isinstance(said, wire.Failed) else f"unexpected {type(said).__name__}"

    def _end(self) -> None:
        """Let the trial's process come to its end; whoever will not is ended with its keeper."""
        self._playing = False
        with contextlib.suppress(GuestFault):
            self._send(wire.End(), self._step_s)
            if self._info is not None and not self._info.persistent:
                answer, _ = self._receive(self._step_s)
                if not isinstance(answer, wire.Over):
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

    def _send(self, message: wire.ToGuest, seconds: float) -> None:
        try:
            self._running().write(wire.frame(message), time.monotonic() + seconds)
        except TimeIsUp:
            raise self._fault("timeout", f"the agent read nothing for {seconds:g} s") from None
        except HungUp:
            raise self._fault("died", self._running().obituary()) from None

    def _receive(self, seconds: float) -> tuple[wire.ToHost | wire.Over, float]:
        """The next message of the guest or its keeper, and what is left of the time."""
        end = time.monotonic() + seconds
        try:
            keepers, body = self._running().read(wire.MOST_BYTES, end)
        except TimeIsUp:
            raise self._fault("timeout", f"the agent gave no answer within {seconds:.3g} s") from None
        except HungUp:
            raise self._fault("died", self._running().obituary()) from None
        if isinstance(body, int):
            raise self._fault("oversized", f"a message of {body} bytes, at most {wire.MOST_BYTES} are taken")
        message: wire.ToHost | wire.Over
        try:
            message = _keepers_words.decode(body) if keepers else _guests_words.decode(body)
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            raise self._fault("garbage", f"what came is no message: {error}") from None
        if isinstance(message, wire.Failed) and (self._info is not None or keepers):
            kind = message.kind if keepers or message.kind in _GUESTS_FAULTS else "garbage"
            raise self._fault(kind, message.detail, message.traceback)
        return message, max(0.0, end - time.monotonic())

    def _wrong(self, what: str, answer: object) -> GuestFault:
        if isinstance(answer, wire.Over):
            return self._fault("died", f"its process ended before it had answered {what}")
        return self._fault("garbage", f"{what} was answered by {type(answer).__name__}")

    def _running(self) -> Process:
        if self._process is None:
            raise GuestFault("died", "the agent's process is gone")
        return self._process

    def _fault(self, kind: str, detail: str, traceback: str = "") -> GuestFault:
        """End the process, and say why."""
        log = self.log
        self._kill()
        return GuestFault(kind, detail[:_WORDS], traceback[-_WORDS:], log)

    def _kill(self) -> None:
        process, self._process, self._playing = self._process, None, False
        if process is not None:
            self._log = process.log
            process.kill()


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
