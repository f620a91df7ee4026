"""A person who takes part in a whole session, whatever happens to its server or to their page."""

from __future__ import annotations

import threading
import time
from typing import Any

from live_client import ScriptedPerson
from websockets.exceptions import ConnectionClosed, InvalidHandshake

AGAIN_S = 0.05


class SteadyPerson:
    """Walks in a circle, confirms messages and rates, in a thread of its own; connects again until the session is over.

    Attributes:
        begun: the numbers of the trials that were begun, in order. over: whether the session is.
    """

    def __init__(self, address: str, token: str) -> None:
        self._address, self._token = address, token
        self.begun: list[int] = []
        self.over = False
        self._stopped = False
        self._page: ScriptedPerson | None = None
        self._thread = threading.Thread(target=self._sit)
        self._thread.start()

    def __enter__(self) -> SteadyPerson:
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped = True
        self._thread.join(60.0)

    def drop_page(self) -> None:
        """The page is gone at once, and opened again."""
        if (page := self._page) is not None:
            page.leave()

    def _sit(self) -> None:
        while not (self.over or self._stopped):
            try:
                with ScriptedPerson(self._address, self._token) as page:
                    self._page = page
                    self._answer(page)
            except (OSError, ConnectionClosed, InvalidHandshake):  # the server is not there
                time.sleep(AGAIN_S)

    def _answer(self, page: ScriptedPerson) -> None:
        """Do what each message asks for, until the connection ends."""
        page.drive(forward=0.5, yaw=0.7, pitch=-0.1)
        done = 0
        while page.connected and not (self.over or self._stopped):
            with page.changed:
                page.changed.wait(AGAIN_S)
            for message in page.received[done:]:
                self._react(page, message)
                done += 1

    def _react(self, page: ScriptedPerson, message: dict[str, Any]) -> None:
        match message["type"]:
            case "trial":
                page.send({"type": "begin", "trial": message["trial"]})
            case "began":
                self.begun.append(message["trial"])
            case "panel" if message["message"] is not None:
                page.act(say={"type": "reply", "message": message["message"], "accept": True})
            case "ended" if message["rate"]:
                page.send({"type": "rate", "trial": message["trial"], "value": 5})
            case "over":
                self.over = True
