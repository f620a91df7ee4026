"""The command line in the process of the tests, which starts no other: workers' sessions are run here too."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable

import eval_fakes as fakes
import pytest
import typer
from command_line import Said

from hthor import cli, tasks
from hthor.eval.runner import session_runner

_GET_COMMAND = functools.cache(typer.main.get_command)
"""Reading the signatures of all commands takes a tenth of a second, which a process pays once."""


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Said]:
    """Run a command in this process; its trials are real."""
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    monkeypatch.setenv("_TYPER_FORCE_DISABLE_TERMINAL", "1")  # the command sets it; this takes it back afterwards
    monkeypatch.setattr(typer.main, "get_command", _GET_COMMAND)
    fakes.play_here(monkeypatch)

    def run(*words: object) -> Said:
        monkeypatch.setattr(sys, "argv", ["hthor", *map(str, words)])
        code: object = 0
        try:
            cli.main()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        out, err = capsys.readouterr()
        assert isinstance(code, int)
        return Said(code, out, err)

    return run


@pytest.fixture
def hthor(monkeypatch: pytest.MonkeyPatch, say: Callable[..., Said]) -> Callable[..., Said]:
    """Run a command in this process, with a fake umpire and a fake suite called ``fake``."""
    real = tasks.load_suite
    monkeypatch.setattr(tasks, "load_suite", lambda name: fakes.suite(20) if name == "fake" else real(name))
    monkeypatch.setattr(session_runner, "make_runner", fakes.player)
    return say
