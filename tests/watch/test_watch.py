"""`hthor watch`: what is recorded is what was played, and a browser shows it from a folder without asking anybody."""

from __future__ import annotations

import gzip
import json
import math
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import accumulate
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from live_browser import CHROMIUM, launch
from practice_trials import play_in_practice_room
from typer.testing import CliRunner

from hthor import rules
from hthor.cli import app
from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import find
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.replay import repeated_trial
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner import experiment, progress
from hthor.live import server, wire
from hthor.types import HUMAN, Goal
from hthor.types.events import Accepted, Picked, Sent
from hthor.watch import page, page_server, record_trial, recording
from hthor.watch.record_trial import RecordedTrial

pytestmark = pytest.mark.usefixtures("no_workers")

SECONDS = 20.0
MOST_BYTES = 5_000_000
FULL_HOUSE = 2_850_000
"""[bytes] The largest house that hthor's and the sample houses make, compressed."""
TRIAL = "0"

built = pytest.mark.skipif(not (server.FOLDER / page.TEMPLATE).exists(), reason="the page is not built: make page")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of one trial in the room of the practice: the oracle tells a person where the apple is."""
    out = tmp_path_factory.mktemp("watch") / "run"
    with pytest.MonkeyPatch.context() as patch:
        play_in_practice_room(patch, SECONDS, Goal(target="apple", relation="in", destination="fridge"))
        options = EvalOptions(
            agent=("oracle",), suite="smoke", participants=1, limit=1, jobs=1, seed=2, out=out, control=False
        )
        list(experiment.run_experiment(resolve(options), lambda _: progress.Silent()))
    return out


@pytest.fixture(scope="module")
def record(run: Path) -> ScoredTrial:
    return find.find_trial(RunFolder(run), TRIAL)


@pytest.fixture(scope="module")
def trial(run: Path, record: ScoredTrial) -> RecordedTrial:
    return record_trial.record_trial(run, record, RunFiles())


class Observer:
    """A world that keeps every pose, as the page of a living person would be told them."""

    def __init__(self, world: Any) -> None:
        self._world, self.poses = world, list[Any]()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def reset(self, task: Any, seed: int = 0) -> None:
        self._world.reset(task, seed=seed)
        self.poses = [wire.round_poses(self._world.scene_poses())]

    def advance(self) -> Any:
        events = self._world.advance()
        self.poses.append(wire.round_poses(self._world.scene_poses()))
        return events


def test_the_recording_has_every_pose_of_every_tick(run: Path, record: ScoredTrial, trial: RecordedTrial) -> None:
    seen = np.array(repeated_trial.repeat_trial(run, record, RunFiles(), Observer).poses)
    assert len(seen) == record.ticks + 1
    found = np.zeros_like(seen)
    for track in trial.recording.tracks:
        rows = np.array([list(accumulate(column)) for column in track.poses], np.int16).T
        for tick, row in zip(accumulate(track.ticks), rows, strict=True):
            found[tick:, track.part] = row
    assert (found == seen).all()
    moving = [track for track in trial.recording.tracks if len(track.ticks) > 1]
    assert {part for seat in trial.recording.seats for part in seat.own} <= {track.part for track in moving}
    assert len(moving) < len(trial.recording.tracks), "what stands still takes one row"


def test_bodies_are_where_the_log_has_them(record: ScoredTrial, trial: RecordedTrial) -> None:
    tracks = {track.part: track for track in trial.recording.tracks}
    for seat in trial.recording.seats:
        track = tracks[seat.own[0]]
        ticks, xs, ys = (list(accumulate(one)) for one in (track.ticks, *track.poses[:2]))
        for step, (x, y, _) in enumerate(record.paths[seat.seat]):
            at = max(k for k, tick in enumerate(ticks) if tick <= 2 * step)
            assert math.dist((xs[at], ys[at]), (x, y)) < 1.5, f"{seat.seat} at tick {2 * step}, in millimetres"


def test_the_recording_says_what_happened(record: ScoredTrial, trial: RecordedTrial) -> None:
    made = trial.recording
    kinds = {line.kind for line in made.events}
    assert {"sent", "accepted", "picked"} <= kinds
    assert [line.tick for line in made.events] == sorted(line.tick for line in made.events)
    sent = [event for event in record.events if isinstance(event, Sent)]
    assert [(one.message, one.text) for one in made.messages] == [(one.message, one.text) for one in sent]
    assert all(one.picture for one in made.messages), "robots' messages have pictures"
    answer = next(event for event in record.events if isinstance(event, Accepted))
    screens = {screen.tick: screen for screen in made.screens[HUMAN]}
    assert screens[answer.tick].answer == "confirmed"
    assert screens[answer.tick].map == (answer.message,)
    picked = next(event for event in record.events if isinstance(event, Picked))
    assert (picked.tick, picked.object) in made.hands[picked.seat]
    assert made.outcome[0] == ("done" if record.met else "not done") + f" in {record.ticks / 10:.1f} s"


def test_the_same_trial_gives_the_same_bytes(run: Path, record: ScoredTrial, trial: RecordedTrial) -> None:
    again = record_trial.record_trial(run, record, RunFiles())
    assert recording.encode(again.recording) == recording.encode(trial.recording)
    assert str(run.parent).encode() not in recording.encode(trial.recording), "no path of this machine"


@built
def test_the_page_is_one_file_of_less_than_five_megabytes(trial: RecordedTrial) -> None:
    made = page.make_page(trial)
    assert made == page.make_page(trial)
    others = len(made) - 4 * len(trial.house.data) / 3
    ten_times = len(gzip.compress(recording.encode(trial.recording), 9)) * 9 * 4 / 3  # a trial ten times as long
    assert others + ten_times + 4 * FULL_HOUSE / 3 < MOST_BYTES
    text = made.decode()
    assert "<title>Try each control once. practice</title>" in text
    assert text.count("<script") == 3
    assert 'src="' not in text.replace('src="data:', "")


@built
def test_words_of_a_trial_are_no_markup(trial: RecordedTrial) -> None:
    wicked = msgspec.structs.replace(trial.recording, instruction='</title><script>alert("x")</script>')
    text = page.make_page(trial._replace(recording=wicked)).decode()
    assert "alert" not in text.replace("&lt;/title&gt;&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt;", "")


@built
def test_the_command_writes_the_page(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "page"
    done = CliRunner().invoke(app, ["watch", str(run), TRIAL, "--out", str(out), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["files"] == [str(out / "index.html")]
    assert (out / "index.html").read_bytes().startswith(b"<!doctype html>")


@built
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["RUN", "practise"], "unknown trial 'practise'. Did you mean 'practice'?"),
        (["nowhere", "0"], "nowhere is not a run's folder"),
        (["RUN", "0", "--out", "FILE"], "is a file; --out takes a folder"),
        (["RUN", "0", "--agent-args", "x"], "--agent-args"),
    ],
)
def test_what_is_wrong_is_said(run: Path, tmp_path: Path, words: list[str], told: str) -> None:
    (tmp_path / "file").touch()
    names = {"RUN": str(run), "FILE": str(tmp_path / "file")}
    done = CliRunner().invoke(app, ["watch", *(names.get(word, word) for word in words)])
    assert done.exit_code != 0
    assert told in str(done.exception) + done.output


def test_a_clone_without_the_page_says_how_to_build_it(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "FOLDER", tmp_path)
    done = CliRunner().invoke(app, ["watch", str(run), TRIAL, "--out", str(tmp_path)])
    assert isinstance(done.exception, HthorError)
    assert "make page" in str(done.exception)


def test_only_browsers_on_this_machine_get_the_page() -> None:
    with page_server.PageServer(b"<p>page") as served:
        threading.Thread(target=served.serve_forever, daemon=True).start()
        with urllib.request.urlopen(served.address + "?t=3") as answer:
            assert answer.read() == b"<p>page"
            assert answer.headers["X-Content-Type-Options"] == "nosniff"
        for url, host in ((served.address, "evil.example"), (served.address + "run.json", "localhost")):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(urllib.request.Request(url, headers={"Host": host}))
        with pytest.raises(HthorError, match=f"--port {served.server_port}: .*Choose another port"):
            page_server.PageServer(b"", served.server_port)
        served.shutdown()


@contextmanager
def opened(url: str) -> Iterator[Any]:
    """The page in a browser, which must not complain, nor ask for anything but this one file."""
    browsers = pytest.importorskip(
        "playwright.sync_api", reason="pages are opened with an optional dependency: pip install 'hthor[browser]'"
    )
    complaints: list[str] = []
    with browsers.sync_playwright() as playwright:
        browser = launch(playwright)
        shown = browser.new_page(viewport={"width": 640, "height": 420})
        shown.set_default_timeout(60_000)
        shown.on("console", lambda message: complaints.append(message.text))
        shown.on("pageerror", lambda error: complaints.append(str(error)))
        shown.on("request", lambda one: None if one.url.startswith((url, "blob:")) else complaints.append(one.url))
        shown.goto(url)
        shown.wait_for_selector("#bottom")
        yield shown
        browser.close()
    assert complaints == []


@built
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH")
def test_a_browser_shows_it_from_a_folder(tmp_path: Path, record: ScoredTrial, trial: RecordedTrial) -> None:
    file = page.write_page(tmp_path, page.make_page(trial))
    answer = next(event for event in record.events if isinstance(event, Accepted))
    picked = next(event for event in record.events if isinstance(event, Picked))
    with opened(f"file://{file}?plain&t={answer.tick / 10}&view={HUMAN}") as shown:
        until(shown, f"document.querySelector('#now').textContent === '0:{answer.tick / 10:04.1f}'")
        assert shown.evaluate("watch.view") == HUMAN
        assert shown.inner_text("#events .now span:last-child") == f"human confirmed message {answer.message} of robot"
        assert shown.inner_text(".panel .answer") == "human: confirmed"
        until(shown, "document.querySelector('.panel img').naturalWidth > 0")
        assert shown.is_visible(".map svg")
        check_eye(shown, record, HUMAN, answer.tick)
        while (seconds := shown.evaluate("watch.seconds")) != pytest.approx(picked.tick / 10):
            assert seconds < picked.tick / 10, "the event was stepped over"
            shown.keyboard.press("ArrowRight")
        until(shown, "document.querySelector('#caption').textContent === 'human picked up apple'")
        assert shown.inner_text("#held") == "in hand: apple"
        shown.keyboard.press("4")
        until(shown, "watch.view === 'robot'")
        check_eye(shown, record, "robot", picked.tick)
        shown.keyboard.press("1")
        until(shown, "document.querySelectorAll('#labels div').length > 0")
        shown.keyboard.press("Space")
        until(shown, f"watch.playing && watch.seconds > {picked.tick / 10}")


def until(shown: Any, script: str) -> None:
    """Wait until something is so on the page, whose policy forbids Playwright's own way of waiting."""
    for _ in range(600):
        if shown.evaluate(script):
            return
        shown.wait_for_timeout(100)
    pytest.fail(f"never: {script}")


def check_eye(shown: Any, record: ScoredTrial, seat: str, tick: int) -> None:
    """The page looks from where the log has the seat's body, and where it has its head turned."""
    tick -= tick % rules.LOG_EVERY_TICKS
    x, y, gaze = record.paths[seat][tick // rules.LOG_EVERY_TICKS]
    eye = shown.evaluate(f"""() => {{
      watch.seek({tick / 10});
      watch.draw();
      const {{ position, matrixWorld }} = watch.eye.camera;
      return [position.x, position.y, -matrixWorld.elements[8], -matrixWorld.elements[9]];
    }}""")
    assert math.dist(eye[:2], (x / 1000, y / 1000)) < 0.0015
    assert abs(math.remainder(math.atan2(eye[3], eye[2]) - gaze / 1000, math.tau)) < 0.002
