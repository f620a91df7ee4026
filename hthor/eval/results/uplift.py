"""What the robots of a run add over its baseline: the same participants at the same tasks without a robot."""

from collections.abc import Sequence

import msgspec
from msgspec import Struct

from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import paired_difference, pairing
from hthor.eval.results.paired_difference import Difference

METRICS = ("sr", "twsr", "time_s")
"""The metrics that an uplift is given in."""
RECORDED = "the log of the run without a robot was not found; these numbers were recorded when it was there"


class Uplift(Struct, frozen=True, kw_only=True):
    """Differences from the baseline, trial by trial: the same participants, days and tasks.

    ``control`` is the hash of the baseline's configuration, ``hashes.run`` in its result.
    """

    control: str
    sr: Difference
    twsr: Difference
    time_s: Difference


class StoredUplift(Uplift, frozen=True, kw_only=True):
    """An uplift as it stands in a run's result.

    ``note`` is present only if the baseline's log was not found when the run was scored; the numbers are then those of
    an earlier scoring.
    """

    note: str | msgspec.UnsetType = msgspec.UNSET


def to_stored(one: Uplift | None) -> StoredUplift | None:
    """The uplift as it stands in a result."""
    if one is None or isinstance(one, StoredUplift):
        return one
    return StoredUplift(control=one.control, sr=one.sr, twsr=one.twsr, time_s=one.time_s)


def make_uplift(control: Sequence[TrialRecord], records: Sequence[TrialRecord], *, run: str) -> Uplift | None:
    """The uplift of ``records`` over a baseline whose hash is ``run``; None without a trial in common."""
    pairs = pairing.pair_trials(control, records).pairs
    sr, twsr, time_s = (paired_difference.paired_difference(pairs, metric) for metric in METRICS)
    if sr is None or twsr is None or time_s is None:
        return None
    return Uplift(control=run, sr=sr, twsr=twsr, time_s=time_s)
