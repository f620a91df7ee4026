"""Python's garbage collector kept from what is made to stay."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def collection_paused() -> Iterator[None]:
    """Look for no garbage meanwhile: with several worlds in memory that takes a third of the time to build another."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def freeze_existing() -> None:
    """Do not look through what there is by now any more: it will stay as long as its owner, see `release_with`."""
    gc.freeze()


def unfreeze_after(owner: object) -> None:
    """Look through everything again once ``owner`` is gone."""
    weakref.finalize(owner, gc.unfreeze).atexit = False
