"""Tells objects that they are in a forked process now, where the threads and the OpenGL of the parent are missing."""

import functools
import os
import weakref
from typing import Protocol

CODE_PART = "pictures"


class Forked(Protocol):
    """What hears of forks."""

    def forked(self) -> None: ...


_watching: weakref.WeakSet[Forked] = weakref.WeakSet()  # a fork concerns all worlds of a process


def watch(one: Forked) -> None:
    """From now on, call ``one.forked()`` in every process that is forked from this one, as long as ``one`` lives."""
    _register()
    _watching.add(one)


@functools.cache
def _register() -> None:
    os.register_at_fork(after_in_child=_tell)


def _tell() -> None:
    for one in tuple(_watching):
        one.forked()
