"""A guest plays from any thread: it outlives the thread that started it, and its trial can be ended from another."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

import levels
import msgspec
import numpy as np
import pytest

from hthor.guest import Guest, GuestConfig, GuestFault, GuestPool, TrialStopped
from hthor.guest.process_tools import lasting_thread
from hthor.types import Action, Detection, Scan, Send, Wait
from tests.support.guest_agents import BRIEFING, HEAD, Sensors, agent, expect_gone, living, look

_T = TypeVar("_T")
ROOT = Path(__file__).resolve().parents[2]
SAYS_TICK = "return Action(motion=Wait(seconds=observation.tick + 1.0))"
SLEEPS = "time.sleep(30.0 if observation.tick else 0.0)\n" + SAYS_TICK


def in_a_thread(call: Callable[[], _T]) -> _T:
    """The result of a call in a thread of its own, which has ended when this returns."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(call).result()


@pytest.fixture
def make(tmp_path: Path) -> Iterator[Callable[..., Guest]]:
    guests: list[Guest] = []

    def made(act: str, level: str = "L2", head: str = "", **options: Any) -> Guest:
        path = tmp_path / "my_agent.py"
        path.write_text(HEAD + agent(act).replace("class Agent:", f"class Agent:\n    {head or 'pass'}"))
        guests.append(Guest(path, config=GuestConfig(isolation=levels.need(level)), **options))
        return guests[-1]

    yield made
    for guest in guests:
        guest.close()


@pytest.mark.parametrize("level", levels.EVERY)
def test_every_step_may_come_from_another_thread(level: str, make: Callable[..., Guest]) -> None:
    guest = make(SAYS_TICK, level)
    in_a_thread(guest.load)
    pid = guest.pid
    for _ in range(2):
        in_a_thread(lambda: guest.begin(BRIEFING))
        for tick in range(3):
            time.sleep(0.02)  # time for whatever ends with the thread
            assert in_a_thread(lambda tick=tick: guest.act(look(tick))) == Action(motion=Wait(seconds=tick + 1.0))
    assert guest.pid == pid, "it had to be started again"
    in_a_thread(guest.close)
    assert not living(pid)


@pytest.mark.parametrize("level", levels.EVERY)
def test_it_sees_the_moment_that_was_shown_while_the_world_goes_on(level: str, make: Callable[..., Guest]) -> None:
    """Two agents in a thread each, while the main thread counts on; the readings come late, and in several steps."""
    act = """
time.sleep(0.03)
distance = observation.detections[0].distance
time.sleep(0.03)
seen = {observation.tick, int(distance), int(observation.scan.limit), int(observation.depth[0, 0])}
return Action(say=Send(text=str(seen)))
"""
    world = [0]
    said: dict[str, list[Action]] = {}

    def play(seat: str, guest: Guest) -> None:
        guest.begin(BRIEFING)
        said[seat] = [guest.act(look(tick, Frozen(tick))) for tick in (world[0], world[0] + 7)]

    pool = GuestPool()
    seats = {seat: make(act.strip(), level, pool=pool) for seat in ("robot", "robot2")}
    threads = [threading.Thread(target=play, args=each) for each in seats.items()]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        world[0] += 1
        time.sleep(0.001)
    for actions in said.values():
        for action in actions:
            assert isinstance(action.say, Send)
            assert "," not in action.say.text, "it has read another moment"
    for guest in seats.values():
        guest.close()
    assert len(pool.pids()) == 2
    pool.close()


class Frozen(Sensors):
    """Sensors of one tick."""

    def __init__(self, tick: int) -> None:
        super().__init__()
        self.tick = tick

    def detections(self) -> tuple[Detection, ...]:
        (apple,) = super().detections()
        return (msgspec.structs.replace(apple, distance=float(self.tick)),)

    def scan(self) -> Scan:
        return Scan(origin=look().pose, bearings=np.zeros(1), ranges=np.zeros(1), limit=float(self.tick))

    def depth(self) -> Any:
        return np.full((2, 2), self.tick, np.float32)


HOST = """
import os, signal, sys, threading, time
from hthor.guest import Guest, GuestConfig
from tests.support.guest_agents import BRIEFING, look, process_chain
guest = Guest(sys.argv[1], config=GuestConfig(isolation=sys.argv[2]))
thread = threading.Thread(target=lambda: guest.begin(BRIEFING))
thread.start()
thread.join()
threading.Thread(target=lambda: guest.act(look(1)), daemon=True).start()
time.sleep(0.1)
print(*process_chain(guest.pid), flush=True)
if sys.argv[3] == "killed":
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize(
    ("how", "level"),
    [
        ("done", "L1"),
        ("killed", "L3"),
        *(
            pytest.param(*one, marks=pytest.mark.nightly)
            for one in (("done", "L2"), ("done", "L3"), ("killed", "L1"), ("killed", "L2"))
        ),
    ],
)
def test_it_ends_with_the_evaluation_though_a_thread_started_it(how: str, level: str, tmp_path: Path) -> None:
    levels.need(level)
    path = tmp_path / "my_agent.py"
    path.write_text(HEAD + agent(SLEEPS))
    words = [sys.executable, "-c", HOST, str(path), level, how]
    found = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=900, check=False)
    pids = [int(word) for word in found.stdout.split()]
    assert len(pids) >= 3, found.stderr
    expect_gone(pids)


def test_deadlines_hold_in_a_thread_while_the_main_thread_computes(make: Callable[..., Guest]) -> None:
    guest = make(SLEEPS, step_s=0.3, bank_s=0.2)
    in_a_thread(lambda: guest.begin(BRIEFING))
    began, caught = time.monotonic(), list[BaseException]()

    def act() -> None:
        try:
            guest.act(look(1))
        except GuestFault as fault:
            caught.append(fault)

    thread = threading.Thread(target=act)
    thread.start()
    while thread.is_alive() and time.monotonic() < began + 20:
        sum(range(1000))
    assert [getattr(one, "kind", "") for one in caught] == ["timeout"]
    in_a_thread(lambda: guest.begin(BRIEFING))
    assert guest.act(look()) == Action(motion=Wait(seconds=1.0))


@pytest.mark.parametrize("level", levels.EVERY)
@pytest.mark.parametrize("ends", ["finish", "begin", "close"])
def test_a_trial_ends_while_its_agent_still_decides(level: str, ends: str, make: Callable[..., Guest]) -> None:
    guest = make(SLEEPS, level, pool=GuestPool())
    guest.begin(BRIEFING)
    pid, began = guest.pid, time.monotonic()
    with ThreadPoolExecutor(1) as pool:
        deciding = pool.submit(guest.act, look(1))
        time.sleep(0.1)
        assert not deciding.done()
        getattr(guest, ends)(*([BRIEFING] if ends == "begin" else []))
        with pytest.raises(TrialStopped, match="while the agent still decided"):
            deciding.result()
    assert time.monotonic() - began < 25.0, "it was waited for"
    if ends != "begin":
        with pytest.raises(GuestFault, match="no trial"):
            guest.act(look())
        guest.begin(BRIEFING)
    assert guest.act(look()) == Action(motion=Wait(seconds=1.0))
    assert guest.pid == pid, "its supervisor had to be started again"


def test_an_agent_that_keeps_its_process_completes_its_step(make: Callable[..., Guest]) -> None:
    guest = make("time.sleep(0.4)\n" + SAYS_TICK, head="persistent = True")
    guest.begin(BRIEFING)
    pid = guest.pid
    with ThreadPoolExecutor(1) as pool:
        deciding = pool.submit(guest.act, look(1))
        time.sleep(0.1)
        guest.finish()
        assert deciding.result(20) == Action(motion=Wait(seconds=2.0))
    guest.begin(BRIEFING)
    assert guest.act(look()) == Action(motion=Wait(seconds=1.0))
    assert guest.pid == pid


@pytest.mark.skipif(sys.platform != "linux" or len(os.sched_getaffinity(0)) < 2, reason="needs a choice of CPUs")
def test_threads_do_not_share_a_cpu_with_their_guests(make: Callable[..., Guest]) -> None:
    """Also if the main thread began the trial, and the other thread inherited its one CPU."""
    everywhere = os.sched_getaffinity(0)
    where = "return Action(say=Send(text=' '.join(str(cpu) for cpu in sorted(os.sched_getaffinity(0)))))"
    guest = make(where)
    guest.begin(BRIEFING)
    assert len(os.sched_getaffinity(0)) == 1

    def play() -> tuple[Any, set[int]]:
        for _ in range(100):
            said: Any = guest.act(look()).say
            if len(said.text.split()) > 1:
                break
            time.sleep(0.02)
        return said.text, os.sched_getaffinity(0)

    text, mine = in_a_thread(play)
    assert {int(word) for word in text.split()} == everywhere == mine == os.sched_getaffinity(0)
    guest.finish()
    in_a_thread(lambda: guest.begin(BRIEFING))
    assert os.sched_getaffinity(0) == everywhere
    assert in_a_thread(play) == (text, everywhere)


def test_a_call_in_the_lasting_thread_is_like_any_call() -> None:
    def fail() -> None:
        raise KeyError("lost")

    names = [in_a_thread(lambda: lasting_thread.run_in_lasting_thread(threading.get_ident)) for _ in range(3)]
    assert len(set(names)) == 1
    assert names[0] not in (threading.get_ident(),)
    assert lasting_thread.run_in_lasting_thread(threading.get_ident) == threading.get_ident()
    with pytest.raises(KeyError, match="lost"):
        in_a_thread(lambda: lasting_thread.run_in_lasting_thread(fail))
    assert in_a_thread(lambda: lasting_thread.run_in_lasting_thread(lambda: 7)) == 7
