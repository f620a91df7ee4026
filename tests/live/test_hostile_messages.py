"""Malformed, forged, oversized and foreign messages: none has an effect, and each has one line in the log."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from live_session import LiveSession
from websockets.exceptions import InvalidStatus

from hthor.guest.protocol.wire import MOST_BYTES
from hthor.live import desk_wire, wire
from hthor.types import HUMAN
from hthor.types.events import Acted

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")

VALID = (
    {"type": "act", "number": 1, "motion": {"type": "pick", "object": "apple_1"}},
    {"type": "act", "number": 1, "say": {"type": "reply", "message": 0, "accept": True}},
    {"type": "act", "number": 1, "signals": [{"type": "show", "what": "map", "on": True}]},
    {"type": "begin", "trial": 0},
    {"type": "rate", "trial": 0, "value": 5},
    {"type": "ping", "sent": 1.0, "frames": 60.0},
    {"type": "pause", "reason": "tea"},
    {"type": "void", "reason": "a cable"},
    {"type": "adoption", "trial": "0123", "seat": "human", "adopted": None, "reason": "tea"},
)
FORGED = (
    {"type": "rate", "trial": 0, "value": 8},
    {"type": "join", "token": "once more"},
    {"type": "ended", "trial": 0, "met": True, "voided": "", "rate": False},
    {"type": "acknowledged", "act": 7},
)
STEERING = wire.encode_steering(wire.Steering(1, wire.Drive(forward=1.0)))


def words(draw: random.Random, count: int, decode: object) -> list[str]:
    """Texts that are no messages: valid ones with something changed, and forged ones."""
    found: list[str] = [json.dumps(one) for one in FORGED]
    while len(found) < count:
        text = list(json.dumps(draw.choice(VALID)))
        for _ in range(draw.randint(1, 4)):
            at = draw.randrange(len(text))
            text[at : at + draw.randint(0, 3)] = draw.choice(["", '"', "}", "[", "\x00", "9" * 30, "é", "null", "-"])
        try:
            decode("".join(text))  # type: ignore[operator]
        except wire.Malformed:
            found.append("".join(text))
    return found


def frames(draw: random.Random, count: int) -> list[bytes]:
    """Binary messages that are none: of another length, of another kind, and with numbers that are not finite."""
    found = []
    while len(found) < count:
        cut = draw.choice([STEERING[: draw.randrange(len(STEERING))], STEERING + draw.randbytes(draw.randint(1, 400))])
        other = bytes([draw.randint(2, 255)]) + STEERING[1:]
        endless = STEERING[:5] + b"\x00\x00\xc0\x7f" + STEERING[9:]
        found.append(draw.choice([cut, other, endless]))
    return found


@pytest.fixture
def live(tmp_path: Path) -> Iterator[LiveSession]:
    made = LiveSession(tmp_path, seconds=8.0, faster=1.0)
    yield made
    made.close()


def test_five_hundred_of_them(live: LiveSession, caplog: pytest.LogCaptureFixture) -> None:
    draw = random.Random(7)
    with live.person() as person:
        person.wait_for("trial")
        person.send({"type": "begin", "trial": 0})
        person.wait_for("began")
        large = ["x" * (wire.LARGEST + 1)] * 5
        for one in (*words(draw, 235, wire.decode), *large, *frames(draw, 100)):
            person.socket.send(one)
        person.wait_until(lambda: bool(person.frames))
        with live.person(token=live.server.desk_url.rpartition("#")[2], steers=False) as desk:
            for text in words(draw, 100, desk_wire.decode):
                desk.socket.send(text)
            live.wait_until(lambda: _lines(caplog) == 440)
        for _ in range(20):
            with live.person(token=draw.choice([" ", "guess", live.server.tokens[HUMAN][:-1]])) as stranger:
                stranger.wait_for("problem")
        for origin in ("http://evil.example", "null", "https://127.0.0.1.evil.example", "http://127.0.0.1:1") * 5:
            with pytest.raises(InvalidStatus, match="403"):
                live.person(origin=origin)
        for number in range(20):
            with live.person() as again:
                again.socket.send("x" * (MOST_BYTES + 1) if number % 2 else b"\x01" * (MOST_BYTES + 1))
                again.wait_until(lambda again=again: not again.connected)  # type: ignore[misc]
        live.wait_until(lambda: _lines(caplog) == 500)
        _stay_to_the_end(live)
    log = live.log()
    assert not any(isinstance(entry, Acted) and entry.seat == HUMAN for entry in log.journal)
    assert len({pose[:2] for pose in log.paths[HUMAN]}) == 1, "nobody walked"
    assert not log.voided
    assert log.ratings == {HUMAN: 4}


def _stay_to_the_end(live: LiveSession) -> None:
    with live.person() as person:
        person.wait_for("ended")
        person.send({"type": "rate", "trial": 0, "value": 4})
        live.thread.join(60.0)


def _lines(caplog: pytest.LogCaptureFixture) -> int:
    return sum(one.name == "hthor.live" for one in caplog.records)
