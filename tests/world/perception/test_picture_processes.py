"""Pictures in other processes and threads than the one that drew first: a picture or a sentence, never a wait."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import picture_processes
import pytest
from picture_processes import PROFILES, WAYS

from hthor.errors import RenderingUnavailable
from hthor.world.rendering.opengl_process import OpenGLProcess

PROGRAM = Path(picture_processes.__file__)


@functools.cache
def found() -> dict[tuple[str, str, str], str]:
    """What the program says of every case; skips where OpenGL does not draw."""
    done = subprocess.run([sys.executable, str(PROGRAM)], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    cases = {(when, way, profile): said for when, way, profile, said in json.loads(done.stdout)}
    if cases["before", "spawn", "nice"].startswith("RenderingUnavailable: no OpenGL back end"):
        pytest.skip(cases["before", "spawn", "nice"])
    return cases


@pytest.mark.parametrize("when", ["before", "after"])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("profile", PROFILES)
def test_every_process_and_thread_draws_or_says_what_to_do(when: str, way: str, profile: str) -> None:
    said = found()[when, way, profile]
    if when == "after" and profile == "nice" and way.startswith("fork"):
        assert said.startswith("RenderingUnavailable: this process was forked")
        assert 'multiprocessing.get_context("spawn")' in said
    else:
        assert said == "drew"


@pytest.mark.parametrize("profile", PROFILES)
def test_a_fork_in_the_middle_of_another_thread_s_picture_can_draw(profile: str) -> None:
    assert found()["after", "fork while a thread draws", profile] == "drew"


def test_the_parent_draws_on() -> None:
    assert found()["after", "still", "nice"] == "drew"


class FakeSurface:
    """Notes in which thread it was freed, or that it was abandoned."""

    def __init__(self, model: None) -> None:
        assert model is None
        self.freed: list[threading.Thread] = []
        self.abandoned = False

    def free(self) -> None:
        self.freed.append(threading.current_thread())

    def abandon(self) -> None:
        self.abandoned = True


@pytest.fixture
def process(monkeypatch: pytest.MonkeyPatch) -> OpenGLProcess:
    monkeypatch.setattr("hthor.world.rendering.opengl_process.Surface", FakeSurface)
    monkeypatch.setattr("hthor.world.rendering.opengl_process.atexit", SimpleNamespace(register=id, unregister=id))
    return OpenGLProcess()


def test_what_is_discarded_while_a_picture_is_drawn_is_freed_afterwards(process: OpenGLProcess) -> None:
    surface: Any = process.open(None)
    with process.turn():
        process.discard(surface)  # as the garbage collector does it
        assert not surface.freed
    assert surface.freed == [threading.current_thread()]
    process.discard(surface)
    assert len(surface.freed) == 1


def test_what_is_discarded_while_nothing_is_drawn_is_freed_at_once(process: OpenGLProcess) -> None:
    surface: Any = process.open(None)
    process.discard(surface)
    assert len(surface.freed) == 1


def test_a_forked_process_neither_frees_nor_draws_with_what_the_parent_made(process: OpenGLProcess) -> None:
    surface: Any = process.open(None)
    with process.turn():
        process.forked()
        with pytest.raises(RenderingUnavailable, match="spawn"), process.turn():
            pass
    process.discard(surface)
    process._close()
    assert surface.abandoned
    assert not surface.freed
