"""`hthor live` as a function: a run like any other, which is resumed inside its session."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import pytest
from live_client import ScriptedPerson

from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.eval.runner.progress import Silent
from hthor.live import house_file
from hthor.live.run import LiveRun
from hthor.types import HUMAN

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


class Idler:
    """Somebody who begins so many trials of a run and does nothing in them."""

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
                person.wait_until(lambda count=count: len(_all(person, "ended")) >= count)  # type: ignore[misc]

    def join(self) -> list[int]:
        self._thread.join(60.0)
        return self.begun


def _all(person: ScriptedPerson, kind: str) -> list[dict[str, Any]]:
    return [one for one in person.received if one["type"] == kind]


@pytest.fixture
def no_looks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(house_file, "_make", lambda scene, house: b"")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def test_a_run_with_a_person_is_played_and_scored(tmp_path: Path, no_looks: None) -> None:
    with make_run(tmp_path / "run") as run:
        idler = Idler(run, 2)
        run.play(lambda _: Silent())
        assert idler.join() == [0, 1]
    again = make_run(tmp_path / "run")
    assert [record.log.ticks for record in again.scheduled.folder.played()] == [900, 900]


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
