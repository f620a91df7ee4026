"""The server of a live session: pages, and one socket for each person, in a thread of its own."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
import socket
import threading
import time
from collections import deque
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hthor.errors import HthorError, MissingExtra
from hthor.guest.protocol.wire import MOST_BYTES
from hthor.live import desk_wire, own_pages, wire
from hthor.live.desk import Desk
from hthor.live.desk_wire import ToDesk
from hthor.live.own_pages import OwnPages
from hthor.live.robot_programs import RobotPrograms
from hthor.live.seat import LiveSeat
from hthor.live.wire import Malformed, ToPage

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.websockets import WebSocket

    from hthor.live.certificate import Certificate
    from hthor.live.gltf.house_file import HouseFile

FOLDER = Path(__file__).resolve().parent / "page"
"""The built page; its sources are in the folder web of the repository."""
PAGE, DESK_PAGE = "index.html", "experimenter.html"
DESK = "desk"
"""What the token of the experimenter's page belongs to."""
_LOG = logging.getLogger("hthor.live")
LOCAL_HOSTS = ("localhost", "127.0.0.1", "[::1]")
"""The names by which a browser on this machine reaches a server on it."""
_JOIN_S = 10.0
"""[s] A connection that has not joined a seat by then is closed. Our choice."""
_TOO_LARGE = 1009
"""The code of a connection that was closed because of a message of more than `MOST_BYTES`, by RFC 6455."""
_WAITING = 512
"""[count] Messages that may wait for a slow page before its connection is given up. Our choice."""
_HOUSES = 4
"""[count] Files of houses that are served: pages ask for that of their trial, and may be late. Our choice."""
_POLICY = (
    "default-src 'self'; connect-src 'self' blob:; img-src 'self' blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "Cross-Origin-Opener-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}


def check_built() -> None:
    """Raise HthorError unless there are pages to serve."""
    if not (FOLDER / PAGE).is_file():
        raise HthorError(
            "the page is not built: this is a clone of the repository, and 'make page' builds it there. An installed "
            "hthor has it."
        )


class Connection:
    """A page that has joined a seat: a queue that loses nothing, and one place for the newest frame."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._messages: deque[str | bytes] = deque()
        self._head: wire.FrameHead | None = None
        self._moved: dict[int, bytes] = {}
        self._lock = threading.Lock()
        self._news = asyncio.Event()
        self.overrun = False

    def send(self, message: ToPage | ToDesk) -> None:
        """Send a message."""
        self._put(wire.encode(message))

    def send_picture(self, message: int, jpeg: bytes) -> None:
        """Send the picture of a message."""
        self._put(wire.encode_picture(message, jpeg))

    def show(self, head: wire.FrameHead, moved: Mapping[int, bytes]) -> None:
        """Send a frame, unless a newer one comes first; what has moved is sent in any case."""
        with self._lock:
            self._head = head
            self._moved.update(moved)
        self._wake()

    async def next(self) -> list[str | bytes]:
        """What is to be sent next."""
        await self._news.wait()
        self._news.clear()
        ready: list[str | bytes] = []
        while self._messages:
            ready.append(self._messages.popleft())
        with self._lock:
            head, moved = self._head, self._moved
            self._head, self._moved = None, {}
        if head is not None:
            ready.append(wire.encode_frame(head, moved))
        return ready

    def _put(self, data: str | bytes) -> None:
        self._messages.append(data)
        self.overrun = self.overrun or len(self._messages) > _WAITING
        self._wake()

    def _wake(self) -> None:
        with contextlib.suppress(RuntimeError):  # the server is closed
            self._loop.call_soon_threadsafe(self._news.set)


class LiveServer:
    """Serves the pages of the people in these seats, from `start` to `close`.

    Args:
        desk: of the experimenter, whose page is served too.
        host, port: where to listen; port 0 takes any that is free.
        hosts: names and addresses by which browsers may reach the server, besides those of a browser on this machine.
        certificate: what the server shows of itself; with it every connection is encrypted.
        tokens: of each seat, and of `DESK`; made here by default.
        robots: the robots whose programs connect.

    Attributes:
        tokens: the token of each seat. own_pages: what people get at the end.
    """

    def __init__(
        self,
        seats: Mapping[str, LiveSeat],
        desk: Desk,
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        hosts: Collection[str] = (),
        tokens: Mapping[str, str] | None = None,
        certificate: Certificate | None = None,
        robots: RobotPrograms | None = None,
    ) -> None:
        self._seats, self._desk, self._robots = dict(seats), desk, robots or RobotPrograms()
        self._host, self._port, self._hosts = host, port, (*LOCAL_HOSTS, *hosts)
        given = tokens or {name: secrets.token_urlsafe(16) for name in (*seats, DESK)}
        self.tokens = {seat: given[seat] for seat in seats}
        self._desk_token = given[DESK]
        self._certificate = certificate
        self._scheme, self._usual_port = ("http", "80") if certificate is None else ("https", "443")
        self._page_files = {path.name: path for path in sorted(FOLDER.glob("*.*"))}
        self._houses: dict[str, bytes] = {}
        self.own_pages = OwnPages()
        self._server: Any = None
        self._thread: threading.Thread | None = None

    @property
    def address(self) -> str:
        """The address of the server for browsers on this machine, such as http://127.0.0.1:8765."""
        return self.address_at(LOCAL_HOSTS[1])

    def address_at(self, host: str) -> str:
        """The address of the server under one of its names."""
        return f"{self._scheme}://{host}:{self._port}"

    def url(self, seat: str, host: str = LOCAL_HOSTS[1]) -> str:
        """The address that the person in a seat opens. The token is behind a #, so that browsers do not send it."""
        return f"{self.address_at(host)}/#{self.tokens[seat]}"

    @property
    def desk_url(self) -> str:
        """The address of the experimenter's page, for a browser on this machine."""
        return self.desk_url_at(LOCAL_HOSTS[1])

    def desk_url_at(self, host: str) -> str:
        """The address of the experimenter's page under one of the server's names."""
        return f"{self.address_at(host)}/{DESK_PAGE}#{self._desk_token}"

    def robot_url(self, agent: str) -> str:
        """What the program of a robot is given; it connects to what is before the #, with what is behind it."""
        return f"{self.address.replace('http', 'ws', 1)}/robot#{self._robots.tokens[agent]}"

    def start(self, *, page: bool = True) -> None:
        """Begin to serve.

        Args:
            page: whether people come with browsers, which need the built page; other clients do not.

        Raises:
            HthorError: when the port is taken, the extra is missing, or the page was not built.
        """
        try:
            import uvicorn
        except ImportError:
            raise MissingExtra("a session with people", "live") from None
        if page:
            check_built()
        try:
            listener = socket.create_server((self._host, self._port))
        except OSError as error:
            raise HthorError(
                f"--port {self._port}: {error.strerror}. Choose another port, or 0 for any that is free."
            ) from None
        self._port = listener.getsockname()[1]
        config = uvicorn.Config(
            self.app(),
            log_level="warning",
            access_log=False,
            lifespan="off",
            ws="websockets-sansio",
            ws_max_size=max(wire.LARGEST, MOST_BYTES),
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=1,
            ssl_certfile=None if self._certificate is None else str(self._certificate.path),
        )
        logging.getLogger("uvicorn.error").addFilter(_is_news)
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, args=([listener],), name="server")
        self._thread.start()
        while not self._server.started and self._thread.is_alive():
            time.sleep(0.01)

    def close(self) -> None:
        """Stop serving."""
        if self._server is not None and self._thread is not None:
            self._robots.close()
            self._server.should_exit = True
            self._thread.join()

    def app(self) -> Any:
        """The application, as ASGI servers take it."""
        from starlette.applications import Starlette
        from starlette.responses import FileResponse, PlainTextResponse, Response
        from starlette.routing import Route, WebSocketRoute

        async def page_file(request: Request) -> Response:
            name = request.path_params.get("name", PAGE)
            if not self._is_ours(request.headers.get("host", "")) or name not in self._page_files:
                return PlainTextResponse("Not found.", status_code=404, headers=_HEADERS)
            return FileResponse(self._page_files[name], headers=_HEADERS)

        async def house(request: Request) -> Response:
            data = self._houses.get(request.path_params["key"])
            if not self._is_ours(request.headers.get("host", "")) or data is None:
                return PlainTextResponse("Not found.", status_code=404, headers=_HEADERS)
            kept = {**_HEADERS, "Cache-Control": "private, max-age=31536000, immutable", "Content-Encoding": "gzip"}
            return Response(data, media_type="model/gltf-binary", headers=kept)

        async def own_page(request: Request) -> Response:
            is_ours = self._is_ours(request.headers.get("host", ""))
            page = self.own_pages.take(request.path_params["key"]) if is_ours else None
            if page is None:
                return PlainTextResponse("Not found.", status_code=404, headers=_HEADERS)
            return Response(
                page, media_type="text/html", headers={**_HEADERS, "Content-Security-Policy": own_pages.POLICY}
            )

        pages = [Route("/", page_file), Route("/{name}", page_file), Route("/house/{key}.glb", house)]
        pages.append(Route("/people/{key}.html", own_page))
        sockets = [WebSocketRoute("/live", self._connect), WebSocketRoute("/robot", self._connect_robot)]
        return Starlette(routes=[*pages, *sockets])

    def publish(self, file: HouseFile) -> str:
        """Serve the file of a house; its address on this server."""
        before = [(key, data) for key, data in self._houses.items() if key != file.key]
        self._houses = dict([*before, (file.key, file.data)][-_HOUSES:])
        return f"/house/{file.key}.glb"

    def _is_ours(self, host: str) -> bool:
        """Whether a page of this host's is one of ours; a foreign site may lead a browser here under its own name."""
        name, _, port = host.rpartition(":") if ":" in host.replace("[::1]", "") else (host, "", self._usual_port)
        return name in self._hosts and (not self._port or port == str(self._port))

    def _is_our_page(self, origin: str) -> bool:
        scheme, _, host = origin.partition("://")
        return scheme == self._scheme and self._is_ours(host)

    async def _refuses(self, socket: WebSocket) -> bool:
        """Refuse a browser that the page of another site has led here; whether it was refused."""
        origin, host = socket.headers.get("origin"), socket.headers.get("host", "")
        if self._is_ours(host) and (origin is None or self._is_our_page(origin)):
            return False
        _LOG.warning("refused a connection from the page of another site: %s", _short(origin or host))
        await socket.close(1008)
        return True

    async def _connect_robot(self, socket: WebSocket) -> None:
        """Let the program of a robot connect."""
        if not await self._refuses(socket):
            await self._robots.connect(socket)

    async def _connect(self, socket: WebSocket) -> None:
        """Let a page join its seat, and listen to it until it leaves."""
        if await self._refuses(socket):
            return
        versions = socket.scope.get("subprotocols", [])
        if wire.VERSION not in versions:
            await socket.accept()
            asked = _short(", ".join(versions)) or "nothing"
            await _refuse(socket, f"this server speaks {wire.VERSION}, the page {asked}. Reload the page.")
            return
        await socket.accept(wire.VERSION)
        place = await self._join(socket)
        if place is None:
            return
        page = Connection(asyncio.get_running_loop())
        sender = asyncio.create_task(_send(socket, page))
        try:
            if isinstance(place, Desk):
                await asyncio.to_thread(place.join, page)
            elif (before := place.join(page)) is not None:
                before.send(wire.Problem(words="This seat was opened in another window; close this one."))
            await self._listen(socket, place, page)
        finally:
            place.leave(page)
            sender.cancel()
            with contextlib.suppress(asyncio.CancelledError, Exception):
                await sender

    async def _join(self, socket: WebSocket) -> LiveSeat | Desk | None:
        """What a page has the token of; None if it has none, and the connection is closed then."""
        try:
            first = await asyncio.wait_for(socket.receive(), _JOIN_S)
            joined = wire.decode(first.get("text") or "") if first["type"] == "websocket.receive" else None
        except (Malformed, TimeoutError):
            joined = None
        if isinstance(joined, wire.Join):
            given = joined.token.encode()  # compare_digest takes no text beyond ASCII
            for name, token in self.tokens.items():
                if secrets.compare_digest(token.encode(), given):
                    return self._seats[name]
            if secrets.compare_digest(self._desk_token.encode(), given):
                return self._desk
        _LOG.warning("refused a connection without the token of a seat")
        await _refuse(socket, "this address belongs to no seat of the session. Open the address that hthor printed.")
        return None

    async def _listen(self, socket: WebSocket, place: LiveSeat | Desk, page: Connection) -> None:
        whose = "the experimenter" if isinstance(place, Desk) else place.seat
        while not page.overrun:
            received = await socket.receive()
            if received["type"] != "websocket.receive":
                if received.get("code") == _TOO_LARGE:
                    _LOG.warning("%s: a message of more than %d bytes; its connection is closed", whose, MOST_BYTES)
                return
            try:
                text, data = received.get("text") or "", received.get("bytes")
                if len(text) > wire.LARGEST:
                    raise Malformed(f"{len(text)} characters, at most {wire.LARGEST} are taken")
                if isinstance(place, Desk):
                    await asyncio.to_thread(_command, place, page, desk_wire.decode(text))
                elif data is not None:
                    place.steer(wire.decode_steering(data))
                else:
                    _take(place, page, wire.decode(text))
            except Malformed as error:
                _LOG.warning("%s: a message that is none: %s", whose, _short(str(error)))
        _LOG.warning("%s: the page is too slow; its connection is given up", whose)


def _take(seat: LiveSeat, page: Connection, message: wire.FromPage) -> None:
    match message:
        case wire.Act():
            seat.act(message)
        case wire.Begin():
            seat.begin_trial(message.trial)
        case wire.Rate():
            if not wire.is_rating(message.value):
                raise Malformed(f"{message.value} is no rating")
            seat.rate(message.trial, message.value)
        case wire.Skip():
            seat.skip(message.trial)
        case wire.Ping():
            seat.ping(message)
            page.send(wire.Pong(sent=message.sent))
        case wire.Join():
            raise Malformed("the page has joined already")


def _command(desk: Desk, page: Connection, command: desk_wire.FromDesk) -> None:
    try:
        desk.do(page, command)
    except HthorError as error:
        page.send(desk_wire.Refused(words=str(error)))


async def _send(socket: WebSocket, page: Connection) -> None:
    with contextlib.suppress(Exception):  # a page that is gone is noticed by the one who listens to it
        while True:
            for data in await page.next():
                if isinstance(data, str):
                    await socket.send_text(data)
                else:
                    await socket.send_bytes(data)


async def _refuse(socket: WebSocket, words: str) -> None:
    with contextlib.suppress(Exception):
        await socket.send_text(wire.encode(wire.Problem(words=words)))
        await socket.close(1008)


def _is_news(record: logging.LogRecord) -> bool:
    """Whether a line of uvicorn's log is worth reading: pages that are open when the session ends are cut off."""
    return "timeout graceful shutdown exceeded" not in record.getMessage()


def _short(text: str) -> str:
    """A text from outside as it may stand in a line of a log."""
    return "".join(one if one.isprintable() else "?" for one in text[:120])
