"""How a submitted agent comes up: a process at some level, or a connection."""

from __future__ import annotations

from hthor.errors import KILLED, AgentError, AgentKilled
from hthor.guest.agent import arguments
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.agent.reference import AgentReference
from hthor.guest.confinement import Isolation, Policy
from hthor.guest.host import failure_explanation, info, isolation_level, process, websocket_client
from hthor.guest.host.channel import GuestFault, MessageChannel
from hthor.guest.host.config import GuestConfig
from hthor.guest.host.guest_pool import GuestPool, IdleGuest, Key
from hthor.guest.host.info import GuestInfo
from hthor.guest.host.process import GuestProcess
from hthor.guest.protocol import wire
from hthor.guest.protocol.sanitize import sanitize_text

_ENTER_S = 120.0
"""Seconds until a process must say what holds it: the start of an interpreter, and the libraries an agent names."""

_REFUSED = "operation not permitted"
_ONE_PROGRAM = (
    " A held program may start no other: name the one that runs in the end, such as an interpreter itself instead of "
    "a script that calls it."
)


class GuestStartup:
    """Brings an agent up, and up again after it has failed. The arguments are those of `Guest`."""

    def __init__(
        self,
        talk: MessageChannel,
        agent: AgentReference,
        *,
        config: GuestConfig,
        pool: GuestPool,
        start_s: float,
        memory_mb: int,
        disk_mb: int,
        grounds: AgentPaths,
    ) -> None:
        self._talk, self._agent = talk, agent
        self._config, self._pool, self._grounds = config, pool, grounds
        self._start_s = start_s
        self._memory_mb, self._disk_mb = memory_mb, disk_mb
        self._gpus = 0.0
        self.ahead = False
        self.policy: Policy | None = None

    def come(self) -> GuestInfo:
        """Bring it up, and say what it is; ``ahead`` is then what it says of itself.

        Raises:
            Unreachable, AgentError, IsolationError: as `Guest.load`.
        """
        talk, agent = self._talk, self._agent
        digest = agent.sha256
        if waiting := self._pool.take(self._key(digest)):
            talk.open(waiting.process)
            talk.loaded, self.ahead = True, waiting.ahead
            self.policy = waiting.process.policy
            return waiting.info
        held = self._connected() if agent.url else self._started()
        try:
            ready = talk.receive(self._start_s)[0]
        except GuestFault as fault:
            kind = AgentKilled if fault.kind == KILLED else AgentError
            hint = _ONE_PROGRAM if agent.words and _REFUSED in fault.log.lower() else ""
            raise kind(f"{agent.text}: loading it failed ({fault}).{hint}\n{fault.log}".rstrip()) from None
        if not isinstance(ready, wire.Ready):
            talk.close()
            said = _instead(agent, ready)
            why = failure_explanation.isolation_reason(said, self.policy, agent.root) if self.policy else ""
            raise AgentError(f"{said}\n{why}".rstrip())
        try:
            found = info.make_info(agent, digest, ready, held)
        except AgentError:
            talk.close()
            raise
        if found.gpus and not self._gpus and not agent.url:  # once more, with what it asks for
            talk.close()
            self._gpus = found.gpus
            return self.come()
        talk.loaded, self.ahead = True, ready.ahead
        return found

    def leave(self, found: GuestInfo) -> bool:
        """Let the guest, which has no trial, wait for whoever wants the same; false when it is to end."""
        line = self._talk.line
        if not isinstance(line, GuestProcess):
            return False
        waiting = IdleGuest(process=line, info=found, ahead=self.ahead)
        if left := self._pool.put(self._key(found.sha256), waiting):
            self._talk.release()
        return left

    def _key(self, digest: str) -> Key:
        """What two guests must share to be exchangeable."""
        config = self._config
        limits = config.isolation, config.hidden, self._memory_mb, self._disk_mb
        return self._agent.text, digest, *limits, tuple(config.inputs.args.items()), self._grounds.readable

    def _connected(self) -> Isolation:
        self._talk.open(websocket_client.connect(self._agent.url, self._start_s))
        return websocket_client.ISOLATION

    def _started(self) -> Isolation:
        """Start its process, at the level that is wanted or the strongest that comes up."""
        return isolation_level.start_at_level(
            self._config.isolation, self._launch, self._enter, self._pool.unavailable, self._memory_mb
        )

    def _launch(self, level: str) -> GuestProcess:
        return process.start_process(
            self._agent,
            level,
            hidden=self._config.hidden,
            memory_mb=self._memory_mb,
            disk_mb=self._disk_mb,
            gpus=self._gpus > 0.0,
            readable=self._grounds.readable,
        )

    def _enter(self, started: GuestProcess) -> wire.Confined | str:
        """What a process that has just started says of its confinement, or why it has none."""
        self._talk.open(started)
        self.policy = started.policy
        agent, args = self._agent, self._config.inputs.args
        load = wire.Load(
            path=agent.path,
            cls=agent.cls,
            policy=started.policy,
            module=agent.module,
            words=(*agent.words, *arguments.as_options(args)) if agent.words else (),
            root=agent.root,
            args=args,
            grounds=self._grounds,
        )
        try:
            self._talk.send(load, _ENTER_S)
            said, _ = self._talk.receive(_ENTER_S)
        except GuestFault as fault:
            if fault.kind == KILLED:  # which says nothing about what this machine can do
                raise AgentKilled(f"{agent.text}: its process was {fault.detail} while it started.") from None
            return fault.log.strip() or str(fault)
        if isinstance(said, wire.Confined):
            return said
        self._talk.close()
        return said.detail if isinstance(said, wire.Failed) else f"unexpected {type(said).__name__}"


def _instead(agent: AgentReference, said: object) -> str:
    """What came in place of what an agent says of itself."""
    if isinstance(said, wire.Failed):
        return sanitize_text(said.detail)
    if isinstance(said, wire.Over):
        return f"{agent.text}: its process ended before it had said what it is."
    return f"{agent.text}: it said {type(said).__name__} before it had said what it is."
