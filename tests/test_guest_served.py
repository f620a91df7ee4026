"""An agent behind a WebSocket is judged like any other: what its server does wrong is a fault of a known name."""

from __future__ import annotations

import contextlib
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
from hthor.eval import guarded
from hthor.guest import Guest, GuestFault, IsolationError, Unreachable, serving, wire
from hthor.types import Action, Move, Wait
from tests.test_guest import BRIEFING, HEAD, Sensors, agent, look

server = pytest.importorskip("websockets.sync.server")


@contextlib.contextmanager
def running(made: Any) -> Iterator[str]:
    thread = threading.Thread(target=made.serve_forever)
    thread.start()
    try:
        yield serving.address(made)
    finally:
        made.shutdown()
        thread.join()


@contextlib.contextmanager
def lying(talk: Callable[[Any], None]) -> Iterator[str]:
    """A server of our own making: what it does once an agent's first look has come."""

    def handle(connection: Any) -> None:
        with contextlib.suppress(Exception):
            connection.send(wire.encode(wire.Ready(name="liar")))
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
    with running(serving.serve(str(path), "127.0.0.1", 0)) as url:
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
            guarded.settle("auto", "L1", [url])
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
        (lambda _: time.sleep(1.0), "timeout", "no answer within"),
        (lambda connection: connection.close(), "died", "the server closed the connection"),
        (lambda connection: connection.socket.shutdown(2), "died", "the server closed the connection"),
        (lambda connection: connection.send("words"), "garbage", "no message"),
        (lambda connection: connection.send(b"\xc1"), "garbage", "no message"),
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
    with lying(deaf) as url, Guest(url, step_s=1.0, bank_s=0.0) as mind:
        mind.begin(BRIEFING)
        with pytest.raises(GuestFault, match="timeout: the agent read nothing for 1 s"):
            all(mind.act(words) for _ in range(20_000))


def test_what_says_what_cannot_be_is_refused() -> None:
    for ready, told in (
        (wire.Ready(privileges=("x_ray",)), "names? 'x_ray'. Valid: house_map"),
        (wire.Ready(wire=7), "version 7 of the wire"),
        (wire.Ready(gpus=-1.0), "gpus must be"),
        (wire.Done(), "it said Done before"),
    ):
        made = server.serve(lambda connection, said=ready: connection.send(wire.encode(said)), "127.0.0.1", 0)
        with running(made) as url, pytest.raises(AgentError, match=told):
            Guest(url).load()


def test_a_port_that_is_taken_is_told_so(tmp_path: Path) -> None:
    agents.write_template(tmp_path / "mine.py")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        done = CliRunner().invoke(cli.app, ["agent", "serve", str(tmp_path / "mine.py"), "--port", port])
    assert isinstance(done.exception, HthorError)
    assert f"cannot listen at 127.0.0.1:{port}: Address already in use. Give another --port" in str(done.exception)
