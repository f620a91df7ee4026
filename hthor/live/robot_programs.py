"""Robots over sockets: programs that connect to a live session and speak the wire of docs/wire.md.

Two threads meet in a `RobotProgram`: the server's thread puts in what the program sends, and the trial's thread reads
it and writes, as a `hthor.guest.host.channel.Transport`.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Coroutine, Mapping, Sequence
from concurrent import futures
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any

import msgspec

from hthor.errors import AgentError, HthorError
from hthor.guest import Unreachable
from hthor.guest.agent.reference import parse_reference
from hthor.guest.host import websocket_client
from hthor.guest.host.channel import DeadlinePassed, PeerGone
from hthor.guest.host.info import make_info
from hthor.guest.protocol.wire import MOST_BYTES, Ready

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from hthor.trials.robot_team import RobotTeam

PROTOCOL = "hthor.wire"
"""The sub-protocol that a program offers, besides the token of its robot.

A token in a sub-protocol needs nothing that a WebSocket library may lack: not every one can set headers, as those of
browsers and Node.js. Unlike a part of the address it is not in the logs of servers on the way.
"""
_READY_S = 60.0
"""[s] A program that has not said what it is by then is refused, as in docs/wire.md."""
_TURN_S = 0.05
"""[s] How often somebody who waits for a program looks whether the session goes on. Our choice."""
_CLOSING_S = 1.0
"""[s] The end of a session waits this long at most until programs have been told of it. Our choice."""
_UNREAD = 8
"""[count] Messages that may wait to be read; a program that keeps to the order of messages has one. Our choice."""
_TOO_BIG, _REFUSED, _GOING_AWAY = 1009, 1008, 1001
_REASON = 123
"""[bytes] The longest reason for which a WebSocket is closed, by RFC 6455."""
_LOG = logging.getLogger("hthor.live")
_decode_ready = msgspec.msgpack.Decoder(Ready).decode


class RobotProgram:
    """The connection of a program that has said what it is; a `hthor.guest.host.channel.Transport`.

    Args:
        ready: its first message.
    """

    log = ""
    pid = 0

    def __init__(self, socket: WebSocket, loop: asyncio.AbstractEventLoop, ready: bytes) -> None:
        self._socket, self._loop, self._ready = socket, loop, ready
        self._changed = threading.Condition()
        self._inbox: deque[bytes] = deque()
        self._rewound = True
        self._end: tuple[str, str] | None = None

    # ----------------------------------------------------------------------------------------- from the server's thread

    def put(self, body: bytes) -> bool:
        """Take a message of the program; False when the connection has ended, or ends with it."""
        with self._changed:
            if self._end is None and len(self._inbox) >= _UNREAD:
                self._end = "garbage", f"it sent more than {_UNREAD} messages before one of them was asked for"
            if self._end is None:
                self._inbox.append(body)
            self._changed.notify_all()
            return self._end is None

    def end(self, code: int, reason: str) -> None:
        """The program has closed the connection, or it broke."""
        with self._changed:
            if self._end is None and code == _TOO_BIG:
                self._end = "oversized", f"a message of more than {MOST_BYTES} bytes, which are accepted at most"
            self._end = self._end or ("died", f"the program closed the connection: {reason or 'without a word'}")
            self._changed.notify_all()

    # ------------------------------------------------------------------------------------------ from the trial's thread

    @property
    def lives(self) -> bool:
        """Whether the connection still stands."""
        with self._changed:
            return self._end is None

    def rewind(self) -> None:
        """Let its ``ready`` be read first, by whoever uses the connection from now on."""
        with self._changed:
            self._rewound = True

    def write(self, body: bytes, end: float) -> None:
        """As `Transport` says."""
        if not self.lives:
            raise PeerGone
        future = self._in_server(self._socket.send_bytes(body))
        if future is None:
            raise PeerGone
        try:
            future.result(max(0.0, end - time.monotonic()))
        except TimeoutError:
            future.cancel()
            raise DeadlinePassed from None
        except Exception:  # Starlette and uvicorn have an error each for a connection that is gone
            raise PeerGone from None

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        """As `Transport` says; there is no supervisor here."""
        with self._changed:
            if self._rewound:
                self._rewound = False
                return False, self._ready
            while not self._inbox and self._end is None:
                if not self._changed.wait(max(0.0, end - time.monotonic())) and time.monotonic() >= end:
                    raise DeadlinePassed
            if self._inbox:
                body = self._inbox.popleft()
                return False, body if len(body) <= most else len(body)
            raise PeerGone

    def end_reason(self) -> tuple[str, str]:
        """As `Transport` says."""
        with self._changed:
            return self._end or ("died", "the server of the session has ended")

    def kill(self) -> None:
        """Close the connection; the program may connect again."""
        self.close(_REFUSED, "it failed, and the trial goes on without it; the run's log says why")

    def close(self, code: int, reason: str) -> Future[None] | None:
        """Begin to close the connection; None when it has ended."""
        with self._changed:
            lived, self._end = self._end is None, self._end or ("died", f"the connection was closed: {reason}")
            self._changed.notify_all()
        return self._in_server(self._socket.close(code, reason)) if lived else None

    def _in_server(self, work: Coroutine[Any, Any, None]) -> Future[None] | None:
        """Begin something in the server's thread; None when the server has ended."""
        try:
            return asyncio.run_coroutine_threadsafe(work, self._loop)
        except RuntimeError:
            work.close()
            return None


class _Place:
    """The place of one robot's program."""

    def __init__(self, agent: str, token: str) -> None:
        self.agent, self.token = agent, token
        self.ready: Ready | None = None  # of the first program; the session's robot is what it says
        self.program: RobotProgram | None = None
        self.left_at: float | None = None  # None before the first program has left


class _Refused(Exception):
    """A connection that is not taken; the message says why."""


class RobotPrograms:
    """The programs of the robots of a live session; `hthor.guest.host.connected_programs.ConnectedPrograms`.

    Args:
        tokens: of each agent that is a program which connects, by its word.
        tell: called with a sentence when the session waits for a program.
        wait: waits so many seconds; raises when the session is to end.
    """

    def __init__(
        self,
        tokens: Mapping[str, str] | None = None,
        *,
        tell: Callable[[str], None] = lambda _: None,
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        self._places = {agent: _Place(agent, token) for agent, token in (tokens or {}).items()}
        self._tell, self._wait = tell, wait
        self._lock = threading.Lock()

    @property
    def tokens(self) -> dict[str, str]:
        """The token of each program, by its agent's word."""
        return {agent: place.token for agent, place in self._places.items()}

    def check_team(self, team: RobotTeam) -> None:
        """Check that no program has two robots; raises HthorError when one has."""
        words = list(team.agent_paths.values())
        if twice := [agent for agent in self._places if words.count(agent) > 1]:
            raise HthorError(
                f"'{twice[0]}' is one program, but several robots have it as their agent. Name one for each, such as "
                "--robots tall:socket:one,small:socket:two."
            )

    def take(self, agent: str, seconds: float) -> RobotProgram:
        """As `ConnectedPrograms` says; raises what ``wait`` raises, too."""
        place, told = self._places[agent], False
        while True:
            with self._lock:
                program, left_at = place.program, place.left_at
            if program is not None and program.lives:
                program.rewind()
                return program
            if program is None and left_at is not None and time.monotonic() - left_at > seconds:
                raise Unreachable(f"{agent}: its program left, and did not connect again within {seconds:g} s")
            if not told:
                self._tell(f"{agent}: waiting for its program to connect")
                told = True
            self._wait(_TURN_S)

    def close(self) -> None:
        """The session is over. Programs hear it before the server ends, which would tell them that it starts again."""
        programs = [place.program for place in self._places.values() if place.program is not None]
        begun = [program.close(_GOING_AWAY, "the session is over") for program in programs]
        futures.wait([closing for closing in begun if closing is not None], _CLOSING_S)

    # ----------------------------------------------------------------------------------------- from the server's thread

    async def connect(self, socket: WebSocket) -> None:
        """Let a program take its place, and listen to it until it leaves."""
        offered = socket.scope.get("subprotocols", [])
        await socket.accept(PROTOCOL if PROTOCOL in offered else None)
        try:
            place = self._place(offered)
            program = await self._join(socket, place)
        except _Refused as refused:
            _LOG.warning("refused a program: %s", _printable(str(refused), 1000))
            with contextlib.suppress(Exception):
                await socket.close(_REFUSED, _short(str(refused)))
            return
        code, reason = _GOING_AWAY, ""
        try:
            while (received := await socket.receive())["type"] == "websocket.receive":
                body = received.get("bytes")
                if not program.put(body if body is not None else (received.get("text") or "").encode()):
                    break
            code, reason = received.get("code", code), received.get("reason") or ""
        finally:
            program.end(code, reason)
            with self._lock:
                if place.program is program:
                    place.program, place.left_at = None, time.monotonic()
        with contextlib.suppress(Exception):
            await socket.close(_REFUSED, _short(program.end_reason()[1]))

    def _place(self, offered: Sequence[str]) -> _Place:
        if PROTOCOL not in offered:
            raise _Refused(f"offer two sub-protocols, {PROTOCOL} and the token behind the # of the robot's address")
        for place in self._places.values():
            if any(secrets.compare_digest(place.token.encode(), _bytes(word)) for word in offered):
                return place
        raise _Refused("its token belongs to no robot of this session; give it the address that hthor printed")

    async def _join(self, socket: WebSocket, place: _Place) -> RobotProgram:
        """Take a program's first message, and let it have the place."""
        self._check_free(place)
        try:
            first = await asyncio.wait_for(socket.receive(), _READY_S)
        except TimeoutError:
            raise _Refused(f"it did not send `ready` within {_READY_S:g} s") from None
        body = first.get("bytes") or b""
        try:
            ready = _decode_ready(body)
            make_info(parse_reference(place.agent), "", ready, websocket_client.ISOLATION)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise _Refused(f"its first message must be `ready`, in MessagePack: {error}") from None
        except AgentError as error:
            raise _Refused(str(error).removeprefix(f"{place.agent}: ")) from None
        if ready.absent:
            raise _Refused("it says that there is no robot (`absent`), but it is the program of one")
        program = RobotProgram(socket, asyncio.get_running_loop(), body)
        with self._lock:
            self._check_free(place)
            if ready != (place.ready or ready):
                raise _Refused("its `ready` is not that of the program with which the session began")
            place.program, place.ready = program, ready
        return program

    def _check_free(self, place: _Place) -> None:
        if place.program is not None and place.program.lives:
            raise _Refused(f"another program is connected as {place.agent}")


def _bytes(word: str) -> bytes:
    return word.encode("utf-8", "surrogateescape")


def _printable(text: str, most: int) -> str:
    """A text with parts from outside, as it may stand in a line of a log."""
    return "".join(one if one.isprintable() else "?" for one in text[:most])


def _short(text: str) -> str:
    """As much of a text as fits into the reason for which a WebSocket is closed."""
    data = _printable(text, _REASON).encode()
    if len(data) <= _REASON and len(text) <= _REASON:
        return data.decode()
    return data[: _REASON - 3].decode(errors="ignore") + "..."
