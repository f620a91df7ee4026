"""The line to an agent that somebody serves over WebSocket; knows nothing of what is said on it.

One message of the wire is one binary message of the WebSocket, without a length in front. What holds the agent there
is not known here, so its isolation is "served", which is less than any level.
"""

from __future__ import annotations

import contextlib
import fcntl
import sys
import termios
import threading
import time
from typing import TYPE_CHECKING, Any

from hthor.errors import AgentError, MissingExtra
from hthor.guest.confinement import SERVED, Isolation
from hthor.guest.lines import HungUp, TimeIsUp

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

ISOLATION = Isolation(level=SERVED, reason_not_higher="it is served from elsewhere, where nothing of ours holds it")
_AT_ONCE = 16 << 10
"""Bytes that a connection takes without waiting for its other end, if that has taken all before."""
_TOO_BIG = 1009
EXTRA = "served"


class Unreachable(AgentError):
    """No server answers at an agent's address."""


def library() -> Any:
    """The library that speaks WebSocket.

    Raises:
        MissingExtra: when it is not installed.
    """
    try:
        import websockets.sync.client
        import websockets.sync.server
    except ImportError:
        raise MissingExtra("an agent that is served", EXTRA) from None
    return websockets


def connect(url: str, seconds: float) -> Served:
    """A line to the agent at this address.

    Raises:
        Unreachable: when nothing answers there, or it is no WebSocket server.
    """
    from hthor.guest.wire import MOST_BYTES

    sockets = library()
    try:
        return Served(
            sockets.sync.client.connect(
                url,
                open_timeout=seconds,
                close_timeout=1.0,
                ping_interval=None,
                compression=None,
                proxy=None,
                max_size=MOST_BYTES,
                max_queue=4,
            )
        )
    except (OSError, sockets.exceptions.WebSocketException) as error:
        words = str(error).strip() or type(error).__name__
        hint = "Is it running? hthor agent serve my_agent.py --port PORT"
        raise Unreachable(f"cannot reach the agent at {url}: {words}. {hint}") from None


class Served:
    """A connection to a served agent."""

    log = ""
    pid = 0

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection.__enter__()
        self._late = False
        self._end = ""

    def write(self, body: bytes, end: float) -> None:
        """As `Line` says."""
        watch: threading.Timer | None = None
        if len(body) > _AT_ONCE or self._clogged():
            watch = threading.Timer(max(0.0, end - time.monotonic()), self._hang_up)
            watch.start()
        try:
            self._connection.send(body)
        except (OSError, library().exceptions.ConnectionClosed) as error:
            self._end = str(error)
            raise (TimeIsUp if self._late else HungUp) from None
        finally:
            if watch:
                watch.cancel()

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """As `Line` says; here is no keeper."""
        try:
            body = self._connection.recv(timeout=max(0.0, end - time.monotonic()), decode=False)
        except TimeoutError:
            raise TimeIsUp from None
        except library().exceptions.ConnectionClosed as error:
            if error.sent is not None and error.sent.code == _TOO_BIG:
                return False, most + 1
            self._end = str(error)
            raise HungUp from None
        return False, body

    def obituary(self) -> tuple[str, str]:
        """As `Line` says."""
        return "died", f"the server closed the connection: {self._end or 'without a word'}"

    def kill(self) -> None:
        """As `Line` says; the server goes on."""
        with contextlib.suppress(Exception):
            self._connection.__exit__(None, None, None)

    def _clogged(self) -> bool:
        """Whether the other end has not taken all that was sent before, or nobody can tell."""
        if sys.platform != "linux":
            return True
        with contextlib.suppress(OSError, ValueError):  # it is closed
            return any(fcntl.ioctl(self._connection.socket, termios.TIOCOUTQ, bytes(4)))
        return True

    def _hang_up(self) -> None:
        self._late = True
        with contextlib.suppress(OSError):
            self._connection.socket.shutdown(2)
