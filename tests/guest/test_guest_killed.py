"""Whichever process of a guest is killed from outside, at every level, the fault says that, and not that it failed."""

from __future__ import annotations

import contextlib
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from hthor.errors import KILLED, AgentKilled
from hthor.guest import Guest, GuestConfig, GuestFault
from hthor.guest.host import guest, startup
from hthor.guest.host.process import GuestProcess
from hthor.guest.process_tools import cleanup
from tests.support.guest_agents import (
    HEAD,
    PROCESS_CHAINS,
    agent,
    expect_gone,
    look,
    needs_bwrap,
    process_chain,
    start_trial,
)


@pytest.mark.parametrize(("level", "size"), PROCESS_CHAINS)
def test_a_process_killed_from_outside_is_told_as_such(level: str, size: int, tmp_path: Path):
    for place in range(size):
        with start_trial(tmp_path / "agent.py", level) as guest:
            assert guest._process is not None
            line = process_chain(guest._process.pid)
            assert len(line) == size
            os.kill(line[place], signal.SIGKILL)
            with pytest.raises(GuestFault, match="killed by SIGKILL") as caught:
                guest.act(look())
            assert caught.value.kind == KILLED
            expect_gone(line)


@pytest.mark.parametrize("level", [level for level, _ in PROCESS_CHAINS[:2]] + [pytest.param("L3", marks=needs_bwrap)])
def test_one_killed_while_it_starts_costs_no_level(level: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    real: Callable[..., GuestProcess] = startup.process.start_process

    def start(*words: object, **more: object) -> GuestProcess:
        one = real(*words, **more)
        bubblewrap = level == "L3"
        while bubblewrap and len(process_chain(one.pid)) < 2:
            time.sleep(0.001)
        for pid in process_chain(one.pid)[:2] if bubblewrap else [one.pid]:  # early on, its second outlives its first
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        return one

    (tmp_path / "agent.py").write_text(HEAD + agent("return Action()"))
    with monkeypatch.context() as patch:
        patch.setattr(startup.process, "start_process", start)
        with pytest.raises(AgentKilled, match=r"agent\.py: its process was killed by SIGKILL while it started"):
            Guest(tmp_path / "agent.py", config=GuestConfig(isolation=level)).load()
    with Guest(tmp_path / "agent.py", config=GuestConfig(isolation=level)) as guest:
        assert guest.load().isolation.level == level


def test_one_killed_while_it_loads_its_file_is_told_as_such(tmp_path: Path):
    path = tmp_path / "agent.py"
    path.write_text("import os\nos.kill(os.getpid(), 9)\n")
    with pytest.raises(AgentKilled, match=r"loading it failed \(killed: the agent's process was killed by SIGKILL\)"):
        guest.load_info(path, config=GuestConfig(isolation="L1"))


@pytest.mark.parametrize(
    ("code", "kind", "words"),
    [
        (0, "died", "exited with status 0"),
        (9, "died", "exited with status 9"),
        (-signal.SIGTERM, KILLED, "killed by SIGTERM"),
        (-signal.SIGSEGV, "died", "killed by SIGSEGV"),
        (-40, "died", "killed by signal 40"),
    ],
)
def test_what_an_agent_does_to_itself_is_its_own(code: int, kind: str, words: str):
    assert cleanup.describe_exit(code) == (kind, words)


def test_bubblewraps_words_for_a_signal_are_understood():
    assert cleanup.describe_exit(cleanup.unwrap_bwrap(137)) == (KILLED, "killed by SIGKILL")
    assert cleanup.unwrap_bwrap(3) == 3
