"""Whole sessions in a real browser: one that becomes a run like any other, and one whose browser is killed."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from live_browser import CHROMIUM, launch
from live_command import Command
from live_session import AGENT

from hthor.eval.records.run_folder import RunFolder
from hthor.live import server
from hthor.live.loop import ABSENT_S
from hthor.types.events import Paused, Resumed

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
browsers = pytest.importorskip(
    "playwright.sync_api", reason="pages are opened with an optional dependency: pip install 'hthor[browser]'"
)

_ANSWERS = """
setInterval(() => {
  const button = document.querySelector("#card:not(.hidden) #scale:not(.hidden) [data-value='5']")
    ?? document.querySelector("#card:not(.hidden) #go:not(.hidden)");
  button?.click();
}, 50);
"""
"""Begins every trial, and rates every robot."""

pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH"),
    pytest.mark.skipif(not (server.FOLDER / server.PAGE).exists(), reason="the page is not built: make page"),
]


@pytest.fixture
def teller(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    agent = tmp_path / "teller.py"
    agent.write_text(AGENT, encoding="utf-8")
    return agent


@contextmanager
def somebody(playwright: Any, command: Command, mark: str = "") -> Iterator[Any]:
    """A browser at the session's page, with somebody who begins and rates all trials."""
    browser = launch(playwright, *([f"--hthor-session={mark}"] if mark else []))
    page = browser.new_page(viewport={"width": 320, "height": 200})
    page.add_init_script(_ANSWERS)
    page.goto(f"{command.address}/?plain#{command.token}")
    try:
        yield page
    finally:
        with suppress(Exception):  # of a browser that was killed
            browser.close()


def test_a_session_at_a_page_is_a_run_like_any_other(teller: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    with (
        Command(run, agent=teller, limit=3, house="birch", page="yes") as command,
        browsers.sync_playwright() as playwright,
        somebody(playwright, command) as page,
    ):
        page.wait_for_selector("#title:text('The session is over')", timeout=300_000)
        own = page.frame_locator("#own-page-frame")
        own.locator("h3").last.wait_for(timeout=60_000)
        command.finish()
        assert own.locator("h3").count() == 3, "a person's own page stays when the server is gone"
    assert [record.log.ratings for record in RunFolder(run).played()] == [{"human": 5}] * 3
    assert json.loads(_hthor("score", str(run), "--json"))["counts"]["trials"] == 3
    _hthor("replay", str(run), "2", "--out", str(tmp_path / "replay.png"))
    assert (tmp_path / "replay.png").stat().st_size > 0
    _hthor("report", str(run), "--out", str(tmp_path / "report"))


def _hthor(*words: str) -> str:
    """What a command prints; it must succeed."""
    done = subprocess.run([sys.executable, "-m", "hthor", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.nightly
def test_a_browser_that_is_killed_ten_times_costs_nothing(teller: Path, tmp_path: Path) -> None:
    moments, run = random.Random(10), tmp_path / "run"
    with (
        Command(run, faster=6.0, agent=teller, limit=2, page="yes") as command,
        browsers.sync_playwright() as playwright,
    ):
        for kill in range(10):
            mark = f"{os.getpid()}-{kill}"
            with somebody(playwright, command, mark) as page:
                _wait_for(page, "page.head !== null || page.over")
                time.sleep(moments.uniform(0.0, 2.0))
                _kill(mark)
            time.sleep(moments.choice((0.0, ABSENT_S + 1.0)))
        with somebody(playwright, command) as page:
            page.wait_for_selector("#title:text('The session is over')", timeout=300_000)
            command.finish()
    records = RunFolder(run).attempts()
    assert [(record.spec.index, record.spec.attempt or 0) for record in records] == [(0, 0), (1, 0)]
    for record in records:
        assert record.log.ticks == 900
        assert record.log.ratings == {"human": 5}
        pauses = [event for event in record.log.events if isinstance(event, Paused | Resumed)]
        assert [type(event) for event in pauses] == [Paused, Resumed] * (len(pauses) // 2)
    assert sum(isinstance(event, Paused) for record in records for event in record.log.events) > 0


def _wait_for(page: Any, condition: str) -> None:
    end = time.monotonic() + 120.0
    while not page.evaluate(f"typeof page !== 'undefined' && ({condition})"):
        assert time.monotonic() < end
        page.wait_for_timeout(20)


def _kill(mark: str) -> None:
    """SIGKILL to all processes of a browser."""
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):
            if f"--hthor-session={mark}".encode() in entry.read_bytes():
                os.kill(int(entry.parent.name), signal.SIGKILL)
