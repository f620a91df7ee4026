"""Where robots' programs connect: who is let in, who may come back, and which fault is what a program does wrong."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import pytest
from live_session import Book
from typer.testing import CliRunner

from hthor.cli import app as cli
from hthor.errors import AgentError, HthorError
from hthor.guest import AgentInputs, Guest, GuestConfig, GuestFault, Unreachable
from hthor.guest.protocol.wire import MOST_BYTES
from hthor.live.control import SessionControl
from hthor.live.desk import Desk
from hthor.live.robot_programs import PROTOCOL, RobotPrograms
from hthor.live.server import LiveServer
from hthor.trials import form_team
from hthor.types import Action, Move
from tests.support.guest_agents import BRIEFING, Sensors, look

sockets = pytest.importorskip(
    "starlette.websockets", reason="live sessions need an optional dependency: pip install 'hthor[live]'"
)
client = pytest.importorskip("websockets.sync.client")
exceptions = pytest.importorskip("websockets.exceptions")

READY = {"type": "ready", "wire": 2, "name": "tester"}
ACTED = {"type": "acted", "action": {"motion": {"type": "move", "forward": 0.25}}}


class Room:
    """A server with the places of two robots, and no trial.

    Attributes:
        said: the sentences that the experimenter was told. then: called after each.
    """

    def __init__(self) -> None:
        self.said: list[str] = []
        self.robots = RobotPrograms({"socket": "one-token", "socket:two": "two-token"}, tell=self._tell)
        self.server = LiveServer({}, Desk(SessionControl(), {}, Book()), robots=self.robots)
        self.server.start(page=False)
        self._open = contextlib.ExitStack()
        self.then: Callable[[], None] = lambda: None

    def connect(self, *, agent: str = "socket", token: str = "", protocol: str = PROTOCOL, **options: Any) -> Any:
        address, own = self.server.robot_url(agent).split("#")
        return self._open.enter_context(client.connect(address, subprotocols=[protocol, token or own], **options))

    def program(self, agent: str = "socket") -> Program:
        """A program that has taken its place."""
        socket = self.connect(agent=agent)
        program = Program(socket)
        program.send(READY)
        self.robots.take(agent, 60.0)
        return program

    def guest(self, agent: str = "socket", **options: Any) -> Guest:
        return Guest(agent, config=GuestConfig(programs=self.robots), **options)

    def _tell(self, said: str) -> None:
        self.said.append(said)
        self.then()

    def close(self) -> None:
        self._open.close()
        self.server.close()


class Program:
    """The program's end of a connection."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket

    def send(self, *messages: dict[str, Any]) -> None:
        for message in messages:
            self.socket.send(msgspec.msgpack.encode(message))

    def hear(self, kind: str) -> dict[str, Any]:
        """The host's next message, of this kind."""
        message: dict[str, Any] = msgspec.msgpack.decode(self.socket.recv(timeout=60.0))
        assert message["type"] == kind
        return message


@pytest.fixture
def room() -> Iterator[Room]:
    made = Room()
    yield made
    made.close()


@pytest.fixture(scope="module")
def empty_room() -> Iterator[Room]:
    """A room in which nobody takes a place."""
    made = Room()
    yield made
    made.close()


@pytest.mark.parametrize(
    ("options", "first", "words"),
    [
        ({"token": "guess"}, None, "its token belongs to no robot of this session"),
        ({"protocol": "hthor"}, None, "offer two sub-protocols, hthor.wire and the token"),
        ({}, {**READY, "wire": 1}, "it uses version 1 of the protocol"),
        ({}, {**READY, "wire": 3}, "it uses version 3 of the protocol, but this hthor only knows versions up to 2"),
        ({}, {**READY, "privileges": ["wings"]}, "its privileges name 'wings'"),
        ({}, {**READY, "absent": True}, "it says that there is no robot"),
        ({}, {"type": "done"}, "its first message must be `ready`"),
        ({}, b"\xc1\x00", "its first message must be `ready`"),
        ({}, "ready", "its first message must be `ready`"),
    ],
)
def test_who_does_not_belong_here_is_told_why(
    empty_room: Room, caplog: pytest.LogCaptureFixture, options: dict[str, str], first: Any, words: str
) -> None:
    socket = empty_room.connect(**options)
    if first is not None:
        socket.send(msgspec.msgpack.encode(first) if isinstance(first, dict) else first)
    with pytest.raises(exceptions.ConnectionClosedError) as closed:
        socket.recv(timeout=60.0)
    assert closed.value.rcvd.code == 1008
    assert closed.value.rcvd.reason.startswith(words)
    (line,) = [one.message for one in caplog.records if one.name == "hthor.live"]
    assert words in line
    assert not any(token in line for token in empty_room.robots.tokens.values())


@pytest.mark.parametrize("origin", ["http://evil.example", "null"])
def test_pages_of_other_sites_are_refused(empty_room: Room, origin: str) -> None:
    with pytest.raises(exceptions.InvalidStatus, match="403"):
        empty_room.connect(origin=origin)


def test_a_program_is_told_that_the_session_is_over(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also when the server is so busy that it would have ended first."""
    close = sockets.WebSocket.close

    async def slow(socket: Any, *words: Any) -> None:
        await asyncio.sleep(0.5)
        await close(socket, *words)

    program = room.program()
    monkeypatch.setattr(sockets.WebSocket, "close", slow)
    room.server.close()
    with pytest.raises(exceptions.ConnectionClosedOK) as closed:
        program.socket.recv(timeout=60.0)
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (1001, "the session is over")


def test_a_place_has_one_program_which_stays_what_it_is(room: Room, caplog: pytest.LogCaptureFixture) -> None:
    program = room.program()
    with pytest.raises(exceptions.ConnectionClosedError, match="another program is connected as socket"):
        room.connect().recv(timeout=60.0)
    program.socket.close()
    with pytest.raises(Unreachable, match="did not connect again within 0 s"):
        _until_left(room)
    other = room.connect()
    other.send(msgspec.msgpack.encode({**READY, "name": "somebody else"}))
    with pytest.raises(exceptions.ConnectionClosedError, match="its `ready` is not that of the program"):
        other.recv(timeout=60.0)
    room.program()
    assert len([one for one in caplog.records if one.name == "hthor.live"]) == 2


def _until_left(room: Room) -> None:
    """Take a program again and again until it has left."""
    while True:
        room.robots.take("socket", 0.0)


def test_a_program_plays_trial_after_trial_and_may_connect_again_between_them(room: Room) -> None:
    program, other = room.program(), room.program("socket:two")
    with room.guest() as mind, room.guest("socket:two") as second:
        info = mind.load()
        assert (info.name, info.source, info.isolation.level, info.persistent) == ("tester", "socket", "served", True)
        for one, host in ((program, mind), (other, second), (program, mind)):
            one.send({"type": "done"})
            host.begin(BRIEFING)
            assert one.hear("begin")["briefing"]["target"] == "apple"
            senses = Sensors()
            one.send({"type": "ask", "what": "rgb"}, {"type": "ask", "what": "detections"}, ACTED)
            assert host.act(look(0, senses)) == Action(motion=Move(forward=0.25))
            assert senses.read == ["rgb", "detections"]
            assert len(one.hear("look") and one.hear("given")["value"]["d"]) == 300 * 400 * 3
            assert one.hear("given")["value"][0]["id"] == "apple"
            host.finish()
            one.hear("end")
        program.socket.close()
        with pytest.raises(Unreachable):
            _until_left(room)
        again = room.program()
        again.send({"type": "done"}, ACTED)
        mind.begin(BRIEFING)
        assert mind.act(look()) == Action(motion=Move(forward=0.25))


def _flood(program: Program) -> None:
    with contextlib.suppress(exceptions.ConnectionClosed):
        program.send(*[ACTED] * 200)


def _act_for_ever(mind: Guest) -> None:
    """A flood is noticed in the step in which it comes, or in a later one."""
    while True:
        mind.act(look())


@pytest.mark.parametrize(
    ("wrong", "kind", "words"),
    [
        (lambda one: one.socket.close(1000, "my battery is empty"), "died", "my battery is empty"),
        (lambda one: one.socket.send(b"\xc1"), "garbage", "what the agent sent is not a message"),
        (lambda one: one.socket.send("acted"), "garbage", "what the agent sent is not a message"),
        (lambda one: one.send({"type": "ask", "what": "wings"}), "garbage", "asked for 'wings'"),
        (_flood, "garbage", "more than 8 messages"),
        (lambda one: one.socket.send(bytes(MOST_BYTES + 1)), "oversized", f"more than {MOST_BYTES} bytes"),
        (lambda one: one.send({"type": "failed", "kind": "raised", "detail": "no map"}), "raised", "no map"),
        (lambda one: None, "timeout", "no answer within 0.2 s"),
    ],
    ids=["leaves", "no message", "text", "no sensor", "flood", "too long", "fails", "silent"],
)
def test_what_a_program_does_wrong_is_a_fault(
    room: Room, wrong: Callable[[Program], None], kind: str, words: str
) -> None:
    program = room.program()
    with room.guest(**({"step_s": 0.2, "bank_s": 0.0} if kind == "timeout" else {})) as mind:
        program.send({"type": "done"})
        mind.begin(BRIEFING)
        wrong(program)
        with pytest.raises(GuestFault) as fault:
            _act_for_ever(mind)
    assert fault.value.kind == kind
    assert words in str(fault.value)
    again = room.program()
    with room.guest() as mind:
        again.send({"type": "done"})
        mind.begin(BRIEFING)


def test_who_waits_for_a_program_says_so(room: Room) -> None:
    room.then = lambda: Program(room.connect()).send(READY)
    assert room.guest().load().name == "tester"
    assert room.said == ["socket: waiting for its program to connect"]


def test_one_program_is_one_robot(room: Room) -> None:
    room.program()
    team = form_team(["scout", "scout"], ["socket", "socket"], guests=GuestConfig(programs=room.robots))
    with pytest.raises(HthorError, match="'socket' is one program, but several robots have it"):
        room.robots.check_team(team)


def test_elsewhere_there_is_nothing_to_connect_to() -> None:
    with pytest.raises(AgentError, match="connects to a session of 'hthor live'"):
        Guest("socket:mine").load()
    done = CliRunner().invoke(cli, ["eval", "--agent", "socket"])
    assert isinstance(done.exception, AgentError)
    assert "cmd:PROGRAM ARGS" in str(done.exception)
    with pytest.raises(HthorError, match="a program that you start yourself"):
        form_team(["scout"], ["socket"], guests=GuestConfig(inputs=AgentInputs(args={"speed": "2"})))
