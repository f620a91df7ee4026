"""A Python agent served over WebSocket, for evaluations elsewhere.

Every connection gets agents of its own, but all of them share this process. Nothing is held here: whoever serves an
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
from hthor.guest.agent import agent_files, agent_paths, arguments, reference
from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.client import loading
from hthor.guest.client.agent_loop import play
from hthor.guest.client.file_recorder import Recorder
from hthor.guest.client.remote_senses import Gone
from hthor.guest.confinement import Policy
from hthor.guest.protocol import wire
from hthor.guest.protocol.shared_frames import View
from hthor.guest.protocol.websocket_library import load_websockets

if TYPE_CHECKING:
    from websockets.sync.server import Server, ServerConnection

_hosts_words = msgspec.msgpack.Decoder(wire.ToGuest)
_NO_POLICY = Policy(level="", read=(), listed=(), scratch="", memory_mb=0, disk_mb=0)


class Socket:
    """The guest's end of a connection."""

    view: View | None = None

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection

    def receive(self) -> wire.ToGuest:
        """The host's next message."""
        try:
            message: wire.ToGuest = _hosts_words.decode(self._connection.recv(decode=False))
        except msgspec.DecodeError as error:
            raise Gone(str(error)) from None
        except load_websockets().exceptions.ConnectionClosed:
            raise Gone("the connection was closed") from None
        return message

    def send(self, message: wire.ToHost) -> None:
        """Say something to the host, unless it is gone."""
        with contextlib.suppress(load_websockets().exceptions.ConnectionClosed):
            self._connection.send(wire.encode(message))

    def fail(self) -> NoReturn:
        """The host does not keep to the wire."""
        raise Gone("not what was asked for")


def serve(text: str, host: str, port: int, given: AgentInputs | None = None) -> Server:
    """A server that is ready to serve an agent; call its ``serve_forever``.

    Args:
        text: the agent, a Python file or module. port: 0 for any that is free. given: its arguments, and files beyond
            its own folder that count as its own.

    Raises:
        UnknownName, AgentError: when it is no such agent, or cannot be loaded.
        OSError: when the port cannot be had.
    """
    agent = reference.read(text)
    if agent.form not in ("file", "module"):
        raise UnknownName("agent to serve", text, reference.FORMS[:3], "Only Python agents are served.")
    sockets = load_websockets()
    version, more = agent.sha256, given or AgentInputs()
    ground = agent_paths.of(agent, more.beyond(agent))
    sys.path.insert(0, agent.root)
    loading.only_from(ground)
    recorder = Recorder(ground)
    recorder.start()
    try:
        order = wire.Load(
            path=agent.path,
            cls=agent.cls,
            policy=_NO_POLICY,
            module=agent.module,
            root=agent.root,
            args=more.args,
            grounds=ground,
        )
        cls, ready = loading.load(order)
    except loading.Refusal as error:
        raise AgentError(str(error)) from None
    ready = msgspec.structs.replace(ready, name=agent.name, version=version, persistent=True)

    opened = recorder.take()
    make = arguments.maker(cls, more.args)

    def talk(connection: ServerConnection) -> None:
        files = agent_files.files_of(agent, more, ground, opened)
        _converse(Socket(connection), make, msgspec.structs.replace(ready, manifest=files))

    quiet = logging.getLogger("hthor.guest.client.websocket_server")
    quiet.addHandler(logging.NullHandler())
    quiet.propagate = False
    server: Server = sockets.sync.server.serve(
        talk, host, port, compression=None, ping_interval=None, max_size=None, logger=quiet
    )
    return server


def address(server: Server) -> str:
    """Where a server can be reached."""
    host, port = server.socket.getsockname()[:2]
    return f"ws://{host}:{port}"


def _converse(socket: Socket, make: Callable[[], Any], ready: wire.Ready) -> None:
    socket.send(ready)
    with contextlib.suppress(Gone):
        while isinstance(begin := socket.receive(), wire.Begin):
            play(socket, make, begin)
