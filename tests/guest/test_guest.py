"""A submitted agent can do what it likes in its own process: it gets what it may, and every fault ends as one."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hthor.errors import AgentError
from hthor.guest import Guest, GuestFault, GuestPool, load_info
from hthor.guest.host.trial_exchange import TrialExchange
from hthor.guest.protocol import wire
from hthor.types import (
    Action,
    Message,
    Move,
    Outcome,
    Receipt,
    Send,
    ThingState,
)
from tests.redteam.agents import PIPE
from tests.support.guest_agents import BRIEFING, HEAD, Sensors, agent, living, look

Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def write(body: str, name: str = "my_agent.py") -> Path:
        path = tmp_path / name
        path.write_text(HEAD + body)
        return path

    return write


@pytest.fixture
def started(write: Write) -> Iterator[Callable[..., Guest]]:
    guests: list[Guest] = []

    def start(body: str, **options: float) -> Guest:
        guests.append(Guest(write(body), **options))
        guests[-1].begin(BRIEFING)
        return guests[-1]

    yield start
    for guest in guests:
        guest.close()


def fault(guest: Guest) -> GuestFault:
    with pytest.raises(GuestFault) as caught:
        guest.act(look())
    assert guest._process is None, "a guest that failed must be gone"
    return caught.value


def test_an_honest_agent_reads_what_it_needs_and_nothing_else_is_sent(started: Callable[..., Guest]) -> None:
    act = """
print("this is no message", flush=True)
os.write(1, b"neither is this\\n")
if observation.tick == 0:
    return Action(motion=Move(forward=float(observation.scan.ranges.min()) / 10))
picture = observation.rgb
assert picture.shape == (300, 400, 3) and picture[0, 1, 2] == 5 and (observation.rgb is picture)
assert observation.camera.size == (400, 300) and observation.camera.matrix[1, 1] == 200.0
assert observation.camera.pose.shape == (4, 4)
assert observation.detections[0].position == (1.0, 2.0, 0.8)
assert observation.receipt.status == "declined" and observation.outcome.by == "human" and observation.truth[0].open
assert observation.inbox[0].image()[0, 0] == 7
return Action(say=Send(text="Here.", object="apple", position=(1.0, 2.0, 0.8)))
"""
    guest = started(agent(act.strip()))
    senses = Sensors()
    assert guest.act(look(0, senses)) == Action(motion=Move(forward=0.25))
    assert senses.read == ["scan"]
    senses = Sensors()
    message = Message(id=3, sender="robot2", tick=1, text="hello", image=lambda: np.full((2, 2), 7))
    action = guest.act(
        look(
            1,
            senses,
            inbox=(message,),
            receipt=Receipt(message=1, status="declined", tick=4),
            outcome=Outcome(motion="move", ok=False, by="human"),
            truth=(ThingState(id="fridge", kind="fridge", position=(0, 0, 0), open=True),),
        )
    )
    assert action.say == Send(text="Here.", object="apple", position=(1.0, 2.0, 0.8))
    assert senses.read == ["rgb", "camera", "detections"]
    assert "this is no message" in guest.log
    assert "neither is this" in guest.log


def test_an_exception_is_reported_with_the_agents_own_frames(started: Callable[..., Guest]) -> None:
    caught = fault(started(agent("return self.helper()\n") + "    def helper(self):\n        return 1 / 0\n"))
    assert caught.kind == "raised"
    assert "ZeroDivisionError: division by zero" in caught.detail
    assert "my_agent.py" in caught.traceback
    assert "in helper" in caught.traceback
    assert "hthor/guest" not in caught.traceback


def test_an_exception_in_begin_is_a_fault_too(write: Write) -> None:
    with Guest(write(agent("return Action()", begin="raise KeyError('lost')"))) as guest:
        with pytest.raises(GuestFault, match="KeyError: 'lost'") as caught:
            guest.begin(BRIEFING)
        assert caught.value.kind == "raised"


@pytest.mark.parametrize(
    ("act", "kind", "told"),
    [
        ("os._exit(3)", "died", "status 3"),
        ("os._exit(0)", "died", "status 0"),
        ("os.kill(os.getpid(), 11)", "died", "SIGSEGV"),
        ("os.abort()", "died", "SIGABRT"),
        ("sys.exit(0)", "raised", "SystemExit"),
        ("return 'forward'", "wrong_type", "got str: 'forward'"),
        ("return None", "wrong_type", "NoneType"),
        ("return Action(motion=Move(forward=math.nan))", "not_finite", "Move.forward must be finite"),
        ("return Action(say=Send(text='', position=(0.0, math.inf, 0.0)))", "not_finite", "Send.position"),
        ("return Action(motion=Move(forward='fast'))", "garbage", "Expected `float`, got `str`"),
        ("return Action(say=Send(text='x' * 70000))", "oversized", "at most 65536"),
        ("return Action(motion=Open(thing='x' * 300))", "oversized", "300 characters"),
        ("os.write(WIRE, b'\\x05\\0\\0\\0hello'); return Action()", "garbage", "not a message"),
        ("os.write(WIRE, b'\\xff\\xff\\xff\\xff'); return Action()", "oversized", "4294967295"),
        ("os.close(WIRE); return Action()", "died", ""),
        ("observation.senses._get('walls'); return Action()", "garbage", "'walls'"),
    ],
)
def test_every_misdeed_is_a_fault(started: Callable[..., Guest], act: str, kind: str, told: str) -> None:
    caught = fault(started(PIPE + "WIRE = pipe().handles[1]\n" + agent(act)))
    assert (caught.kind, told in str(caught)) == (kind, True), str(caught)


def test_a_hanging_agent_is_ended_at_its_deadline(started: Callable[..., Guest]) -> None:
    guest = started(agent("print('thinking')\nwhile True: pass"), step_s=0.3, bank_s=0)
    pid = guest._process.pid if guest._process else 0
    caught = fault(guest)
    assert caught.kind == "timeout"
    assert "0.3 s" in caught.detail
    assert "thinking" in caught.log
    assert not living(pid)


def test_an_agent_that_only_talks_is_ended_too(started: Callable[..., Guest]) -> None:
    guest = started(agent("while True: print('la' * 1000)"), step_s=0.3, bank_s=0)
    caught = fault(guest)
    assert caught.kind == "timeout"
    assert len(caught.log) <= 16 << 10


def test_the_hosts_own_time_is_not_charged(started: Callable[..., Guest]) -> None:
    class Slow(Sensors):
        def rgb(self) -> Any:
            time.sleep(0.4)
            return super().rgb()

    guest = started(agent("observation.rgb\nreturn Action()"), step_s=0.3, bank_s=0)
    assert guest.act(look(senses=Slow())) == Action()


def test_a_fault_does_not_tell_what_a_clock_said(started: Callable[..., Guest]) -> None:
    guest = started(agent("time.sleep(60.0 if observation.tick else 0.3)\nreturn Action()"), step_s=0.2, bank_s=0.4)
    guest.act(look())
    with pytest.raises(GuestFault) as fault:
        guest.act(look(1))
    assert fault.value.detail == "the agent gave no answer within 0.2 s and what was left of 0.4 s more"


class Slow:
    """Stands for the channel to an agent that takes so many seconds over each answer, on a clock of its own."""

    def __init__(self, *takes: float) -> None:
        self.takes = list(takes)
        self.granted: list[float] = []

    def send(self, message: object, seconds: float, allowed: str) -> float:
        self.granted.append(seconds)
        return seconds

    def receive(self, seconds: float, allowed: str) -> tuple[object, float]:
        return wire.Acted(action=Action()), seconds - self.takes.pop(0)


def test_a_step_has_its_own_time_and_what_is_left_in_the_bank() -> None:
    channel: Any = Slow(0.0, 2.0, 0.5, 1.25, 0.0)
    exchange = TrialExchange(channel, step_s=0.5, bank_s=2.5, ahead=False, window=None)
    for tick in range(5):
        assert exchange.act(look(tick)) == Action()
    assert channel.granted == [3.0, 3.0, 1.5, 1.5, 0.75]


@pytest.mark.nightly
def test_a_slow_step_is_paid_for_from_the_bank(started: Callable[..., Guest]) -> None:
    guest = started(agent("time.sleep(2.0 if observation.tick else 0)\nreturn Action()"), step_s=0.5, bank_s=2.5)
    assert [guest.act(look(tick)) for tick in (0, 1, 0)] == [Action()] * 3
    with pytest.raises(GuestFault, match="timeout"):  # what is left does not reach for another
        guest.act(look(1))


def test_a_failing_sensor_is_not_the_agents_fault(started: Callable[..., Guest]) -> None:
    guest = started(agent("observation.depth\nreturn Action()"))
    with pytest.raises(ValueError, match="no picture today"):
        guest.act(look())


def test_an_old_observation_cannot_be_read(started: Callable[..., Guest]) -> None:
    guest = started(agent("self.old.scan\nreturn Action()", begin="self.old = None").replace("self.old.scan", KEEP))
    guest.act(look(0))
    caught = fault(guest)
    assert "StaleObservation" in caught.detail


KEEP = "self.old.scan if self.old else None; self.old = observation"


def test_after_a_fault_the_next_trial_starts_afresh(started: Callable[..., Guest]) -> None:
    guest = started(agent("if observation.tick: return 1 / 0\nreturn Action()"))
    assert guest.act(look(0)) == Action()
    with pytest.raises(GuestFault, match="ZeroDivisionError"):
        guest.act(look(1))
    with pytest.raises(GuestFault, match="no trial"):
        guest.act(look(2))
    guest.begin(BRIEFING)
    assert guest.act(look(0)) == Action()


COUNTER = "SEEN = []\n" + agent("SEEN.append(1)\nreturn Action(motion=Wait(seconds=float(len(SEEN))))")


@pytest.mark.parametrize("persistent", [False, True])
def test_nothing_leaks_from_one_trial_to_the_next(started: Callable[..., Guest], persistent: bool) -> None:
    body = COUNTER.replace("class Agent:", "class Agent:\n    persistent = True" if persistent else "class Agent:")
    guest = started(body)
    for _ in range(2):
        guest.act(look())
    guest.begin(BRIEFING)
    expected = 3.0 if persistent else 1.0
    assert guest.act(look()).motion.seconds == expected  # type: ignore[union-attr]


def test_what_is_asked_for_is_told_without_importing_the_file(write: Write) -> None:
    path = write(
        '"""Doc."""\n'
        + agent("return Action()").replace(
            "class Agent:", "class Agent:\n    privileges = ('ideal_detector',)\n    robots = ['scout']"
        )
    )
    info = load_info(path)
    assert (info.name, info.privileges, info.robots, info.absent) == (
        "my_agent",
        ("ideal_detector",),
        ("scout",),
        False,
    )
    assert len(info.sha256) == 64


def test_the_environment_is_small(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SECRET_SALT", "pepper")
    with Guest(write(agent("print(sorted(os.environ)); return Action()"))) as guest:
        guest.begin(BRIEFING)
        guest.act(look())
        assert "PATH" in guest.log
        assert "SECRET_SALT" not in guest.log


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("def begin(:\n", r"my_agent.py:3: "),
        ("import no_such_module_at_all\n", "No module named 'no_such_module_at_all'"),
        ("x = 1\n", "no agent class found. Define 'class Agent'"),
        ("class A:\n def begin(s, b): ...\n def act(s, o): ...\nclass B(A): ...\n", r"several agent classes: A, B.*:A"),
        (agent("return Action()") + "    privileges = 'ideal_detector'\n", "must be a tuple of names"),
        (agent("return Action()") + "    privileges = ('x_ray',)\n", "names 'x_ray'. Valid: house_map"),
        ("sys.exit(4)\n", "SystemExit"),
        ("os._exit(4)\n", "exited with status 4"),
    ],
)
def test_a_file_that_does_not_follow_the_contract_is_refused(write: Write, body: str, told: str) -> None:
    with pytest.raises(AgentError, match=told):
        load_info(write(body))


def test_a_missing_file_and_a_missing_class_are_refused(write: Write, tmp_path: Path) -> None:
    with pytest.raises(AgentError, match="cannot read the agent's file"):
        load_info(tmp_path / "nobody.py")
    path = write("class A:\n def begin(s, b): ...\n def act(s, o): ...\nclass B(A): ...\n")
    assert load_info(f"{path}:B").name == "my_agent:B"
    with pytest.raises(AgentError, match=r"no agent class 'C'.*Found: A, B"):
        load_info(f"{path}:C")


def test_an_endless_import_is_refused(write: Write) -> None:
    with pytest.raises(AgentError, match="timeout"):
        load_info(write("while True: pass\n"), start_s=0.5)


def test_an_idle_guest_is_reused_for_the_very_same_agent_and_settings(write: Write) -> None:
    path, pool = write(COUNTER), GuestPool()

    def play(**options: Any) -> tuple[int, float]:
        with Guest(path, pool=pool, **options) as guest:
            guest.begin(BRIEFING)
            for _ in range(2):
                seconds = guest.act(look()).motion.seconds  # type: ignore[union-attr]
            return guest.pid, seconds

    first, second = play(), play()
    assert first == second, "the same supervisor, and nothing is left of the trial before"
    assert play(memory_mb=1000)[0] != first[0], "other terms"
    write(COUNTER + "# changed\n")
    assert play()[0] != first[0], "another file"
    assert len(pool.pids()) == 3
    with Guest(path, pool=pool) as guest:
        guest.begin(BRIEFING)
        waited = guest.pid
        os.kill(waited, 9)
        ends = (guest.act(look()) for _ in range(1000))  # its namespaces go with it, which takes a moment
        with pytest.raises(GuestFault, match="killed"):
            list(ends)
    assert not living(waited)
    pool.close()
    assert not living(first[0])
    play()
    assert not pool.pids(), "a closed pool keeps none"
