"""Clients of a live session's server, without a browser: a scripted person, and a request for one file."""

from __future__ import annotations

import http.client
import json
import ssl
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from hthor.live import wire
from hthor.types import Drive


def fetch(address: str, path: str, **headers: str) -> tuple[int, Any, str]:
    """The status, the headers and the text of a file that a server has."""
    place = urlsplit(address)
    connection = http.client.HTTPConnection(place.hostname or "", place.port, timeout=20.0)
    try:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read().decode()
    finally:
        connection.close()


class ScriptedPerson:
    """Joins a seat and keeps what it is shown; `drive` and `act` are what a page does.

    What is sent to a server that is gone is lost; ``connected`` says whether it is.

    Args:
        trusts: the file of a certificate that the person trusts, for an address that begins with https.
    """

    def __init__(
        self,
        address: str,
        token: str,
        *,
        version: str = wire.VERSION,
        origin: str = "",
        steers: bool = True,
        trusts: Path | None = None,
    ) -> None:
        self.received: list[dict[str, Any]] = []
        self.frames: list[wire.FrameHead] = []
        self.places: dict[int, tuple[int, ...]] = {}
        self.pictures: dict[int, bytes] = {}
        self.steered = self.acts = 0
        self.connected = True
        self.changed = threading.Condition()
        self._token, self._open = token, ExitStack()
        self._connection = connect(
            address.replace("http", "ws") + "/live",
            subprotocols=[version],  # type: ignore[list-item]
            origin=origin or address,  # type: ignore[arg-type]
            ssl=None if trusts is None else ssl.create_default_context(cafile=trusts),
        )
        self._drive, self._gone = Drive(), not steers

    def __enter__(self) -> ScriptedPerson:
        self.socket: ClientConnection = self._open.enter_context(self._connection)
        self.send({"type": "join", "token": self._token})
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        threading.Thread(target=self._push, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.leave()

    def leave(self) -> None:
        """Close the page."""
        self._gone = True
        self._open.close()
        self._reader.join()

    def send(self, message: dict[str, Any]) -> None:
        with suppress(ConnectionClosed):
            self.socket.send(json.dumps(message))

    def drive(self, **drive: float) -> None:
        self._drive = Drive(**drive)

    def stop_steering(self) -> None:
        """Send no more steering, as a page does that hangs."""
        self._gone = True

    def act(self, **act: Any) -> int:
        """Do something with hands, buttons or words; its number."""
        self.acts += 1
        self.send({"type": "act", "number": self.acts, **act})
        return self.acts

    def last(self, kind: str) -> dict[str, Any] | None:
        """The last message of a kind."""
        return next((one for one in reversed(self.received) if one["type"] == kind), None)

    def wait_for(self, kind: str, seconds: float = 60.0, /, **fields: Any) -> dict[str, Any]:
        """The first message of this kind with these fields, which may have come already."""

        def found() -> dict[str, Any] | None:
            fits = (one for one in self.received if one["type"] == kind)
            return next((one for one in fits if all(one.get(k) == v for k, v in fields.items())), None)

        with self.changed:
            assert self.changed.wait_for(found, seconds), (kind, fields, self.received[-5:])
        message = found()
        assert message is not None
        return message

    def wait_for_event(self, kind: str) -> None:
        """Wait until the experimenter's page shows an event of a kind."""
        self.wait_until(lambda: kind in self.event_kinds)

    @property
    def event_kinds(self) -> list[str]:
        """The kinds of the events that the experimenter's page shows."""
        return [line["kind"] for one in self.received if one["type"] == "happened" for line in one["events"]]

    def wait_until(self, done: Callable[[], bool], seconds: float = 60.0) -> None:
        with self.changed:
            assert self.changed.wait_for(done, seconds)

    def see(self, frame: wire.FrameHead) -> None:
        """Called with each frame; does nothing here."""

    def _push(self) -> None:
        try:
            while not self._gone:
                self.steered += 1
                self.socket.send(wire.encode_steering(wire.Steering(self.steered, self._drive)))
                time.sleep(1 / 60)
        except ConnectionClosed:
            return

    def _read(self) -> None:
        try:
            for data in self.socket:
                with self.changed:
                    if isinstance(data, str):
                        self.received.append(json.loads(data))
                        if self.received[-1]["type"] == "welcome":
                            self.acts = self.received[-1]["acts"]
                    elif data[0] == 3:
                        self.pictures[int.from_bytes(data[1:5], "little")] = data[5:]
                    else:
                        head, moved = wire.decode_frame(data)
                        self.frames.append(head)
                        self.places.update(moved)
                        self.see(head)
                    self.changed.notify_all()
        except ConnectionClosed:
            pass
        with self.changed:
            self.connected = False
            self.changed.notify_all()
