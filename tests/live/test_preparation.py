"""Preparing a trial beside others that are going on."""

from __future__ import annotations

import os
import threading

import pytest

from hthor.errors import HthorError
from hthor.live.preparation import NICENESS, prepare


def _priority() -> int:
    return os.getpriority(os.PRIO_PROCESS, threading.get_native_id())


def test_what_is_prepared_comes_from_a_thread_that_lets_others_go_first():
    before = _priority()
    if before >= NICENESS:
        pytest.skip(f"the tests run with a niceness of {before} themselves")
    assert prepare(_priority) == NICENESS
    assert _priority() == before


def test_an_error_while_preparing_is_that_of_the_caller():
    def fail() -> None:
        raise HthorError("no such house")

    with pytest.raises(HthorError, match="no such house"):
        prepare(fail)


def test_it_works_where_priorities_cannot_be_changed(monkeypatch: pytest.MonkeyPatch):
    def refuse(*_: int) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "setpriority", refuse)
    assert prepare(lambda: 3) == 3
