"""An agent behind a WebSocket is judged like any other: what its server does wrong is a fault of a known name."""

from __future__ import annotations

import base64
import contextlib
import hashlib
import socket
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from hthor import agents
from hthor.cli import app as cli
from hthor.errors import AgentError, HthorError
from hthor.eval.records import run_isolation
from hthor.guest import Guest, GuestFault, IsolationError, Unreachable
from hthor.guest.client import websocket_server
from hthor.guest.protocol import wire
from hthor.guest.protocol.versions import VERSION
from hthor.types import Action, Move, Wait
from tests.support.guest_agents import BRIEFING, HEAD, Sensors, agent, look

server = pytest.importorskip("websockets.sync.server")


@contextlib.contextmanager
def running(made: Any) -> Iterator[str]:
    thread = threading.Thread(target=made.serve_forever)
    thread.start()
    try:
        yield websocket_server.address(made)
    finally:
        made.shutdown()
        thread.join()


@contextlib.contextmanager
def lying(talk: Callable[[Any], None]) -> Iterator[str]:
    """A server of our own making: what it does once an agent's first look has come."""

    def handle(connection: Any) -> None:
        with contextlib.suppress(Exception):
            connection.send(wire.encode(wire.Ready(name="liar", wire=VERSION)))
            while True:
                if b"begin" in connection.recv()[:20]:
                    connection.send(wire.encode(wire.Done()))
                else:
                    talk(connection)

    with running(server.serve(handle, "127.0.0.1", 0, compression=None)) as url:
        yield url


def test_a_served_agent_plays(tmp_path: Path) -> None:
    path = tmp_path / "my_agent.py"
    act = (
        "assert observation.rgb[0, 1, 2] == 5\nassert observation.detections\n"
        "return Action(motion=Move(forward=float(observation.scan.ranges.min()) / 10))"
    )
    path.write_text(HEAD + agent(act).replace("class Agent:", "class Agent:\n    privileges = ('ideal_detector',)"))
    with running(websocket_server.serve(str(path), "127.0.0.1", 0)) as url:
        with Guest(url) as mind:
            info = mind.load()
            for _ in range(2):
                mind.begin(BRIEFING)
                senses = Sensors()
                assert mind.act(look(0, senses)) == Action(motion=Move(forward=0.25))
                assert senses.read == ["rgb", "detections", "scan"]
        assert (info.name, info.source, info.privileges) == ("my_agent", url, ("ideal_detector",))
        assert (info.isolation.level, info.persistent) == ("served", True)
        with pytest.raises(IsolationError, match=r"L1 is required, but ws://.* is served"):
            run_isolation.resolve_isolation("auto", "L1", [url])
        with Guest(f"{url}/") as other:
            assert other.load().sha256 == info.sha256
            other.begin(BRIEFING)
            with pytest.raises(GuestFault, match="IndexError") as caught:
                other.act(look(0, Small()))
            assert caught.value.kind == "raised"
            assert "my_agent.py" in caught.value.traceback


class Small(Sensors):
    def rgb(self) -> Any:
        return super().rgb()[:1, :1]


@pytest.mark.parametrize(
    ("talk", "kind", "told"),
    [
        (lambda _: time.sleep(0.6), "timeout", "no answer within"),
        (lambda connection: connection.close(), "died", "the server closed the connection"),
        (lambda connection: connection.socket.shutdown(2), "died", "the server closed the connection"),
        (lambda connection: connection.send("words"), "garbage", "not a message"),
        (lambda connection: connection.send(b"\xc1"), "garbage", "not a message"),
        (lambda connection: connection.send(bytes(70_000)), "oversized", "65537 bytes"),
        (lambda connection: connection.send(wire.encode(wire.Done())), "garbage", "answered by Done"),
        (
            lambda connection: connection.send(
                wire.encode(wire.Acted(action=Action(motion=Move(forward=float("nan")))))
            ),
            "not_finite",
            "Move.forward",
        ),
    ],
)
def test_what_a_server_does_wrong_is_a_fault(talk: Callable[[Any], None], kind: str, told: str) -> None:
    with lying(talk) as url, Guest(url, step_s=0.3, bank_s=0.0) as mind:
        mind.begin(BRIEFING)
        with pytest.raises(GuestFault) as caught:
            mind.act(look())
        assert (caught.value.kind, told in str(caught.value)) == (kind, True), str(caught.value)
        mind.begin(BRIEFING)


def test_a_server_that_reads_nothing_is_given_up(tmp_path: Path) -> None:
    stop = threading.Event()
    picture = wire.encode(wire.Ask(what="rgb"))

    def greedy(connection: Any) -> None:
        for _ in range(90):
            connection.send(picture)
        stop.wait(20.0)

    with lying(greedy) as url, Guest(url, step_s=0.5, bank_s=0.0) as mind:
        mind.begin(BRIEFING)
        with pytest.raises(GuestFault) as caught:
            mind.act(look())
        stop.set()
        assert caught.value.kind == "timeout"


def test_where_nobody_serves_the_run_does_not_begin_and_a_trial_has_a_fault() -> None:
    with lying(lambda connection: connection.send(wire.encode(wire.Acted(action=Action())))) as url:
        mind = Guest(url)
        mind.begin(BRIEFING)
        assert mind.act(look()) == Action(motion=Wait())
    with pytest.raises(GuestFault, match="died"):
        mind.act(look())
    with pytest.raises(GuestFault, match=r"died: cannot reach the agent at ws://.*hthor agent serve"):
        mind.begin(BRIEFING)
    with pytest.raises(Unreachable):
        Guest(url).load()


def test_a_server_that_never_listens_runs_out_of_time() -> None:
    """It answers looks that it has not read; what is sent to it piles up until nothing more fits."""

    def deaf(connection: Any) -> None:
        while True:
            connection.send(wire.encode(wire.Acted(action=Action())))

    words = look(room="r" * 8000)
    with lying(deaf) as url, Guest(url, step_s=0.5, bank_s=0.0) as mind:
        mind.begin(BRIEFING)
        with pytest.raises(GuestFault, match=r"timeout: the agent read nothing for 0\.5 s"):
            all(mind.act(words) for _ in range(20_000))


def test_what_says_what_cannot_be_is_refused() -> None:
    for ready, told in (
        (wire.Ready(privileges=("x_ray",), wire=VERSION), "names? 'x_ray'. Valid: house_map"),
        (wire.Ready(gpus=-1.0, wire=VERSION), "gpus must be"),
        (wire.Done(), "it said Done before"),
    ):
        made = server.serve(lambda connection, said=ready: connection.send(wire.encode(said)), "127.0.0.1", 0)
        with running(made) as url, pytest.raises(AgentError, match=told):
            Guest(url).load()


def test_a_port_that_is_taken_is_told_so(tmp_path: Path) -> None:
    agents.write_template(tmp_path / "mine.py")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        done = CliRunner().invoke(cli, ["agent", "serve", str(tmp_path / "mine.py"), "--port", port])
    assert isinstance(done.exception, HthorError)
    assert f"cannot listen at 127.0.0.1:{port}: Address already in use. Give another --port" in str(done.exception)


def _handshake(near: socket.socket) -> None:
    """What a server of WebSockets answers at first."""
    asked = near.recv(65536).decode()
    key = next(line.split(": ")[1] for line in asked.split("\r\n") if line.lower().startswith("sec-websocket-key"))
    answer = base64.b64encode(hashlib.sha1(f"{key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11".encode()).digest())
    head = b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: "
    near.sendall(head + answer + b"\r\n\r\n")


@contextlib.contextmanager
def raw(talk: Callable[[socket.socket], None]) -> Iterator[str]:
    """A server without a library: what it does with each connection, once it is accepted."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        near: list[socket.socket] = []

        def handle() -> None:
            with contextlib.suppress(OSError):
                while True:
                    near.append(listener.accept()[0])
                    threading.Thread(target=answer, args=(near[-1],), daemon=True).start()

        def answer(one: socket.socket) -> None:
            with contextlib.suppress(OSError):
                talk(one)

        thread = threading.Thread(target=handle)
        thread.start()
        try:
            yield "ws://{}:{}".format(*listener.getsockname())
        finally:
            listener.shutdown(socket.SHUT_RDWR)
            thread.join()
            for one in near:
                one.close()


def _message(words: object) -> bytes:
    body = wire.encode(words)
    return (
        bytes([0x82, 126]) + len(body).to_bytes(2, "big") + body if len(body) > 125 else bytes([0x82, len(body)]) + body
    )


@pytest.mark.parametrize("answers", [True, pytest.param(False, marks=pytest.mark.nightly)])
def test_a_flood_of_pings_comes_to_an_end(answers: bool) -> None:
    """Nobody reads what the library answers to them, so that its own thread waits while it holds all that it has."""

    def flood(one: socket.socket) -> None:
        _handshake(one)
        one.sendall(_message(wire.Ready(name="liar", wire=VERSION)))
        one.recv(1 << 16)
        if answers:
            one.sendall(_message(wire.Done()))
        while True:
            one.sendall(bytes([0x89, 125]) + bytes(125))

    with raw(flood) as url:
        mind = Guest(url, start_s=1.0, step_s=0.1, bank_s=0.0)

        def play() -> None:
            mind.begin(BRIEFING)
            all(mind.act(look()) for _ in range(50))

        with pytest.raises(GuestFault) as caught:
            play()
        mind.close()
    assert caught.value.kind in ("timeout", "died"), str(caught.value)


def test_a_server_is_where_its_address_says() -> None:
    with lying(lambda _: None) as elsewhere:

        def redirect(one: socket.socket) -> None:
            one.recv(65536)
            one.sendall(f"HTTP/1.1 302 Found\r\nLocation: {elsewhere}\r\nContent-Length: 0\r\n\r\n".encode())

        with raw(redirect) as url, pytest.raises(Unreachable, match=r"cannot reach .* the agent is elsewhere"):
            Guest(url, start_s=3.0).load()
