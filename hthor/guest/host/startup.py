"""Starts a submitted agent: a process at a level of isolation, or a connection to a server.

The level is the requested one, or the strongest that starts. It counts only after a process has started with it.
"""

import os

from hthor.errors import KILLED, AgentError, AgentKilled
from hthor.guest.agent import inputs
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.agent.reference import SOCKET, AgentReference
from hthor.guest.confinement import AUTO, LEVELS, Isolation, IsolationError, Policy, namespaces
from hthor.guest.host import info, process, websocket_client
from hthor.guest.host.channel import GuestFault, MessageChannel, isolation_reason
from hthor.guest.host.guest_pool import GuestPool, IdleGuest, Key
from hthor.guest.host.info import GuestConfig, GuestInfo
from hthor.guest.host.process import GuestProcess
from hthor.guest.protocol import wire
from hthor.guest.protocol.wire import sanitize_text

_ENTER_S = 120.0
"""Seconds until a process must say how it is confined: it starts an interpreter and imports the agent's libraries."""

_HINT = "'hthor eval --isolation auto' takes the strongest level that there is; see docs/isolation.md."
_REFUSED = "operation not permitted"
_ONE_PROGRAM = (
    " A confined program may start no other: name the program that runs in the end, such as an interpreter instead of "
    "a script that calls it."
)


class GuestStartup:
    """Starts an agent, and restarts it after a failure. The arguments are those of `Guest`.

    Attributes:
        ahead: whether the agent accepts sensor data before it asks. policy: what its process may do.
    """

    def __init__(
        self,
        channel: MessageChannel,
        agent: AgentReference,
        *,
        config: GuestConfig,
        pool: GuestPool,
        start_s: float,
        memory_mb: int,
        disk_mb: int,
        paths: AgentPaths,
    ) -> None:
        self._channel, self._agent = channel, agent
        self._config, self._pool, self._paths = config, pool, paths
        self._start_s = start_s
        self._memory_mb, self._disk_mb = memory_mb, disk_mb
        self._gpus = 0.0
        self.ahead = False
        self.policy: Policy | None = None

    def start(self) -> GuestInfo:
        """Start the agent, and return its description.

        Raises:
            Unreachable, AgentError, IsolationError: as `Guest.load`.
        """
        channel, agent = self._channel, self._agent
        digest = agent.sha256
        if idle := self._pool.take(self._key(digest)):
            channel.open(idle.process)
            channel.loaded, self.ahead = True, idle.ahead
            self.policy = idle.process.policy
            return idle.info
        isolation = self._connect() if agent.elsewhere else self._start_process()
        try:
            ready = channel.receive(self._start_s)[0]
        except GuestFault as fault:
            kind = AgentKilled if fault.kind == KILLED else AgentError
            hint = _ONE_PROGRAM if agent.words and _REFUSED in fault.log.lower() else ""
            raise kind(f"{agent.text}: loading it failed ({fault}).{hint}\n{fault.log}".rstrip()) from None
        if not isinstance(ready, wire.Ready):
            channel.close()
            said = _instead(agent, ready)
            why = isolation_reason(said, self.policy, agent.root) if self.policy else ""
            raise AgentError(f"{said}\n{why}".rstrip())
        try:
            known = info.make_info(agent, digest, ready, isolation)
        except AgentError:
            channel.close()
            raise
        if known.gpus and not self._gpus and not agent.elsewhere:  # start again, with the GPUs that it needs
            channel.close()
            self._gpus = known.gpus
            return self.start()
        channel.loaded, self.ahead = True, ready.ahead
        return known

    def leave_idle(self, info: GuestInfo) -> bool:
        """Leave the guest, which has no trial, in the pool, or a program that connected at its connection.

        Returns:
            False when it must be ended instead.
        """
        process = self._channel.transport
        if process is not None and self._agent.form == SOCKET:
            self._channel.release()
            return True
        if not isinstance(process, GuestProcess):
            return False
        idle = IdleGuest(process=process, info=info, ahead=self.ahead)
        if left := self._pool.put(self._key(info.sha256), idle):
            self._channel.release()
        return left

    def _key(self, digest: str) -> Key:
        """Everything that two guests must share to be interchangeable."""
        config = self._config
        limits = config.isolation, config.hidden, self._memory_mb, self._disk_mb
        return self._agent.text, digest, *limits, tuple(config.inputs.args.items()), self._paths.readable

    def _connect(self) -> Isolation:
        agent, programs = self._agent, self._config.programs
        if agent.url:
            self._channel.open(websocket_client.connect(agent.url, self._start_s))
        elif programs is not None:
            self._channel.open(programs.take(agent.text, self._start_s))
        else:
            raise AgentError(
                f"agent '{agent.text}' is a program that connects to a session of 'hthor live'. Here, let hthor start "
                "it (cmd:PROGRAM ARGS) or connect to it (ws://HOST:PORT)."
            )
        return websocket_client.ISOLATION

    def _start_process(self) -> Isolation:
        """Start its process at the requested level, or the strongest that starts; returns how it is confined.

        Raises:
            IsolationError: when the level does not start.
        """
        level, unavailable = self._config.isolation, self._pool.unavailable
        ladder = tuple(reversed(LEVELS)) if level == AUTO else (level,)
        not_higher = "" if level in (AUTO, LEVELS[-1]) else f"{level} was asked for"
        reason = ""
        for rung in ladder:
            reason = unavailable.get(rung) or (namespaces.unavailable() if rung == "L3" else "")
            if not reason:
                try:
                    started = process.start_process(
                        self._agent,
                        rung,
                        hidden=self._config.hidden,
                        memory_mb=self._memory_mb,
                        disk_mb=self._disk_mb,
                        gpus=self._gpus > 0.0,
                        readable=self._paths.readable,
                    )
                except OSError as error:  # such as too many files next to the agent to list one by one
                    place = f": {error.filename}" if error.filename else ""
                    reason = f"its process could not be started: {error.strerror}{place}"
                    not_higher = not_higher or f"{rung}: {reason}"
                    continue
                answer = self._enter(started)
                if isinstance(answer, wire.Confined):
                    return self._describe(rung, answer, not_higher)
                reason = namespaces.failure_reason(answer) if rung == "L3" else answer
            unavailable[rung] = reason
            not_higher = not_higher or f"{rung}: {reason}"
        raise IsolationError(f"isolation {level} is not available on this machine: {reason}. {_HINT}")

    def _describe(self, level: str, confined: wire.Confined, not_higher: str) -> Isolation:
        here = {name: os.readlink(f"/proc/self/ns/{name}") for name in confined.spaces}
        return Isolation(
            level=level,
            landlock_abi=confined.landlock_abi,
            seccomp=confined.seccomp,
            netns=bool(here) and confined.spaces["net"] != here["net"],
            pidns=bool(here) and confined.spaces["pid"] != here["pid"],
            memory=f"{self._memory_mb} MB, by limit and watch",
            reason_not_higher=not_higher,
        )

    def _enter(self, started: GuestProcess) -> wire.Confined | str:
        """How a process that has just started is confined, or the reason why it is not."""
        self._channel.open(started)
        self.policy = started.policy
        agent, args = self._agent, self._config.inputs.arguments(self._agent)
        load = wire.Load(
            path=agent.path,
            cls=agent.cls,
            policy=started.policy,
            module=agent.module,
            words=(*agent.words, *inputs.as_options(args)) if agent.words else (),
            root=agent.root,
            args=args,
            paths=self._paths,
        )
        try:
            self._channel.send(load, _ENTER_S)
            said, _ = self._channel.receive(_ENTER_S)
        except GuestFault as fault:
            if fault.kind == KILLED:  # does not show what this machine supports
                raise AgentKilled(f"{agent.text}: its process was {fault.detail} while it started.") from None
            return fault.log.strip() or str(fault)
        if isinstance(said, wire.Confined):
            return said
        self._channel.close()
        return said.detail if isinstance(said, wire.Failed) else f"unexpected {type(said).__name__}"


def _instead(agent: AgentReference, said: object) -> str:
    """Describe the message that came instead of the agent's description of itself."""
    if isinstance(said, wire.Failed):
        return sanitize_text(said.detail)
    if isinstance(said, wire.Over):
        return f"{agent.text}: its process ended before it had said what it is."
    return f"{agent.text}: it said {type(said).__name__} before it had said what it is."
