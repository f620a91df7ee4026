"""Sessions whose server or pages are killed: the same command goes on, and nothing is lost or doubled."""

from __future__ import annotations

import functools
import random
import time
from pathlib import Path
from typing import Any

import pytest
from live_command import Command
from live_session import AGENT
from steady_person import SteadyPerson

from hthor import installation
from hthor.eval.records.run_folder import RunFolder
from hthor.live.unfinished import INTERRUPTED, NAME

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")


@pytest.fixture
def teller(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    agent = tmp_path / "teller.py"
    agent.write_text(AGENT, encoding="utf-8")
    return agent


@pytest.mark.parametrize(
    ("times", "trials"), [pytest.param(1, 1, id="once"), pytest.param(10, 4, id="ten times", marks=pytest.mark.nightly)]
)
def test_a_killed_server_and_lost_pages_cost_nothing_but_the_trial(
    times: int, trials: int, teller: Path, tmp_path: Path
) -> None:
    moments = random.Random(times)
    with (
        Command(tmp_path / "run", agent=teller, limit=trials) as command,
        SteadyPerson(command.address, command.token) as person,
    ):
        token = command.token
        for kill in range(times):
            command.wait_until(functools.partial(_has_begun, person, kill + 1))
            command.wait_until((tmp_path / "run" / NAME).exists)
            time.sleep(moments.uniform(0.0, 1.0))
            command.kill()
            command.start()
            assert command.token == token, "the page finds its seat again"
        for _ in range(times):
            command.wait_until(functools.partial(_has_begun, person, times + 1))
            time.sleep(moments.uniform(0.0, 0.3))
            person.drop_page()
        command.wait_until(lambda: person.over)
        command.finish()
    _check_whole(tmp_path / "run", trials)
    voided = RunFolder(tmp_path / "run").voided
    assert {one.reason for one in voided} == {INTERRUPTED}, "a page that comes back at once is in its trial"
    assert command.said.count("was interrupted after") == len(voided) <= times
    assert not list((installation.cache() / "live" / "tokens").iterdir()), "tokens are forgotten with the session"


def _has_begun(person: SteadyPerson, times: int) -> bool:
    return len(person.begun) >= times


def _check_whole(folder: Path, trials: int) -> None:
    """Every trial has one attempt that counts, and the others before it, numbered and voided."""
    run = RunFolder(folder)
    attempts: dict[int, list[Any]] = {}
    for record in run.attempts():
        attempts.setdefault(record.spec.index, []).append(record)
    assert sorted(attempts) == list(range(trials))
    for some in attempts.values():
        assert [one.spec.attempt or 0 for one in some] == list(range(len(some)))
        assert [bool(one.log.voided) for one in some] == [True] * (len(some) - 1) + [False]
        assert some[-1].log.ticks == 900
        assert some[-1].log.ratings == {"human": 5}
    assert len(run.records()) == trials
    assert not (folder / NAME).exists()
    assert run.result_file.exists()
