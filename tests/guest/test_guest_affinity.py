"""An evaluation and its guest take turns on one CPU, unless the guest has use for more."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import levels
import pytest

from hthor.guest import Guest, GuestConfig
from hthor.guest.process_tools import cpu_affinity
from hthor.types import Action, Observation, Pose, Send
from tests.support.guest_agents import BRIEFING

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="only Linux lets a process choose its CPUs"),
    pytest.mark.skipif(
        sys.platform == "linux" and len(os.sched_getaffinity(0)) < 2, reason="there is one CPU, shared anyway"
    ),
]
SAYS_WHERE = """
import os
from hthor.types import Action, Send

class Agent:
    def begin(self, briefing):
        pass

    def act(self, observation):
        return Action(say=Send(text=" ".join(str(cpu) for cpu in sorted(os.sched_getaffinity(0)))))
"""
SEVERAL_THREADS = SAYS_WHERE.replace(
    "        pass",
    "        import threading, time\n        threading.Thread(target=time.sleep, args=(60,), daemon=True).start()",
)
KEEPS_ITS_PROCESS = SAYS_WHERE.replace("class Agent:", "class Agent:\n    persistent = True")
LOOK = Observation(tick=0, pose=Pose(x=0.0, y=0.0, yaw=0.0), idle=True, senses=None)  # type: ignore[arg-type]


@pytest.fixture(autouse=True)
def _free() -> Iterator[None]:
    """Every test starts on all CPUs, and is to end so."""
    before = os.sched_getaffinity(0)
    yield
    assert os.sched_getaffinity(0) == before


def _where(action: Action) -> set[int]:
    assert isinstance(action.say, Send)
    return {int(word) for word in action.say.text.split()}


def _soon(guest: Guest, wanted: set[int]) -> bool:
    """Whether the guest comes to run there; its supervisor moves it during the trial."""
    for _ in range(200):
        if _where(guest.act(LOOK)) == wanted:
            return True
        time.sleep(0.02)
    return False


@pytest.mark.parametrize(
    ("level", "source"),
    [("L2", SAYS_WHERE), ("L3", SAYS_WHERE), ("L2", KEEPS_ITS_PROCESS)],
    ids=["L2", "L3", "it keeps its process"],
)
def test_they_take_turns_on_one_cpu_and_part_after_each_trial(tmp_path: Path, level: str, source: str) -> None:
    levels.need(level)
    agent = tmp_path / "agent.py"
    agent.write_text(source)
    everywhere = os.sched_getaffinity(0)
    with Guest(agent, config=GuestConfig(isolation=level)) as guest:
        for _ in range(2):
            guest.begin(BRIEFING)
            here = os.sched_getaffinity(0)
            assert len(here) == 1
            assert _soon(guest, here)
            guest.finish()
            assert os.sched_getaffinity(0) == everywhere


def test_a_guest_with_threads_runs_everywhere(tmp_path: Path) -> None:
    agent = tmp_path / "agent.py"
    agent.write_text(SEVERAL_THREADS)
    everywhere = os.sched_getaffinity(0)
    with Guest(agent, config=GuestConfig(isolation="L2")) as guest:
        guest.begin(BRIEFING)
        assert _soon(guest, everywhere)


def test_an_agent_that_may_start_processes_is_left_alone(tmp_path: Path) -> None:
    agent = tmp_path / "agent.py"
    agent.write_text(SAYS_WHERE)
    everywhere = os.sched_getaffinity(0)
    with Guest(agent, config=GuestConfig(isolation="L1")) as guest:
        guest.begin(BRIEFING)
        assert os.sched_getaffinity(0) == everywhere
        assert _where(guest.act(LOOK)) == everywhere


def test_two_guests_share_the_place_and_what_starts_meanwhile_is_free(tmp_path: Path) -> None:
    agent = tmp_path / "agent.py"
    agent.write_text(SAYS_WHERE)
    everywhere = os.sched_getaffinity(0)
    with (
        Guest(agent, config=GuestConfig(isolation="L2")) as one,
        Guest(agent, config=GuestConfig(isolation="L2")) as other,
    ):
        one.begin(BRIEFING)
        here = os.sched_getaffinity(0)
        with cpu_affinity.unpinned():
            assert os.sched_getaffinity(0) == everywhere
        other.begin(BRIEFING)
        assert os.sched_getaffinity(0) == here
        assert _soon(one, here)
        assert _soon(other, here)
        one.finish()
        assert os.sched_getaffinity(0) == here


def test_a_guest_that_fails_or_is_forgotten_keeps_nobody(tmp_path: Path) -> None:
    agent = tmp_path / "agent.py"
    agent.write_text(SAYS_WHERE)
    everywhere = os.sched_getaffinity(0)
    guest = Guest(agent, config=GuestConfig(isolation="L2"))
    guest.begin(BRIEFING)
    assert os.sched_getaffinity(0) != everywhere
    del guest
    assert os.sched_getaffinity(0) == everywhere


def test_other_threads_go_where_they_like() -> None:
    everywhere, seen = os.sched_getaffinity(0), []
    started = threading.Event()

    def other() -> None:
        started.wait()
        seen.append(os.sched_getaffinity(0))

    thread = threading.Thread(target=other)
    thread.start()
    assert cpu_affinity.pin_thread() >= 0
    started.set()
    thread.join()
    cpu_affinity.unpin_thread()
    cpu_affinity.unpin_thread()
    assert seen == [everywhere]
