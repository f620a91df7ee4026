"""What became of each trial, as columns: out of records, into an entry, and back."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET, Struct

from hthor import rules
from hthor.eval.metrics import trial_metrics
from hthor.eval.metrics.metric import mean_limit
from hthor.eval.records.trial_record import TrialRecord
from hthor.leaderboard.entries import column_packing, merkle
from hthor.leaderboard.entries.entry import Labels, Trials
from hthor.types import TaskSpec

LEAF = 8
"""Bytes of a record's hash that are kept: nobody finds another record with the same ones and other outcomes."""
PROPERTIES = ("difficulty", "kind", "split")
"""What of a task its trials are sorted by."""
UNKNOWN = "unknown"
_ORDER = ("easy", "medium", "hard", "seen", "new")
_MILLION = 1_000_000
_SIZES = {"twsr": 3, "time": 2, "trust": 1, "sent": 2, "accepted": 1, "useful": 1}
"""Bytes of a number in each column."""
_MESSAGES = ("sent", "accepted", "useful")


class Unreadable(ValueError):
    """A column that does not hold what it should. ``field`` is its name."""

    def __init__(self, field: str, problem: str) -> None:
        self.field = field
        super().__init__(problem)


class Outcomes(Struct, frozen=True, kw_only=True):
    """Columns of equal length: bool, or whole numbers as `hthor.leaderboard.entries.entry.Trials` has them.

    ``labels`` holds, for each property, its values and each trial's as an index. ``time_limit_s`` is the mean time
    limit [s], None where it is not known.
    """

    met: np.ndarray
    adopted: np.ndarray
    faulty: np.ndarray
    twsr: np.ndarray
    time: np.ndarray
    trust: np.ndarray
    sent: np.ndarray
    accepted: np.ndarray
    useful: np.ndarray
    leaves: list[bytes]
    labels: dict[str, tuple[tuple[str, ...], np.ndarray]]
    time_limit_s: float | None = None

    @property
    def rows(self) -> list[bytes]:
        """What there is of each trial, a few bytes: outcome first, then the hash of its record."""
        flags = self.met * 1 + self.adopted * 2 + self.faulty * 4
        numbers = ((flags, 1), *((getattr(self, name), size) for name, size in _SIZES.items()))
        plain = [[int(value).to_bytes(size, "little") for value in column] for column, size in numbers]
        return [b"".join(parts) + leaf for *parts, leaf in zip(*plain, self.leaves, strict=True)]

    @property
    def merkle(self) -> str:
        """The root of all rows."""
        return merkle.root(self.rows)


def narrowed(held: Outcomes, places: Sequence[int]) -> Outcomes:
    """The columns of some trials only, without their labels."""
    where = np.asarray(places, dtype=np.int64)
    columns = {name: getattr(held, name)[where] for name in ("met", "adopted", "faulty", *_SIZES)}
    return msgspec.structs.replace(held, **columns, leaves=[held.leaves[place] for place in places], labels={})


def outcome(row: bytes) -> bytes:
    """The part of a row that says what became of the trial."""
    return row[:-LEAF]


def of(records: Sequence[TrialRecord], leaves: Iterable[bytes]) -> Outcomes:
    """The columns of records, whose lines have these hashes."""
    values = {
        metric: np.nan_to_num(trial_metrics.column((one.metrics for one in records), metric))
        for metric in ("sr", "adoption", "twsr", "time_s", "trust", *_MESSAGES)
    }
    return Outcomes(
        met=values["sr"].astype(bool),
        adopted=values["adoption"].astype(bool),
        faulty=np.array([bool(one.faults) for one in records]),
        twsr=_whole(values["twsr"] * _MILLION),
        time=_whole(values["time_s"] / rules.TICK_S),
        trust=values["trust"].astype(np.int64),
        **{name: _counted(values[name].astype(np.int64), name) for name in _MESSAGES},
        leaves=list(leaves),
        labels=labels([one.spec.task for one in records]),
        time_limit_s=mean_limit([one.spec.task.time_limit for one in records]) if records else None,
    )


def labels(tasks: Sequence[TaskSpec]) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """What sort of task each is, as `Outcomes` has it."""
    return {name: _labels([getattr(task, name) or UNKNOWN for task in tasks]) for name in PROPERTIES}


def leaf(line: bytes) -> bytes:
    """What is kept of the hash of a record's line."""
    return hashlib.sha256(line).digest()[:LEAF]


def pack(held: Outcomes) -> Trials:
    """The columns as an entry has them."""
    return Trials(
        count=len(held.met),
        met=column_packing.bits(held.met),
        adopted=column_packing.bits(held.adopted),
        faulty=column_packing.bits(held.faulty),
        **{name: column_packing.numbers(getattr(held, name), size) for name, size in _SIZES.items()},
        leaves=column_packing.pieces(held.leaves),
        labels={
            name: Labels(names=names, of=column_packing.digits(codes.tolist()))
            for name, (names, codes) in held.labels.items()
        },
        time_limit_s=UNSET if held.time_limit_s is None else held.time_limit_s,
    )


def unpack(trials: Trials) -> Outcomes:
    """The columns of an entry.

    Raises:
        Unreadable: when one of them does not hold what it should.
    """
    count = trials.count
    bits = {
        name: _read(name, column_packing.unbits, getattr(trials, name), count) for name in ("met", "adopted", "faulty")
    }
    numbers = {
        name: _read(name, column_packing.unnumbers, getattr(trials, name), count, n) for name, n in _SIZES.items()
    }
    for name, most in (("twsr", _MILLION), ("trust", rules.TRUST_MAX)):
        if int(numbers[name].max()) > most:
            raise Unreadable(name, f"holds {int(numbers[name].max())}, which is more than {most}")
    return Outcomes(
        **bits,
        **numbers,
        leaves=_read("leaves", column_packing.unpieces, trials.leaves, count, LEAF),
        labels={
            name: (one.names, _read(f"labels.{name}.of", column_packing.undigits, one.of, count, len(one.names)))
            for name, one in trials.labels.items()
        },
        time_limit_s=trials.time_limit_s or None,
    )


def _read(field: str, read: Callable[..., Any], *given: Any) -> Any:
    try:
        return read(*given)
    except ValueError as error:
        raise Unreadable(field, str(error)) from None


def _counted(values: np.ndarray, name: str) -> np.ndarray:
    """Counts, cut to what their column can hold."""
    counts: np.ndarray = np.minimum(values, (1 << (8 * _SIZES[name])) - 1)
    return counts


def _whole(values: np.ndarray) -> np.ndarray:
    """Whole numbers that differ from the values only by what a float loses."""
    held = np.round(values)
    if (np.abs(held - values) > 1e-3).any():
        raise ValueError("a trial's value is finer than an entry can hold")
    return held.astype(np.int64)


def _labels(values: Sequence[str]) -> tuple[tuple[str, ...], np.ndarray]:
    names = sorted(set(values), key=lambda name: (_ORDER.index(name) if name in _ORDER else len(_ORDER), name))
    return tuple(names), np.array([names.index(value) for value in values], dtype=np.int64)
