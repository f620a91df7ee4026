"""A table of trials: the outcome of each trial, and whose trial it was.

It has all data for the statistics, as numpy arrays with one entry per trial, except T*: it is looked up in the suite,
so that a table stays valid when T* changes.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import jsonio, rules
from hthor.errors import RunError
from hthor.eval.metrics.definitions import success
from hthor.humans.population.population import encode_npz
from hthor.tasks import Suite

Array = np.ndarray

AGENTS = ("silent", "frontier", "oracle")
"""The agent in each of the published conditions, in the order of their numbers."""

_TYPES: dict[str, str] = {
    "study": "<i4",
    "session": "<i4",
    "point": "<i4",
    "condition": "<i1",
    "participant": "<i4",
    "index": "<i1",
    "task": "<i2",
    "met": "|b1",
    "ticks": "<i4",
    "sent": "<i4",
    "shown": "<i4",
    "accepted": "<i4",
    "declined": "<i4",
    "picked": "<i4",
    "messages": "<i2",
    "adopted": "|b1",
    "trust": "<i1",
    "valid": "|b1",
    "counted": "|b1",
}
COLUMNS = tuple(_TYPES)
"""Names of the columns that have an entry per trial."""


class Table(Struct, frozen=True, kw_only=True, eq=False):
    """Trials of simulated people, N of them, in order of study, session and index.

    Attributes:
        names: names (P,) of the parameters.
        points: (T, P) float64, points of the prior's unit cube: populations that people were drawn from.
        study: number of the simulated study, -1 without one. session: number of the session, from 0 in each study.
        point: row of ``points``. condition: 0 none, 1 frontier, 2 oracle. participant: the person's number.
        index: the trial's place in its session, from 0. task: number in the suite.
        met: whether the goal was met. ticks: length [ticks of 0.1 s], the time limit after a failure.
        sent, shown, accepted, declined: tick at which this first happened to a message, -1 when it never did.
        picked: tick at which the target was first in the person's hand, -1 when it never was.
        messages: number of messages sent. adopted: whether one was accepted. trust: 1 to 7, 0 without a rating.
        valid: whether the trial counts in a study's success rate. counted: whether it counts in the adoption rate.
    """

    names: tuple[str, ...]
    points: Array
    study: Array
    session: Array
    point: Array
    condition: Array
    participant: Array
    index: Array
    task: Array
    met: Array
    ticks: Array
    sent: Array
    shown: Array
    accepted: Array
    declined: Array
    picked: Array
    messages: Array
    adopted: Array
    trust: Array
    valid: Array
    counted: Array

    def __len__(self) -> int:
        return len(self.study)

    def take(self, rows: Array) -> Table:
        """The trials selected by a mask or by row numbers; all points are kept."""
        return Table(names=self.names, points=self.points, **{name: getattr(self, name)[rows] for name in COLUMNS})

    def unit(self, rows: Array | None = None) -> Array:
        """(N, P) point of each trial, or of each trial in ``rows``."""
        points: Array = self.points[self.point if rows is None else self.point[rows]]
        return points


def build_table(names: Sequence[str], points: Array, columns: dict[str, Any]) -> Table:
    """A table from columns that numpy can read, each of length N."""
    typed = {name: np.asarray(columns[name]).astype(kind) for name, kind in _TYPES.items()}
    return Table(names=tuple(names), points=np.asarray(points, dtype="<f8").reshape(-1, len(names)), **typed)


def join_tables(tables: Sequence[Table]) -> Table:
    """One table from several tables; points are renumbered, studies and sessions keep their numbers."""
    shifts = np.cumsum([0, *(len(table.points) for table in tables)])
    columns = {name: np.concatenate([getattr(table, name) for table in tables]) for name in COLUMNS}
    columns["point"] = np.concatenate([table.point + shift for table, shift in zip(tables, shifts, strict=False)])
    return build_table(tables[0].names, np.concatenate([table.points for table in tables]), columns)


def time_spent_s(table: Table) -> Array:
    """(N,) float64, time spent [s]: the time limit if the goal was not met."""
    seconds: Array = table.ticks * rules.TICK_S
    return seconds


def suite_t_star(suite: Suite) -> Array:
    """(tasks,) float64, T* [s] by a task's number in the suite."""
    return np.array([task.t_star for task in suite.tasks])


def twsr(table: Table, t_star: Array) -> Array:
    """(N,) float64, success weighted by time: T* / max(T*, T), 0 after a failure; ``t_star`` is T* [s] by task."""
    return success.time_weighted(table.met, t_star[table.task], time_spent_s(table))


def save_table(path: Path, table: Table) -> None:
    """Write a table as NPZ; equal tables give equal bytes."""
    columns = {name: getattr(table, name) for name in COLUMNS}
    arrays = {"names": np.array(table.names), "points": table.points, **columns}
    jsonio.write(path, encode_npz(arrays, zipfile.ZIP_DEFLATED))


def load_table(path: Path) -> Table:
    """The table in a file.

    Raises:
        RunError: when there is no such table, or it is damaged.
    """
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as arrays:
            columns = {name: arrays[name] for name in COLUMNS}
            return build_table([str(name) for name in arrays["names"]], arrays["points"], columns)
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile) as error:
        raise RunError(
            f"{path}: not a table of trials: {error}. Delete it and repeat the command that wrote it."
        ) from None
