"""Keeping Python's garbage collector from scanning objects that stay, such as worlds."""

import gc
import weakref
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def collection_paused() -> Iterator[None]:
    """Collect no garbage in the block: with several worlds in memory, it would take a third of the time of a build."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def freeze_existing() -> None:
    """Exclude the objects that exist now from garbage collection; see `unfreeze_after`."""
    gc.freeze()


def collect_frozen() -> None:
    """Free what nobody refers to any longer, among the objects that were frozen too."""
    gc.unfreeze()
    gc.collect()


def collect_after_close(owner: object) -> None:
    """Count ``owner`` among those that `collect_closed` will be called for, such as worlds."""
    _open.add(owner)


def collect_closed(owner: object) -> None:
    """Note that ``owner`` was closed, and free what is left of those closed, once they are a fifth of all.

    If each were searched for by itself, closing many would take a time that grows with the square of their number.
    """
    _open.discard(owner)
    _closed.append(None)
    if 4 * len(_closed) >= len(_open):
        _closed.clear()
        gc.collect()


def unfreeze_after(owner: object) -> None:
    """Scan everything again once ``owner`` is gone."""
    weakref.finalize(owner, gc.unfreeze).atexit = False


_open: weakref.WeakSet[object] = weakref.WeakSet()  # the collector is one for the whole process
_closed: list[None] = []
