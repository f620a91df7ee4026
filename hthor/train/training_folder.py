"""The files that a training leaves in its folder, and the signals that stop it."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import torch
from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import HthorError
from hthor.train.training_state import TRAIN_CONFIG

METRICS = "metrics.jsonl"


def choose_device(name: str) -> str:
    """The device that a name stands for.

    Raises:
        HthorError: when there is no such device here.
    """
    if name == "auto":
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.empty(0, device=name)
    except (RuntimeError, AssertionError) as error:
        first = str(error).strip().splitlines()[0]
        raise HthorError(f"the device {name!r} cannot be used here ({first}); give auto, cpu or cuda") from None
    return name


class Metrics:
    """Rows of `metrics.jsonl` and, where TensorBoard is installed, its events."""

    def __init__(self, folder: Path, frames: int) -> None:
        """Rows after so many ``frames`` are left out: the training goes on from there, and writes them again."""
        self._path = folder / METRICS
        rows = []
        if self._path.exists():
            lines = self._path.read_bytes().splitlines(keepends=True)
            lines = [line for line in lines if line.endswith(b"\n")]  # the last one may have been cut off
            rows = [documents.parse(line, dict[str, Any], HthorError, shown=str(self._path)) for line in lines]
        rows = [row for row in rows if row["frames"] <= frames]
        jsonio.write(self._path, b"".join(jsonio.canonical(row) + b"\n" for row in rows))
        self.last: dict[str, Any] = rows[-1] if rows else {}
        self._board = _board(folder, frames)

    def __enter__(self) -> Metrics:
        return self

    def __exit__(self, *error: object) -> None:
        if self._board is not None:
            self._board.close()

    def add(self, row: dict[str, Any]) -> None:
        with self._path.open("ab") as file:
            file.write(jsonio.canonical(row) + b"\n")
        self.last = row
        if self._board is not None:
            for group, numbers in row.items():
                for name, value in numbers.items() if isinstance(numbers, dict) else ():
                    self._board.add_scalar(f"{group}/{name}", value, row["frames"])
            self._board.flush()


def _board(folder: Path, frames: int) -> Any:
    """A writer of TensorBoard's events, None where it is not installed."""
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        return None
    return SummaryWriter(str(folder / "tensorboard"), purge_step=frames + 1)


def write_config(folder: Path, held: Struct) -> None:
    """Write what a training is made from, `train_config.json`.

    Raises:
        HthorError: when the folder holds a training that is made from something else.
    """
    path = folder / TRAIN_CONFIG
    if path.exists() and path.read_bytes() != jsonio.pretty(held):
        old = documents.read(path, dict[str, Any], HthorError)
        new = msgspec.to_builtins(held)
        different = sorted(name for name in {*old, *new} if old.get(name) != new.get(name))
        raise HthorError(f"{folder} holds a training with other settings ({', '.join(different)}); give another --out")
    jsonio.write(path, jsonio.pretty(held))


@contextlib.contextmanager
def signals() -> Iterator[Callable[[], bool]]:
    """Whether SIGINT or SIGTERM has come; a second SIGINT interrupts as usual."""
    came = []

    def note(number: int, frame: object) -> None:
        del frame
        came.append(number)
        signal.signal(signal.SIGINT, before[signal.SIGINT])

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: bool(came)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
