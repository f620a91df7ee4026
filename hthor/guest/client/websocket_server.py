"""Serves a Python agent over WebSocket, for evaluations elsewhere; runs in the process of ``hthor agent serve``.

Every connection gets its own agents, but all share this process. Nothing is confined here: a user who serves an
agent trusts it.
"""

from __future__ import annotations

import contextlib
import logging
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NoReturn

import msgspec

from hthor.errors import AgentError, UnknownName
from hthor.guest.agent import agent_files, agent_paths, inputs, reference
from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.client import loading
from hthor.guest.client.agent_loop import run_trial
from hthor.guest.client.file_recorder import FileRecorder
from hthor.guest.client.remote_senses import HostGone
from hthor.guest.confinement import Policy
from hthor.guest.protocol import load_websockets, wire
from hthor.guest.protocol.shared_frames import FrameReader

if TYPE_CHECKING:
    from websockets.sync.server import Server, ServerConnection

_hosts_words = msgspec.msgpack.Decoder(wire.ToGuest)
_NO_POLICY = Policy(level="", read=(), listed=(), scratch="", memory_mb=0, disk_mb=0)


class WebSocketConnection:
    """The guest's end of a connection."""

    view: FrameReader | None = None

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection

    def receive(self) -> wire.ToGuest:
        """The host's next message."""
        try:
            message: wire.ToGuest = _hosts_words.decode(self._connection.recv(decode=False))
        except msgspec.DecodeError as error:
            raise HostGone(str(error)) from None
        except load_websockets().exceptions.ConnectionClosed:
            raise HostGone("the connection was closed") from None
        return message

    def send(self, message: wire.ToHost) -> None:
        """Send a message, unless the host has gone."""
        with contextlib.suppress(load_websockets().exceptions.ConnectionClosed):
            self._connection.send(wire.encode(message))

    def fail(self) -> NoReturn:
        """The host has broken the protocol."""
        raise HostGone("the host sent an unexpected message")


def serve(text: str, host: str, port: int, given: AgentInputs | None = None) -> Server:
    """A server for an agent; call its ``serve_forever``.

    Args:
        text: the agent, a Python file or module. port: 0 for any free port.
        given: its arguments, and files outside its folder that count as its own.

    Raises:
        UnknownName, AgentError: when it is not a Python agent, or cannot be loaded.
        OSError: when the port is not available.
    """
    agent = reference.parse_reference(text)
    if agent.form not in ("file", "module"):
        raise UnknownName("agent to serve", text, reference.FORMS[:3], "Only Python agents are served.")
    sockets = load_websockets()
    version, more = agent.sha256, given or AgentInputs()
    ground = agent_paths.find_agent_paths(agent, more.extra_paths(agent))
    sys.path.insert(0, agent.root)
    loading.import_from_sources(ground)
    recorder = FileRecorder(ground)
    recorder.start()
    try:
        order = wire.Load(
            path=agent.path,
            cls=agent.cls,
            policy=_NO_POLICY,
            module=agent.module,
            root=agent.root,
            args=more.arguments(agent),
            paths=ground,
        )
        cls, ready = loading.load_agent(order)
    except loading.ContractViolation as error:
        raise AgentError(str(error)) from None
    ready = msgspec.structs.replace(ready, name=agent.name, version=version, persistent=True)

    opened = recorder.take()
    make = inputs.make_factory(cls, more.arguments(agent))

    def talk(connection: ServerConnection) -> None:
        files = agent_files.list_files(agent, more, ground, opened)
        _converse(WebSocketConnection(connection), make, msgspec.structs.replace(ready, manifest=files))

    quiet = logging.getLogger("hthor.guest.client.websocket_server")
    quiet.addHandler(logging.NullHandler())
    quiet.propagate = False
    server: Server = sockets.sync.server.serve(
        talk, host, port, compression=None, ping_interval=None, max_size=None, logger=quiet
    )
    return server


def address(server: Server) -> str:
    """The address of a server."""
    host, port = server.socket.getsockname()[:2]
    return f"ws://{host}:{port}"


def _converse(socket: WebSocketConnection, make: Callable[[], Any], ready: wire.Ready) -> None:
    socket.send(ready)
    with contextlib.suppress(HostGone):
        while isinstance(begin := socket.receive(), wire.Begin):
            run_trial(socket, make, begin)
