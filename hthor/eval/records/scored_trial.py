"""A trial's record with its metrics, which are computed whenever a log is read and are stored in no log.

So a log of any age is judged by the metrics as they are now, and a value that somebody wrote into it counts nowhere.
"""

from hthor.eval.metrics.trial_metrics import TrialMetrics, measure
from hthor.eval.records.trial_record import TrialRecord


class ScoredTrial(TrialRecord, frozen=True, kw_only=True):
    """A trial as it was logged, and how it is judged: the values of all metrics."""

    metrics: TrialMetrics


def score(record: TrialRecord) -> ScoredTrial:
    """The trial with its metrics, measured from its specification and its log; those that it has do not matter."""
    logged = {name: getattr(record, name) for name in TrialRecord.__struct_fields__}
    return ScoredTrial(**logged, metrics=measure(record.spec, record.log))
