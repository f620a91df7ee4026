"""Whatever a command does, somebody who waits sees that it is at work; one that shows it itself is left alone."""

from __future__ import annotations

import io
import sys
import time

import pytest

from hthor import activity
from hthor.console import output, waiting_notice


class Terminal(io.StringIO):
    """A stream on which somebody watches."""

    def isatty(self) -> bool:
        return True


def watched(monkeypatch: pytest.MonkeyPatch, *, live: bool, after_s: float = 0.05) -> Terminal:
    """Standard error on which a command's patience shows after this time."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(output, "live", lambda: live)
    monkeypatch.setattr(waiting_notice, "_BEAT_S", 0.01)
    monkeypatch.setattr(waiting_notice, "LIVE_AFTER_S", after_s)
    monkeypatch.setattr(waiting_notice, "PLAIN_AFTER_S", after_s)
    return stream


def until(stream: Terminal, words: str) -> str:
    for _ in range(1000):
        if words in stream.getvalue():
            return stream.getvalue()
        time.sleep(0.01)
    raise AssertionError(f"never said '{words}': {stream.getvalue()[:200]!r}")


def test_a_terminal_has_a_line_that_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = watched(monkeypatch, live=True)
    with waiting_notice.shown(["case", "runs/a", "--nice"]):
        until(stream, "case: ")
        activity.say("playing trial 3 of 10")
        until(stream, "playing trial 3 of 10, ")
    assert sys.stderr is stream
    assert stream.getvalue().endswith("\r\x1b[K")
    assert "\n" not in stream.getvalue()
    activity.say("nobody hears")
    assert "nobody" not in stream.getvalue()


def test_a_pipe_has_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = watched(monkeypatch, live=False)
    with waiting_notice.shown(["agent", "check", "mine.py"], ["agent"]):
        said = until(stream, "agent check: ")
    assert "\x1b" not in said
    assert "\r" not in said
    assert said.endswith(" s\n")


def test_what_the_command_writes_is_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = watched(monkeypatch, live=True)
    with waiting_notice.shown(["score", "run"]):
        until(stream, "score: ")
        sys.stderr.write("a line of the command\n")
        assert stream.getvalue().endswith("\r\x1b[Ka line of the command\n")


@pytest.mark.parametrize("words", [["eval", "--quiet"], ["agent", "serve", "mine.py"], []])
def test_who_is_quiet_or_serves_or_does_nothing_is_left_alone(words: list[str]) -> None:
    before = sys.stdout, sys.stderr
    with waiting_notice.shown(words):
        assert (sys.stdout, sys.stderr) == before


def test_who_waits_for_people_is_left_alone_from_then_on(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = watched(monkeypatch, live=False)
    with waiting_notice.shown(["live"]):
        until(stream, "live: ")
        activity.wait_for_people()
        said = stream.getvalue()
        time.sleep(0.3)
    assert stream.getvalue() == said


def test_a_bar_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = watched(monkeypatch, live=True)
    with waiting_notice.shown(["validate", "x"]):
        sys.stderr.write("\rtask:  10%")
        time.sleep(0.3)
    assert stream.getvalue() == "\rtask:  10%"
