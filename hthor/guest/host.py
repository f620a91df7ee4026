"""The host's side of a submitted agent: a mind that lives elsewhere; knows nothing of what it is used for."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import msgspec

from hthor.errors import KILLED, AgentError, AgentKilled
from hthor.guest import answering, choosing, info, reference, served, wire
from hthor.guest.confinement import Isolation
from hthor.guest.faults import GuestFault
from hthor.guest.frames import Window
from hthor.guest.info import GuestInfo
from hthor.guest.process import Process
from hthor.guest.served import Unreachable
from hthor.guest.talk import Talk
from hthor.types import Action, Briefing, Observation

_T = TypeVar("_T")
_ENTER_S = 120.0
"""Seconds until a process must say what holds it: the start of an interpreter, and the libraries an agent names."""
_ASKS = 100
"""How often an agent may ask for something within one ``act``; what it has read once it need not ask for again."""


def load_info(
    path: str | Path, cls: str | None = None, *, start_s: float = 60.0, isolation: str | None = None
) -> GuestInfo:
    """Bring an agent up, and say what it is.

    Args:
        path: the agent, as `reference.read` reads it.

    Raises:
        UnknownName, AgentError, IsolationError: as `Guest` and `Guest.load`.
    """
    with Guest(path, cls, start_s=start_s, isolation=isolation) as guest:
        return guest.load()


class Guest:
    """A submitted agent as a mind. Every trial gets a new agent object and, unless ``persistent``, a fresh process.

    Not for use from several threads; on Linux the process dies when the thread that started it ends.

    Args:
        path: the agent, as `reference.read` reads it: a file, a module, a command or an address.
        cls: the class to use when the file has several.
        start_s: seconds for coming up, and again for every ``begin``.
        step_s: seconds for each ``act``; what the host takes to answer (rendering) does not count.
        bank_s: seconds in a trial by which its ``act`` may take longer than that, all together.
        isolation: "L1", "L2", "L3", or "auto" for the strongest that the machine gives; by default what
            `confine_guests` has laid down for this process. An agent that is served elsewhere is not held at all.
        memory_mb: memory that it may hold. disk_mb: what it may write in a trial.

    Raises:
        UnknownName, AgentError: when ``path`` names no agent.
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
        self._talk = Talk()
        self.reference = reference.read(str(path), cls)
        self._start_s, self._step_s, self._bank_s = start_s, step_s, bank_s
        self._bank = bank_s
        self._isolation, self._memory_mb, self._disk_mb = isolation, memory_mb, disk_mb
        self._info: GuestInfo | None = None
        self._gpus = 0.0
        self._playing = self._ending = self._ahead = False
        self._habits: answering.Habits | None = None

    def load(self) -> GuestInfo:
        """Bring the agent up, unless that is done.

        Raises:
            Unreachable: when it is served, and the server is not there.
            AgentError: when its file is missing, does not compile, cannot be imported in time, or has no agent class.
            IsolationError: when the level that was asked for cannot be had.
        """
        if self._talk.line is not None and self._info is not None:
            return self._info
        digest, self._info = self.reference.sha256, None
        held = self._connect() if self.reference.url else self._start()
        try:
            ready = self._talk.receive(self._start_s)[0]
        except GuestFault as fault:
            kind = AgentKilled if fault.kind == KILLED else AgentError
            raise kind(f"{self.reference.text}: loading it failed ({fault}).\n{fault.log}".rstrip()) from None
        if not isinstance(ready, wire.Ready):
            self.close()
            detail = ready.detail if isinstance(ready, wire.Failed) else f"unexpected {type(ready).__name__}"
            raise AgentError(detail)
        try:
            found = info.describe(self.reference, digest, ready, held)
        except AgentError:
            self.close()
            raise
        if found.gpus and not self._gpus and not self.reference.url:
            self.close()
            self._gpus = found.gpus
            return self.load()
        self._talk.loaded, self._info, self._ahead = True, found, ready.ahead
        return found

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with a new agent.

        Raises:
            GuestFault: when the agent fails, or its server is gone. AgentError: when it cannot be loaded.
        """
        self.finish()
        if self._ending:
            self._await_end()
        talk = self._talk
        try:
            self.load()
        except Unreachable as error:
            raise GuestFault("died", str(error)) from None
        if self._window is not None:
            self._window.wipe()
        talk.send(wire.Begin(briefing=briefing), self._start_s)
        answer, left = talk.receive(self._start_s)
        if isinstance(answer, wire.Ready) and self.reference.words:  # a program says so whenever it is started
            answer, _ = talk.receive(left)
        if not isinstance(answer, wire.Done):
            raise talk.wrong("begin", answer)
        self._playing, self._bank = True, self._bank_s
        self._habits = answering.Habits() if self._ahead else None

    def act(self, observation: Observation) -> Action:
        """The agent's action.

        Raises:
            GuestFault: when it raises, hangs, dies, or sends what is no action; its process is then gone.
        """
        talk, window = self._talk, self._window
        if not self._playing or talk.line is None:
            raise GuestFault("died", "the agent has no trial: begin was not called, or it failed before")
        slim = tuple(msgspec.structs.replace(message, image=None) for message in observation.inbox)
        ahead = self._ours(self._habits.ahead, observation) if self._habits else {}
        bare = msgspec.structs.replace(observation, senses=None, inbox=slim)
        talk.send(wire.Look(observation=bare, ahead=ahead), self._step_s)
        if window is not None:
            window.clear()
        left = granted = self._step_s + self._bank
        for _ in range(_ASKS):
            said, left = talk.receive(left)
            if isinstance(said, wire.Ask):
                talk.send(self._given(observation, said), self._step_s)
                if self._habits:
                    self._habits.read(said.what)
            elif isinstance(said, wire.Acted):
                if wrong := wire.objection(said.action):
                    raise talk.fault(*wrong)
                if self._habits:
                    self._habits.read(*said.read)
                self._bank -= max(0.0, granted - left - self._step_s)
                return said.action
            else:
                raise talk.wrong("act", said)
        raise talk.fault("garbage", f"asked for more than {_ASKS} things within one act")

    def finish(self) -> None:
        """The trial is over: its process comes to its end while the caller goes on. Need not be called."""
        if not self._playing:
            return
        self._playing = False
        with contextlib.suppress(GuestFault):
            self._talk.send(wire.End(), self._step_s)
            self._ending = self._info is not None and not self._info.persistent

    def close(self) -> None:
        """End the process; a later ``begin`` starts another."""
        self._playing = self._ending = False
        self._talk.close()

    @property
    def pid(self) -> int:
        """The first of its processes, 0 when there is none."""
        return self._talk.line.pid if self._talk.line is not None else 0

    @property
    def log(self) -> str:
        """The end of what the agent printed, 16 KiB at most."""
        return self._talk.log

    def __enter__(self) -> Guest:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_talk", None) is not None:
            with contextlib.suppress(Exception):  # the interpreter may be half gone
                self.close()

    @property
    def _process(self) -> Process | None:
        return self._talk.line if isinstance(self._talk.line, Process) else None

    @property
    def _window(self) -> Window | None:
        return self._process.frames if self._process else None

    def _start(self) -> Isolation:
        """Start its process, at the level that is wanted or the strongest that comes up."""
        return choosing.start(
            self.reference, self._isolation, self._enter, self._memory_mb, self._disk_mb, gpus=self._gpus > 0.0
        )

    def _connect(self) -> Isolation:
        self._talk.open(served.connect(self.reference.url, self._start_s))
        return served.ISOLATION

    def _enter(self, process: Process) -> wire.Confined | str:
        """What a process that has just started says of its confinement, or why it has none."""
        self._talk.open(process)
        agent = self.reference
        load = wire.Load(
            path=agent.path,
            cls=agent.cls,
            policy=process.policy,
            module=agent.module,
            words=agent.words,
            root=agent.root,
        )
        try:
            self._talk.send(load, _ENTER_S)
            said, _ = self._talk.receive(_ENTER_S)
        except GuestFault as fault:
            if fault.kind == KILLED:  # which says nothing about what this machine can do
                raise AgentKilled(f"{self.reference.text}: its process was {fault.detail} while it started.") from None
            return fault.log.strip() or str(fault)
        if isinstance(said, wire.Confined):
            return said
        self.close()
        return said.detail if isinstance(said, wire.Failed) else f"unexpected {type(said).__name__}"

    def _await_end(self) -> None:
        """Wait until the last trial's process has come to its end; whoever will not is ended with its keeper."""
        self._ending = False
        with contextlib.suppress(GuestFault):
            answer, _ = self._talk.receive(self._step_s)
            if not isinstance(answer, wire.Over):
                self.close()

    def _given(self, observation: Observation, ask: wire.Ask) -> wire.Given:
        try:
            return self._ours(answering.answer, observation, ask, self._window)
        except answering.Unknown as error:
            raise self._talk.fault("garbage", str(error)) from None

    def _ours(self, sense: Callable[..., _T], *values: object) -> _T:
        """What sensing gives. A failure to sense is ours, so the guest is let go and the error passed on."""
        try:
            return sense(*values)
        except answering.Unknown:
            raise
        except Exception:
            self.close()
            raise
