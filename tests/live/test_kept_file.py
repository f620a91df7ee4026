"""Files that take long to make, and are made once."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from hthor.live.gltf.kept_file import kept_file


def test_of_those_who_want_a_file_at_the_same_time_one_makes_it(tmp_path: Path) -> None:
    path, begun, go_on = tmp_path / "folder" / "file", threading.Event(), threading.Event()
    made: list[int] = []
    found: list[bytes] = []

    def make() -> bytes:
        made.append(1)
        begun.set()
        assert go_on.wait(60.0)
        return b"content"

    threads = [threading.Thread(target=lambda: found.append(kept_file(path, make))) for _ in range(3)]
    for thread in threads:
        thread.start()
    assert begun.wait(60.0)
    go_on.set()
    for thread in threads:
        thread.join()
    assert (len(made), found) == (1, [b"content"] * 3)
    assert [one.name for one in path.parent.iterdir()] == ["file"]


def test_who_waits_makes_the_file_when_the_first_has_failed(tmp_path: Path) -> None:
    path = tmp_path / "file"
    with pytest.raises(ValueError, match="no light"):
        kept_file(path, _fail)
    assert kept_file(path, lambda: b"content") == b"content"
    assert [one.name for one in tmp_path.iterdir()] == ["file"]


def _fail() -> bytes:
    raise ValueError("no light")
