"""One progress display for all commands: rich's, on a terminal only."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from rich.console import Console

from hthor.console import output, progress_bar


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def drawn(monkeypatch: pytest.MonkeyPatch, *, live: bool, shown: bool = True) -> str:
    stream = Terminal()
    console = Console(file=stream, width=100, force_terminal=True)
    monkeypatch.setattr(output, "live", lambda: live)
    monkeypatch.setattr(output, "console", lambda *, talk=False: console)
    assert list(progress_bar.watched(iter("abc"), "a [b]film", 3, "frames", shown=shown)) == ["a", "b", "c"]
    return stream.getvalue()


def test_a_terminal_shows_a_bar_that_vanishes(monkeypatch: pytest.MonkeyPatch) -> None:
    text = drawn(monkeypatch, live=True)
    assert "a [b]film" in text, "names are no markup"
    assert "3/3 frames" in text
    assert text.rstrip().endswith("\x1b[2K"), "nothing of it stays"


def test_a_pipe_and_a_quiet_command_show_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    assert drawn(monkeypatch, live=False) == ""
    assert drawn(monkeypatch, live=True, shown=False) == ""


def test_words_stand_behind_the_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(output, "live", lambda: True)
    monkeypatch.setattr(output, "console", lambda *, talk=False: Console(file=stream, width=100, force_terminal=True))
    with progress_bar.bar("checking", 2, "tasks") as advance:
        advance("1 unsound")
        advance("1 unsound")
    assert "2/2 tasks, 1 unsound" in stream.getvalue()


def test_there_is_one_progress_library(root: Path) -> None:
    """Every bar is made by this module, with rich; docs/architecture.md says so."""
    makers = re.compile(r"^\s*(from|import) (tqdm|alive_progress|rich\.progress)", re.MULTILINE)
    found = [path for part in ("hthor", "benchmarks", "scripts", "examples") for path in (root / part).rglob("*.py")]
    own = [path.relative_to(root).as_posix() for path in found if makers.search(path.read_text())]
    assert set(own) == {"hthor/console/progress_bar.py"}
