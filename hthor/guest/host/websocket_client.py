"""The connection to an agent that is served over WebSocket.

Each message is one binary WebSocket message, without a length in front. How the agent is confined there is unknown,
so its isolation is "served", which counts as less than any level.
"""

from __future__ import annotations

import contextlib
import math
import socket
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from hthor.errors import AgentError
from hthor.guest.confinement import SERVED, Isolation
from hthor.guest.host.channel import DeadlinePassed, PeerGone
from hthor.guest.protocol import load_websockets

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

ISOLATION = Isolation(level=SERVED, reason_not_higher="it is served from elsewhere, where hthor cannot confine it")
_CLOSING_S = 2.0
"""Longest time for a clean close."""
_LOOK_S = 0.25
_TOO_BIG = 1009


class Unreachable(AgentError):
    """No server answers at an agent's address, or a program that connected has not come back."""


def connect(url: str, seconds: float) -> WebSocketTransport:
    """Connect to the agent at this address.

    Raises:
        Unreachable: when nothing answers there, or it is not a WebSocket server.
    """
    from hthor.guest.protocol.wire import MOST_BYTES

    sockets, parts = load_websockets(), urlsplit(url)
    hint = "Is it running? hthor agent serve my_agent.py --port PORT"
    try:
        near = socket.create_connection((parts.hostname, parts.port), timeout=seconds)
        near.settimeout(None)
        return WebSocketTransport(
            sockets.sync.client.connect(
                url,
                sock=near,  # given a socket, the library follows no redirection
                open_timeout=seconds,
                close_timeout=1.0,
                ping_interval=None,
                compression=None,
                proxy=None,
                max_size=MOST_BYTES,
                max_queue=4,
            )
        )
    except (OSError, ValueError, sockets.exceptions.WebSocketException) as error:
        words = str(error).strip() or type(error).__name__
        if isinstance(error, ValueError) and "redirect" in words:
            words, hint = "it says that the agent is elsewhere", "Give the address itself."
        raise Unreachable(f"cannot reach the agent at {url}: {words}. {hint}") from None


class DeadlineTimer:
    """Calls ``ring`` once when a deadline has passed; a separate thread checks the time.

    So a deadline holds even if a server makes the WebSocket library wait while it keeps its locks.
    """

    def __init__(self, ring: Callable[[], None]) -> None:
        self._ring, self._stopped = ring, threading.Event()
        self._end = math.inf
        threading.Thread(target=self._look, daemon=True).start()

    def set(self, end: float = math.inf) -> None:
        """Set the deadline on the monotonic clock; none by default."""
        self._end = end

    def stop(self) -> None:
        """Stop: ``ring`` is not called any more."""
        self._stopped.set()

    def _look(self) -> None:
        while not self._stopped.wait(_LOOK_S):
            if time.monotonic() > self._end:
                self._ring()
                return


class WebSocketTransport:
    """A connection to a served agent."""

    log = ""
    pid = 0

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection.__enter__()
        self._late = False
        self._end = ""
        self._alarm = DeadlineTimer(self._hang_up)

    def write(self, body: bytes, end: float) -> None:
        """As `Transport` says."""
        self._alarm.set(end)
        try:
            self._connection.send(body)
        except (OSError, load_websockets().exceptions.ConnectionClosed) as error:
            self._end = str(error)
            raise (DeadlinePassed if self._late else PeerGone) from None
        finally:
            self._alarm.set()

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """As `Transport` says; there is no supervisor here."""
        self._alarm.set(end + _LOOK_S)
        try:
            body = self._connection.recv(timeout=max(0.0, end - time.monotonic()), decode=False)
        except TimeoutError:
            raise DeadlinePassed from None
        except load_websockets().exceptions.ConnectionClosed as error:
            if self._late:
                raise DeadlinePassed from None
            if error.sent is not None and error.sent.code == _TOO_BIG:
                return False, most + 1
            self._end = str(error)
            raise PeerGone from None
        finally:
            self._alarm.set()
        return False, body

    def end_reason(self) -> tuple[str, str]:
        """As `Transport` says."""
        return "died", f"the server closed the connection: {self._end or 'without a word'}"

    def kill(self) -> None:
        """Close the connection; the server goes on."""
        self._alarm.set(time.monotonic() + _CLOSING_S)
        with contextlib.suppress(Exception):
            self._connection.__exit__(None, None, None)
        self._alarm.stop()

    def _hang_up(self) -> None:
        self._late = True
        with contextlib.suppress(OSError):
            self._connection.socket.shutdown(socket.SHUT_RDWR)
