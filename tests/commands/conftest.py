"""The command line in the process of the tests."""

from __future__ import annotations

import sys

import eval_fakes as fakes
import pytest
from command_line import Said

from hthor import cli, tasks
from hthor.eval.runner import trial_runner


@pytest.fixture
def hthor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Run a command in this process, with a fake umpire and a fake suite called ``fake``."""
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    monkeypatch.setenv("_TYPER_FORCE_DISABLE_TERMINAL", "1")  # the command sets it; this takes it back afterwards
    real = tasks.load_suite
    monkeypatch.setattr(tasks, "load_suite", lambda name: fakes.suite(20) if name == "fake" else real(name))
    monkeypatch.setattr(trial_runner, "make_runner", fakes.player)

    def run(*words: str) -> Said:
        monkeypatch.setattr(sys, "argv", ["hthor", *words])
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        out, err = capsys.readouterr()
        return Said(code, out, err)

    return run
