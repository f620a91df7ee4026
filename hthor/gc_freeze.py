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


def unfreeze_after(owner: object) -> None:
    """Scan everything again once ``owner`` is gone."""
    weakref.finalize(owner, gc.unfreeze).atexit = False
