"""Outcomes of trials as columns: made from records, packed into an entry, and unpacked again."""

import functools
import hashlib
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from msgspec import UNSET, Struct

from hthor import code_identity, rules
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.metrics.metric import mean_limit
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.leaderboard.entries import column_packing
from hthor.leaderboard.entries.entry import Entry, Labels, Trials
from hthor.tasks import Suite
from hthor.trials import sessions
from hthor.types import TaskSpec

LEAF = 8
"""Bytes of a record's hash that are kept: enough to make it infeasible to find another record with the same bytes."""
PROPERTIES = ("difficulty", "kind", "split")
"""Properties of tasks by which trials are grouped."""
UNKNOWN = "unknown"
_ORDER = ("easy", "medium", "hard", "seen", "new")
_MILLION = 1_000_000
_SIZES = {"twsr": 3, "time": 2, "trust": 1, "sent": 2, "accepted": 1, "useful": 1}
"""Bytes per number in each column."""
_LEAF, _NODE = b"\x00", b"\x01"  # so that an inner node cannot be taken for a row
_MESSAGES = ("sent", "accepted", "useful")
_METRICS = ("sr", "adoption", "twsr", "time_s", "trust", *_MESSAGES)
"""The metrics in the columns."""


class Unreadable(ValueError):
    """A column has wrong contents. ``field`` is its name."""

    def __init__(self, field: str, problem: str) -> None:
        self.field = field
        super().__init__(problem)


class Outcomes(Struct, frozen=True, kw_only=True):
    """Columns of equal length: bool, or whole numbers in the units of `hthor.leaderboard.entries.entry.Trials`.

    ``labels`` has, for each property, its possible values and each trial's value as an index. ``time_limit_s`` is the
    mean time limit [s], None if it is not known.
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
        """A row of bytes for each trial: the outcome first, then the hash of its record."""
        flags = self.met * 1 + self.adopted * 2 + self.faulty * 4
        numbers = ((flags, 1), *((getattr(self, name), size) for name, size in _SIZES.items()))
        plain = [[int(value).to_bytes(size, "little") for value in column] for column, size in numbers]
        return [b"".join(parts) + leaf for *parts, leaf in zip(*plain, self.leaves, strict=True)]

    @property
    def merkle(self) -> str:
        """The Merkle root of all rows."""
        return merkle_root(self.rows)


def outcome_bytes(row: bytes) -> bytes:
    """The part of a row that contains the trial's outcome."""
    return row[:-LEAF]


def make_outcomes(records: Sequence[ScoredTrial], leaves: Iterable[bytes]) -> Outcomes:
    """Make the columns from records and the hashes of their lines."""
    values = {
        metric: np.nan_to_num(trial_metrics.column((one.metrics for one in records), metric)) for metric in _METRICS
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
        labels=task_labels([one.spec.task for one in records]),
        time_limit_s=mean_limit([one.spec.task.time_limit for one in records]) if records else None,
    )


@functools.cache
def metrics_sha256() -> str:
    """Hash of the code of the metrics that the columns of `make_outcomes` have; other metrics do not count."""
    return code_identity.modules_sha256([trial_metrics.__name__, *registry.modules(_METRICS)])


def task_labels(tasks: Sequence[TaskSpec]) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """The labels of these tasks, in the form of `Outcomes.labels`."""
    return {name: _labels([getattr(task, name) or UNKNOWN for task in tasks]) for name in PROPERTIES}


def tasks_of_trials(suite: Suite, entry: Entry) -> list[TaskSpec]:
    """The task of each trial, in the order of an entry's trials."""
    hands = sessions.assign_many(suite.tasks, entry.run.seed, range(entry.run.participants))
    return [suite.tasks[number] for hand in hands for number in hand]


def leaf_hash(line: bytes) -> bytes:
    """The part of the hash of a record's line that entries keep."""
    return hashlib.sha256(line).digest()[:LEAF]


def pack(held: Outcomes) -> Trials:
    """Pack columns that were just measured for an entry."""
    return Trials(
        metrics_sha256=metrics_sha256(),
        count=len(held.met),
        met=column_packing.pack_bits(held.met),
        adopted=column_packing.pack_bits(held.adopted),
        faulty=column_packing.pack_bits(held.faulty),
        **{name: column_packing.pack_numbers(getattr(held, name), size) for name, size in _SIZES.items()},
        leaves=column_packing.pack_pieces(held.leaves),
        labels={
            name: Labels(names=names, of=column_packing.pack_labels(codes.tolist()))
            for name, (names, codes) in held.labels.items()
        },
        time_limit_s=UNSET if held.time_limit_s is None else held.time_limit_s,
    )


def unpack(trials: Trials) -> Outcomes:
    """Unpack the columns of an entry.

    Raises:
        Unreadable: if a column has wrong contents.
    """
    count = trials.count
    bits = {
        name: _read(name, column_packing.unpack_bits, getattr(trials, name), count)
        for name in ("met", "adopted", "faulty")
    }
    numbers = {
        name: _read(name, column_packing.unpack_numbers, getattr(trials, name), count, n) for name, n in _SIZES.items()
    }
    for name, most in (("twsr", _MILLION), ("trust", rules.TRUST_MAX)):
        if int(numbers[name].max()) > most:
            raise Unreadable(name, f"holds {int(numbers[name].max())}, which is more than {most}")
    return Outcomes(
        **bits,
        **numbers,
        leaves=_read("leaves", column_packing.unpack_pieces, trials.leaves, count, LEAF),
        labels={
            name: (one.names, _read(f"labels.{name}.of", column_packing.unpack_labels, one.of, count, len(one.names)))
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
    """Counts, cut to the largest number that their column can contain."""
    counts: np.ndarray = np.minimum(values, (1 << (8 * _SIZES[name])) - 1)
    return counts


def _whole(values: np.ndarray) -> np.ndarray:
    """The values as integers, with float rounding errors removed."""
    held = np.round(values)
    if (np.abs(held - values) > 1e-3).any():
        raise ValueError("a trial's value is finer than an entry can hold")
    return held.astype(np.int64)


def _labels(values: Sequence[str]) -> tuple[tuple[str, ...], np.ndarray]:
    names = sorted(set(values), key=lambda name: (_ORDER.index(name) if name in _ORDER else len(_ORDER), name))
    return tuple(names), np.array([names.index(value) for value in values], dtype=np.int64)


def merkle_root(rows: Sequence[bytes]) -> str:
    """The root of the rows' Merkle tree, 64 hexadecimal digits; a row without a partner moves up unchanged.

    Changing, moving or removing a row changes the root.
    """
    level = [hashlib.sha256(_LEAF + row).digest() for row in rows]
    if not level:
        return hashlib.sha256().hexdigest()
    while len(level) > 1:
        pairs = [
            hashlib.sha256(_NODE + one + other).digest() for one, other in zip(level[::2], level[1::2], strict=False)
        ]
        level = pairs + level[2 * len(pairs) :]
    return level[0].hex()
