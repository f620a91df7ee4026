"""`hthor live` as a function: a run like any other, which is resumed inside its session."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import msgspec
import pytest
from live_client import ScriptedPerson
from live_session import AGENT

from hthor.errors import HthorError
from hthor.eval.config import cli_command
from hthor.eval.config.options import EvalOptions
from hthor.eval.records import find
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.replay import session_history
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner.progress import Silent
from hthor.eval.runner.run_job import RunJob
from hthor.live.gltf import house_file
from hthor.live.run import LiveRun
from hthor.live.run_book import RunBook
from hthor.report.page import camera_frames
from hthor.trials.sessions import Session
from hthor.types import HUMAN, TrialSpec
from hthor.watch import record_trial

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")

FASTER = 60.0


def make_run(folder: Path, **options: Any) -> LiveRun:
    chosen = {"agent": ("none",), "humans": ("live",), "limit": 2, "suite": "smoke", "out": folder, **options}
    return LiveRun(
        EvalOptions(**chosen),
        page=False,
        now=lambda: FASTER * time.perf_counter(),
        sleep=lambda seconds: time.sleep(seconds / FASTER),
    )


class Walker:
    """Somebody who walks in a circle in so many trials of a run, and confirms the first message of each."""

    def __init__(self, run: LiveRun, trials: int) -> None:
        self._run, self._trials = run, trials
        self.begun: list[int] = []
        self._thread = threading.Thread(target=self._sit)
        self._thread.start()

    def _sit(self) -> None:
        run = self._run
        with ScriptedPerson(run.server.address, run.server.tokens[HUMAN]) as person:
            for count in range(1, self._trials + 1):
                person.wait_until(lambda count=count: len(_all(person, "trial")) >= count)  # type: ignore[misc]
                self.begun.append(_all(person, "trial")[-1]["trial"])
                person.send({"type": "begin", "trial": self.begun[-1]})
                person.drive(forward=0.5, yaw=0.7 * count, pitch=-0.1)
                person.wait_until(lambda count=count: len(_shown(person)) >= count)  # type: ignore[misc]
                person.act(say={"type": "reply", "message": _shown(person)[-1]["message"], "accept": True})
                person.wait_until(lambda count=count: len(_all(person, "ended")) >= count)  # type: ignore[misc]
                person.send({"type": "rate", "trial": self.begun[-1], "value": 5})

    def join(self) -> list[int]:
        self._thread.join(60.0)
        return self.begun


def _all(person: ScriptedPerson, kind: str) -> list[dict[str, Any]]:
    return [one for one in person.received if one["type"] == kind]


def _shown(person: ScriptedPerson) -> list[dict[str, Any]]:
    return [one for one in _all(person, "panel") if one["message"] is not None]


@pytest.fixture
def no_looks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(house_file, "_make", lambda *_: b"")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trials of two seconds."""
    whole = RunJob.sessions.fget  # type: ignore[attr-defined]

    def cut(trial: TrialSpec) -> TrialSpec:
        return msgspec.structs.replace(trial, task=msgspec.structs.replace(trial.task, time_limit=2.0))

    def sessions(run: RunJob) -> tuple[Session, ...]:
        return tuple(msgspec.structs.replace(one, trials=tuple(map(cut, one.trials))) for one in whole(run))

    monkeypatch.setattr(RunJob, "sessions", property(sessions))


def test_a_run_with_a_person_is_played_and_scored(tmp_path: Path, no_looks: None) -> None:
    agent = tmp_path / "teller.py"
    agent.write_text(AGENT, encoding="utf-8")
    with make_run(tmp_path / "run", agent=(str(agent),)) as run:
        walker = Walker(run, 2)
        run.play(lambda _: Silent())
        assert walker.join() == [0, 1]
    folder = RunFolder(tmp_path / "run")
    for record in folder.played():
        assert record.log.ticks == 900
        assert record.log.ratings == {HUMAN: 5}
        again = session_history.rerun_trial(folder, record, RunFiles())
        assert again.same, "everybody's inputs give the trial again, without the agent's file"
    seen = camera_frames.film_trial(folder.path, record, {40}, RunFiles(), seats=(HUMAN,), height=48)
    assert seen.views()[40][HUMAN].shape[0] == 48
    watched = record_trial.record_trial(folder.path, folder.played()[1], RunFiles()).recording
    assert [(seat.name, seat.fov is None) for seat in watched.seats] == [("live", True), ("scout, teller", False)]
    assert watched.screens[HUMAN][-1].map == (0,)
    check_corrections(folder)
    again_words = cli_command.resume_command(folder.path, run.scheduled.config)
    assert again_words.startswith("hthor live --agent ")
    assert "--clock" not in again_words


def check_corrections(folder: RunFolder) -> None:
    """What the experimenter's page shows of an adoption is what is recorded."""
    book = RunBook()
    book.open(folder)
    (first, _) = book.played()
    assert first.adopted == {HUMAN: True}
    with pytest.raises(HthorError, match=r"needs a reason; write one"):
        book.correct(first.key, HUMAN, True, " ")
    for adopted in (False, None):
        book.correct(first.key, HUMAN, adopted, "pressed the wrong button")
        assert book.played()[0].adopted == {HUMAN: adopted}


def test_a_trial_that_the_experimenter_voids_afterwards_is_repeated_when_the_others_are_over(
    tmp_path: Path, no_looks: None, short: None
) -> None:
    with make_run(tmp_path / "run") as run:
        desk = ScriptedPerson(run.server.address, run.server.desk_url.partition("#")[2], steers=False)
        playing = threading.Thread(target=lambda: run.play(lambda _: Silent()))
        with desk, ScriptedPerson(run.server.address, run.server.tokens[HUMAN]) as person:
            playing.start()
            for count, trial in enumerate((0, 1, 0), 1):
                person.wait_until(lambda count=count: len(_all(person, "trial")) >= count)  # type: ignore[misc]
                assert _all(person, "trial")[-1]["trial"] == trial
                if count == 2:
                    desk.wait_until(lambda: bool(_all(desk, "played")[-1]["trials"]))
                    (first,) = _all(desk, "played")[-1]["trials"]
                    desk.send({"type": "repeat", "trial": first["key"], "reason": "the doorbell rang"})
                    desk.wait_until(lambda: bool(_all(desk, "played")[-1]["trials"][0]["voided"]))
                person.send({"type": "begin", "trial": trial})
            assert desk.wait_for("plan", attempt=1)["trial"] == 0
            person.wait_for("over")
        playing.join()
    folder = RunFolder(tmp_path / "run")
    tried = [(record.spec.index, record.spec.attempt or 0, record.log.voided) for record in folder.attempts()]
    assert tried == [(0, 0, "the doorbell rang"), (0, 1, ""), (1, 0, "")]
    assert [(record.spec.index, record.spec.attempt or 0) for record in folder.records()] == [(0, 1), (1, 0)]
    book = RunBook()
    book.open(folder)
    assert book.due(0) == (), "nothing is left to play"
    watched = record_trial.record_trial(folder.path, find.find_trial(folder, "0@0"), RunFiles()).recording
    assert watched.outcome[0] == "void: the doorbell rang"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"humans": ("proxy",)}, "nobody in it takes part at a page"),
        ({"agent": ("none", "frontier")}, "one --agent"),
    ],
)
def test_what_no_session_can_be_made_of_is_refused(tmp_path: Path, options: dict[str, Any], words: str) -> None:
    with pytest.raises(HthorError, match=words):
        make_run(tmp_path / "run", **options)
