"""What came of every trial of a run, small enough for an entry of the leaderboard; knows nothing of ranks.

A run of 2000 trials takes about 17 kB. Entries that carry this can be compared and ranked without their logs.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
from collections.abc import Sequence
from typing import Literal

import numpy as np
from msgspec import Struct

from hthor.errors import RunError
from hthor.eval import pairing, spread
from hthor.eval.record import Record

Metric = Literal["sr", "twsr"]
_MILLION = 1e6


class Outcomes(Struct, frozen=True, kw_only=True):
    """Trials in the order of people and their trials; every text but the hash is base64.

    Attributes:
        occasions: SHA-256 of the names of the trials but for their robots (`hthor.eval.pairing.occasion`), a line
            each. Two runs with the same one have played the same trials in the same order.
        n: the number of trials.
        tasks, people: each trial's task and person, counted from 0 as they first come; unsigned, two bytes each,
            the low one first.
        sr: a bit a trial, the first in the highest bit of the first byte.
        twsr: time-weighted success in millionths; unsigned, three bytes each, the low one first.
    """

    occasions: str
    n: int
    tasks: str
    people: str
    sr: str
    twsr: str


class Table(Struct, frozen=True, kw_only=True):
    """Runs (rows) by trials: the values (A, N), and the task and the person of each trial (N,)."""

    values: np.ndarray
    tasks: np.ndarray
    people: np.ndarray


def pack(records: Sequence[Record]) -> Outcomes:
    """The outcomes of a run's trials.

    Raises:
        RunError: when there are more tasks or people than two bytes can count.
    """
    ordered = sorted(records, key=lambda found: (found.spec.participant, found.spec.index))
    names = "".join(f"{pairing.occasion(found.spec)}\n" for found in ordered)
    tasks = spread.codes([found.spec.task.id for found in ordered])
    people = spread.codes([found.spec.participant for found in ordered])
    if ordered and max(int(tasks.max()), int(people.max())) >= 1 << 16:
        raise RunError(f"a run with {int(tasks.max()) + 1} tasks is too long for the leaderboard: at most {1 << 16}.")
    twsr = np.rint(np.array([found.metrics.twsr for found in ordered]) * _MILLION).astype(np.int64)
    return Outcomes(
        occasions=hashlib.sha256(names.encode()).hexdigest(),
        n=len(ordered),
        tasks=_bytes(tasks, 2),
        people=_bytes(people, 2),
        sr=_text(np.packbits(np.array([found.metrics.sr for found in ordered], dtype=bool)).tobytes()),
        twsr=_bytes(twsr, 3),
    )


def values(found: Outcomes, metric: Metric = "sr") -> np.ndarray:
    """The metric of each trial, (N,).

    Raises:
        RunError: when the outcomes are damaged, naming the field.
    """
    if metric == "twsr":
        return _numbers(found, "twsr", 3) / _MILLION
    raw = np.frombuffer(_raw(found, "sr", -(-found.n // 8)), dtype=np.uint8)
    return np.unpackbits(raw, count=found.n).astype(np.float64)


def table(runs: Sequence[Outcomes], metric: Metric = "sr") -> Table:
    """Runs of the same trials side by side, for `hthor.eval.ranking.standings`.

    Raises:
        RunError: when they are not of the same trials, or damaged.
    """
    if len({(found.occasions, found.n, found.tasks, found.people) for found in runs}) != 1:
        raise RunError("runs can be ranked together only when all have played the same trials: 'occasions' differ.")
    return Table(
        values=np.stack([values(found, metric) for found in runs]),
        tasks=_numbers(runs[0], "tasks", 2),
        people=_numbers(runs[0], "people", 2),
    )


def _bytes(numbers: np.ndarray, width: int) -> str:
    return _text(numbers.astype("<u4").reshape(-1, 1).view(np.uint8)[:, :width].tobytes())


def _numbers(found: Outcomes, field: str, width: int) -> np.ndarray:
    wide = np.zeros((found.n, 4), dtype=np.uint8)
    wide[:, :width] = np.frombuffer(_raw(found, field, found.n * width), dtype=np.uint8).reshape(-1, width)
    return wide.view("<u4").ravel().astype(np.int64)


def _text(raw: bytes) -> str:
    return base64.b64encode(raw).decode("ascii")


def _raw(found: Outcomes, field: str, length: int) -> bytes:
    try:
        raw = base64.b64decode(getattr(found, field), validate=True)
    except binascii.Error as error:
        raise RunError(f"outcomes.{field} is not base64: {error}.") from None
    if len(raw) != length or _text(raw) != getattr(found, field):
        raise RunError(f"outcomes.{field} has {len(raw)} bytes, but must have {length}, as canonical base64.")
    return raw


def shared(runs: Sequence[Sequence[Record]]) -> tuple[tuple[Record, ...], ...]:
    """Of each run the trials that all of them have."""
    named = [{pairing.occasion(found.spec): found for found in records} for records in runs]
    common = set.intersection(*(set(names) for names in named)) if named else set()
    return tuple(tuple(found for name, found in names.items() if name in common) for names in named)
