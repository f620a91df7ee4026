"""A submitted agent as the evaluation sees it: an agent that runs in another process."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path

from hthor.guest.agent import agent_paths, reference
from hthor.guest.confinement import AUTO, Isolation, paths
from hthor.guest.host.channel import GuestFault, MessageChannel, TrialStopped, explain_fault
from hthor.guest.host.guest_pool import GuestPool
from hthor.guest.host.info import GuestConfig, GuestInfo
from hthor.guest.host.process import GuestProcess
from hthor.guest.host.startup import GuestStartup
from hthor.guest.host.trial_exchange import TrialExchange
from hthor.guest.host.websocket_client import Unreachable
from hthor.guest.process_tools import cpu_affinity
from hthor.guest.protocol import wire
from hthor.types import Action, Briefing, Observation

_IDLE_AGENT = paths.PACKAGE / "agents" / "silent.py"


def load_info(
    path: str | Path, cls: str | None = None, *, config: GuestConfig | None = None, start_s: float = 60.0
) -> GuestInfo:
    """Start an agent, and return its description. Arguments and errors are those of `Guest` and `Guest.load`."""
    with Guest(path, cls, config=config, start_s=start_s) as guest:
        return guest.load()


def in_force(level: str = AUTO) -> Isolation:
    """How a guest is confined on this machine, found by starting an agent that does nothing.

    Args:
        level: "L1", "L2", "L3", or "auto" for the strongest that starts.

    Raises:
        UnknownName: when there is no such level. IsolationError: when it does not start.
    """
    return load_info(_IDLE_AGENT, config=GuestConfig(isolation=level)).isolation


class Guest:
    """A submitted agent. Every trial gets a new agent object and, unless it is ``persistent``, a new process.

    Any thread may call it. Calls wait for each other, but `finish`, `begin` and `close` do not wait for an ``act`` in
    another thread: they end its trial at once, unless the agent is ``persistent``, which must complete its step.

    Args:
        path: the agent, as `reference.parse_reference` reads it: a file, a module, a command, an address, or a program
            that connects.
        cls: the class to use when the file has several.
        start_s: seconds allowed to start the agent, and as many for every ``begin``.
        step_s: seconds allowed for each ``act``, without the time that the host takes to answer it (rendering).
        bank_s: extra seconds that all ``act`` calls of a trial may use together beyond ``step_s``.
        config: how the agent is isolated, and its inputs. An agent that runs elsewhere is not isolated at all.
        pool: keeps idle processes, also this guest's when it is closed; without a pool, that process ends then.
        memory_mb: the memory that it may use. disk_mb: how much it may write in a trial.

    Attributes:
        reference: which agent it is. inputs: the inputs it is given. paths: where its own files are.

    Raises:
        UnknownName, AgentError: when ``path`` names no agent.
        HthorError: when it cannot be given its inputs.
    """

    def __init__(
        self,
        path: str | Path,
        cls: str | None = None,
        *,
        config: GuestConfig | None = None,
        pool: GuestPool | None = None,
        start_s: float = 60.0,
        step_s: float = 5.0,
        bank_s: float = 60.0,
        memory_mb: int = 4096,
        disk_mb: int = 256,
    ) -> None:
        self._pinned, self._channel, self._lock = False, MessageChannel(), threading.RLock()
        config = config or GuestConfig()
        self.inputs = config.inputs
        self.reference = reference.parse_reference(str(path), cls)
        self.paths = agent_paths.find_agent_paths(self.reference, self.inputs.extra_paths(self.reference))
        self._startup = GuestStartup(
            self._channel,
            self.reference,
            config=config,
            pool=pool or GuestPool(most=0),
            start_s=start_s,
            memory_mb=memory_mb,
            disk_mb=disk_mb,
            paths=self.paths,
        )
        self._start_s, self._step_s, self._bank_s = start_s, step_s, bank_s
        self._info: GuestInfo | None = None
        self._exchange: TrialExchange | None = None
        self._ending = False

    def load(self) -> GuestInfo:
        """Start the agent, unless it runs already.

        Raises:
            Unreachable: when it is served elsewhere and the server does not answer, or has left and not come back.
            AgentError: when its file is missing, does not compile, cannot be imported in time, or has no agent class.
            IsolationError: when the requested level does not start.
        """
        with self._lock:
            if self._channel.transport is None or self._info is None:
                self._info = None
                with cpu_affinity.unpinned():
                    self._info = self._startup.start()
            return self._info

    def begin(self, briefing: Briefing) -> None:
        """Start a trial with a new agent.

        Raises:
            GuestFault: when the agent fails, or its server is gone. AgentError: when it cannot be loaded.
            TrialStopped: when another thread ends the trial.
        """
        with self._sole_use():
            self._end_trial()
            try:
                self.load()
            except Unreachable as error:
                raise GuestFault("died", str(error)) from None
            try:
                self._exchange = self._begin(briefing)
            except (GuestFault, TrialStopped) as error:
                raise self._ended(error) from None

    def act(self, observation: Observation) -> Action:
        """The agent's action.

        Raises:
            GuestFault: when it raises, hangs, dies, or sends an invalid action; its process has then ended.
            TrialStopped: when another thread ends the trial.
        """
        with self._lock:
            if self._exchange is None or self._channel.transport is None:
                raise GuestFault("died", "the agent has no trial: begin was not called, or it failed before")
            if self._pinned and not cpu_affinity.is_main_thread():
                self._part()
            try:
                return self._exchange.act(observation)
            except (GuestFault, TrialStopped) as error:
                raise self._ended(error) from None

    def finish(self) -> None:
        """End the trial; its process ends in the background. Calling this is optional."""
        with self._sole_use():
            self._start_end()
            if self.reference.form == reference.SOCKET and self._info is not None:
                self._startup.leave_idle(self._info)  # between trials it may leave and connect again

    def close(self) -> None:
        """End the process, or leave it idle in the pool; a later ``begin`` starts another."""
        with self._sole_use():
            self._end_trial()
            if self._info is None or not self._startup.leave_idle(self._info):
                self._channel.close()

    def take_opened(self) -> tuple[str, ...]:
        """The agent's own files that it has reported as opened since the last call, by their names in the manifest."""
        names = tuple(sorted(self._channel.opened))
        self._channel.opened.clear()
        return names

    @property
    def pid(self) -> int:
        """The id of its first process, 0 when there is none."""
        return self._channel.transport.pid if self._channel.transport is not None else 0

    @property
    def log(self) -> str:
        """The last 16 KiB, at most, of the agent's output."""
        return self._channel.log

    def __enter__(self) -> Guest:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_channel", None) is not None:
            with contextlib.suppress(Exception):  # the interpreter may be shutting down
                self._unpin()
                self._channel.close()

    def _begin(self, briefing: Briefing) -> TrialExchange:
        channel, process = self._channel, self._process
        self._pinned = process is not None and process.pin()
        window = process.frames if process else None
        exchange = TrialExchange(
            channel, step_s=self._step_s, bank_s=self._bank_s, ahead=self._startup.ahead, window=window
        )
        channel.send(wire.Begin(briefing=briefing), self._start_s)
        answer, left = channel.receive(self._start_s)
        if isinstance(answer, wire.Ready) and self.reference.words:  # a program sends Ready whenever it is started
            answer, _ = channel.receive(left, f"{self._start_s:g} s")
        if not isinstance(answer, wire.Done):
            raise channel.wrong("begin", answer)
        return exchange

    def _ended(self, error: GuestFault | TrialStopped) -> GuestFault | TrialStopped:
        """The error to raise after a trial has ended too early; a fault that isolation caused gets an explanation."""
        if isinstance(error, GuestFault):
            policy = self._startup.policy
            return explain_fault(error, policy, self.reference.root) if policy else error
        self._exchange = None
        if self._process is not None:
            self._process.next_trial()
        return error

    @contextlib.contextmanager
    def _sole_use(self) -> Iterator[None]:
        """Keep other threads out. If one of them is in the middle of a trial, that trial ends first."""
        if not self._lock.acquire(blocking=False):
            if self._process is not None and self._info is not None and not self._info.persistent:
                self._channel.stopping = True
                self._process.stop_trial()
            self._lock.acquire()
        try:
            self._channel.stopping = False
            yield
        finally:
            self._lock.release()

    @property
    def _process(self) -> GuestProcess | None:
        return self._channel.transport if isinstance(self._channel.transport, GuestProcess) else None

    def _unpin(self) -> None:
        """Let the main thread run on any CPU again."""
        if self._pinned:
            self._pinned = False
            cpu_affinity.unpin_thread()

    def _part(self) -> None:
        """The trial was begun in the main thread, but goes on in this thread: share no CPU."""
        self._unpin()
        cpu_affinity.free_thread()
        if self._process is not None:
            self._process.unpin()

    def _start_end(self) -> None:
        """Tell the guest that the trial is over."""
        self._unpin()
        exchange, self._exchange = self._exchange, None
        if exchange is not None and self._channel.transport is not None:
            exchange.end()
            self._ending = self._info is not None and not self._info.persistent

    def _end_trial(self) -> None:
        """End the trial, and wait until its process has ended; if it does not, end it with its supervisor."""
        self._start_end()
        if not self._ending:
            return
        self._ending = False
        with contextlib.suppress(GuestFault):
            answer, _ = self._channel.receive(self._step_s)
            if not isinstance(answer, wire.Over):
                self._channel.close()
            elif self._process is not None:
                self._process.next_trial()
