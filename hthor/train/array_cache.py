"""Arrays that take long to compute, kept in the user's cache and made in parallel where they are missing."""

from __future__ import annotations

import io
import multiprocessing
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hthor import code_identity, installation, jsonio

Arrays = Mapping[str, NDArray[Any]]
Progress = Callable[[int, int], None]
"""Is called with the number of files that are there, and of all."""


class Entry(NamedTuple):
    """One file of the cache, and how it is made.

    Attributes:
        path: the file. make: gives its arrays, or None where there are none, which is kept, too; a function of a
            module. arguments: of ``make``; they travel to another process.
    """

    path: Path
    make: Callable[..., Arrays | None]
    arguments: tuple[Any, ...]


def place(folder: str, *key: object) -> Path:
    """The file in a folder of the cache for what ``key`` describes, which names all that the arrays depend on."""
    return installation.cache() / folder / f"{jsonio.sha256(list(key))}.npz"


def fill(entries: Sequence[Entry], jobs: int | None, progress: Progress | None) -> None:
    """Make the files that are missing, in ``jobs`` processes, one for each processor if None."""
    waiting = [one for one in entries if not one.path.is_file()]
    if progress is not None and not waiting:
        progress(len(entries), len(entries))
    if not waiting:
        return
    code_identity.keep_compiled()
    context = multiprocessing.get_context("spawn")  # threads of the caller do not survive a fork
    with ProcessPoolExecutor(jobs or os.cpu_count(), mp_context=context) as pool:
        making = [pool.submit(write, one) for one in waiting]
        for done, future in enumerate(as_completed(making), len(entries) - len(waiting) + 1):
            future.result()
            if progress is not None:
                progress(done, len(entries))


def read(entry: Entry) -> dict[str, NDArray[Any]] | None:
    """The arrays of an entry that is there; None where there are none."""
    data = entry.path.read_bytes()
    if not data:
        return None
    with np.load(io.BytesIO(data)) as held:
        return dict(held)


def write(entry: Entry) -> None:
    """Make an entry's arrays and keep them, in an empty file if there are none."""
    out = io.BytesIO()
    arrays = entry.make(*entry.arguments)
    if arrays is not None:
        np.savez_compressed(out, allow_pickle=False, **arrays)
    jsonio.write(entry.path, out.getvalue())
