"""Two people in a trial, one or both at a page: `collect` is played to its end, and nobody forgets."""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from steady_person import SteadyPerson

from hthor.eval.config.options import EvalOptions
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner.progress import Silent
from hthor.live.gltf import house_file
from hthor.live.run import LiveRun
from hthor.live.sessions import remember
from hthor.trials import TrialRunner
from hthor.types import TrialSpec

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")

FASTER = 60.0


@pytest.fixture
def play(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Plays the first trials of `collect` with these people, and returns the run."""
    monkeypatch.setattr(house_file, "_make", lambda *_: b"")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def run(humans: str, trials: int) -> RunFolder:
        options = EvalOptions(
            agent=("none",), humans=(humans,), kind="collect", limit=trials, out=tmp_path / humans.replace(",", "-")
        )
        with (
            LiveRun(
                options,
                page=False,
                now=lambda: FASTER * time.perf_counter(),
                sleep=lambda seconds: time.sleep(seconds / FASTER),
            ) as live,
            ExitStack() as people,
        ):
            for token in live.server.tokens.values():
                people.enter_context(SteadyPerson(live.server.address, token))
            return live.play(lambda _: Silent()).folder

    return run


def test_two_people_at_pages_play_collect_to_the_end(play: Any) -> None:
    (record,) = play("live,live", 1).played()
    assert record.log.ticks == 900
    assert all(len({pose[:2] for pose in path}) > 10 for path in record.log.paths.values()), "both have walked"


def test_a_simulated_person_beside_somebody_at_a_page_remembers_after_a_restart(
    play: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    states: dict[int, Mapping[str, Any]] = {}
    make = TrialRunner.make_people

    def spied(self: TrialRunner, trial: TrialSpec, known: Any = None) -> Any:
        states[trial.index] = dict(known or {})
        return make(self, trial, known)

    monkeypatch.setattr(TrialRunner, "make_people", spied)
    first, second = play("live,proxy", 2).played()
    assert first.log.ticks == second.log.ticks == 900
    assert states[1]["human2"]["trials"] == 1
    assert remember(TrialRunner(), [first], {})["human2"] == states[1]["human2"]


def test_a_session_has_the_people_of_one_trial(tmp_path: Path) -> None:
    options = EvalOptions(agent=("none",), humans=("live,live",), kind="collect", out=tmp_path / "run")
    with LiveRun(options, page=False) as live:
        (session,) = live.scheduled.sessions
    assert [human.seat for human in session.trials[0].humans] == ["human", "human2"]
