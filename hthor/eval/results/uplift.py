"""What the robots of a run add to people who do the same tasks without one; reads no files."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
from msgspec import Struct

from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import paired_difference, pairing
from hthor.eval.results.paired_difference import Difference

METRICS = ("sr", "twsr", "time_s")
"""The metrics that an uplift is given in."""
RECORDED = "the control's log was not at hand; these are the numbers that were recorded when it was"


class Uplift(Struct, frozen=True, kw_only=True):
    """The run less its control, trial by trial: the same people, on the same days, at the same tasks.

    ``control`` is the hash of the control's configuration, as its result has it in ``hashes.run``.
    """

    control: str
    sr: Difference
    twsr: Difference
    time_s: Difference


class StoredUplift(Uplift, frozen=True, kw_only=True):
    """An uplift as a run's result has it.

    ``note`` is there only where the control's log was not at hand when the run was scored, so that the numbers are the
    recorded ones.
    """

    note: str | msgspec.UnsetType = msgspec.UNSET


def to_stored(one: Uplift | None) -> StoredUplift | None:
    """The same as a result has it."""
    if one is None or isinstance(one, StoredUplift):
        return one
    return StoredUplift(control=one.control, sr=one.sr, twsr=one.twsr, time_s=one.time_s)


def make_uplift(control: Sequence[TrialRecord], records: Sequence[TrialRecord], *, run: str) -> Uplift | None:
    """The uplift of ``records`` over those of a control whose hash is ``run``; None without a trial in common."""
    pairs = pairing.pair_trials(control, records).pairs
    sr, twsr, time_s = (paired_difference.paired_difference(pairs, metric) for metric in METRICS)
    if sr is None or twsr is None or time_s is None:
        return None
    return Uplift(control=run, sr=sr, twsr=twsr, time_s=time_s)
