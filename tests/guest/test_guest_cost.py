"""What guests spend is counted, though no parent collects what they took."""

from __future__ import annotations

import os
from pathlib import Path

import levels
import pytest

from hthor.guest import Guest, GuestConfig, GuestPool
from hthor.guest.process_tools import resource_usage
from tests.support.guest_agents import BRIEFING, look

BURNS = """
import time
from hthor.types import Action
class Agent:
    def begin(self, briefing):
        pass
    def act(self, observation):
        end = time.process_time() + 0.3
        while time.process_time() < end:
            pass
        return Action()
"""


def spent() -> float:
    times = os.times()
    return times.children_user + times.children_system + resource_usage.uncollected_cpu_s()


@pytest.mark.parametrize("level", levels.EVERY)
def test_the_processor_time_of_guests_is_counted_once(level: str, tmp_path: Path) -> None:
    levels.need(level)
    path = tmp_path / "burns.py"
    path.write_text(BURNS)
    with Guest(path, config=GuestConfig(isolation=level)) as mind:
        mind.begin(BRIEFING)
        before = spent()
        for tick in range(2):
            mind.act(look(tick))
        taken = resource_usage.cpu_s(mind.pid)
        assert resource_usage.resident_mb(mind.pid) > 5
    assert 0.55 <= spent() - before <= taken + 0.3


def test_the_processor_time_of_an_idle_guest_is_counted_once(tmp_path: Path) -> None:
    path = tmp_path / "burns.py"
    path.write_text(BURNS)
    pool = GuestPool()
    before = spent()
    with Guest(path, pool=pool) as mind:
        mind.begin(BRIEFING)
        mind.act(look())
    (pid,) = pool.pids()
    idle = spent() - before
    assert 0.3 <= idle <= resource_usage.cpu_s(pid) + 0.05
    pool.close()
    assert idle - 0.02 <= spent() - before <= idle + 0.3
