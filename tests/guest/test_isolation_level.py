"""Where a level cannot be had, the reason is told, and nothing is left behind by the tries."""

from __future__ import annotations

import errno
import os
import tempfile
from pathlib import Path

import pytest

from hthor.guest import Guest, GuestConfig, IsolationError
from hthor.guest.confinement import paths
from tests.support.guest_agents import HEAD, agent


def _unreadable(*_: object, **__: object) -> tuple[str, ...]:
    raise PermissionError(errno.EACCES, "Permission denied", "/root/.pyenv/versions")


@pytest.mark.parametrize("level", ["L1", "L2", "auto"])
def test_an_interpreter_in_a_folder_that_cannot_be_read_is_named(
    level: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "agent.py"
    path.write_text(HEAD + agent("return Action()"))
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    monkeypatch.setattr(paths, "readable_paths", _unreadable)
    told = r"is not available on this machine: .*Permission denied: /root/\.pyenv/versions"
    with pytest.raises(IsolationError, match=told), Guest(path, config=GuestConfig(isolation=level)) as mind:
        mind.load()
    assert os.listdir(scratch) == []
