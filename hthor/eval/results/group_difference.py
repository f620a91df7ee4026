"""The difference of two runs with different people: two groups of a between-subjects study.

No trial has a partner, so the groups' means are compared. Trials of one person belong together, and so do all trials of
one task: the groups do the same tasks, whose difficulty then cancels, as far as they did them equally often.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import mean_limit
from hthor.eval.results import paired_difference
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics import intervals, variance_components
from hthor.eval.statistics.variance_components import MeanSpread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hthor.eval.config.run_config import RunConfig
    from hthor.eval.records.scored_trial import ScoredTrial

CODE_ROOT = "scoring"


def are_groups(one: RunConfig, other: RunConfig) -> bool:
    """Whether two runs are different conditions of the same between-subjects study."""
    if not one.design or not other.design:
        return False
    return one.design.study == other.design.study and one.design.condition != other.design.condition


def group_difference(
    one: Sequence[ScoredTrial], other: Sequence[ScoredTrial], metric: str, *, level: float = intervals.LEVEL
) -> Difference | None:
    """The second group's mean of a metric minus the first's, with an interval of this level.

    ``n`` counts the trials of both groups; there is no correlation and no gain from pairing. ``more_tasks`` is for each
    group. None where a group has no value.
    """
    groups = [
        [(value, found.spec) for found in some if (value := found.metrics[metric]) is not None] for some in (one, other)
    ]
    if not all(groups):
        return None
    rows = [np.array([value for value, _ in some], dtype=np.float64) for some in groups]
    specs = [spec for some in groups for _, spec in some]
    tasks = variance_components.group_codes([spec.task.id for spec in specs])
    people = variance_components.group_codes([spec.session for spec in specs])
    limit_s = mean_limit([spec.task.time_limit for spec in specs])
    return difference_of_groups(rows[0], rows[1], tasks, people, metric, limit_s=limit_s, level=level)


def difference_of_groups(
    first: np.ndarray,
    second: np.ndarray,
    tasks: np.ndarray,
    people: np.ndarray,
    metric: str,
    *,
    limit_s: float | None,
    level: float = intervals.LEVEL,
) -> Difference:
    """The difference of two groups' values, (N1,) and (N2,).

    Args:
        tasks, people: (N1 + N2,) indices from 0 of the first group's trials and then of the second's.
        limit_s, level: as in `paired_difference.difference_of_values`.
    """
    known_as, each = registry.get(metric), min(len(first), len(second))
    share, room = known_as.is_share, known_as.width(limit_s)
    found = group_spread(first[None], second[None], tasks, people, share=share)
    raw, freedom, variance = float(found.mean[0]), float(found.freedom[0]), float(found.variance[0])
    known = math.isfinite(variance)
    ends = paired_difference.interval_ends(found, share=share, room=room, level=(1.0 + level) / 2.0)
    low, high = (float(end[0]) for end in ends)
    needed = float(intervals.detectable_difference(found, each)[0])
    null = float(paired_difference.null_variance(found, share=share)[0])
    return Difference(
        n=len(first) + len(second),
        first=paired_difference.rounded(float(first.mean())),
        second=paired_difference.rounded(float(second.mean())),
        difference=paired_difference.rounded(raw),
        ci95=(paired_difference.rounded(min(low, raw)), paired_difference.rounded(max(high, raw))) if known else None,
        p=paired_difference.p_value(raw, null, freedom) if known else None,
        mde80=paired_difference.rounded(needed) if known else None,
        correlation=None,
        gain=None,
        more_tasks=paired_difference.more_trials(raw, variance * each, freedom, each) if known else None,
    )


def group_spread(
    first: np.ndarray, second: np.ndarray, tasks: np.ndarray, people: np.ndarray, *, share: bool
) -> MeanSpread:
    """The spread of the difference of two groups' means, for new tasks and new people.

    Each trial counts with its weight in that difference: minus N / N1 in the first group, N / N2 in the second, where N
    = N1 + N2; the mean of such values is the difference. What trials of a task have in common therefore cancels between
    the groups. Two means are estimated instead of one, for which the variance and the degrees of freedom are corrected
    as if people were all that matters, which is cautious.

    Args:
        first, second: (..., N1) and (..., N2). tasks, people: (N,) indices from 0.
        share: whether values are shares; the variance is then never below that of two trials that differ from the rest
            of their groups.
    """
    sizes = first.shape[-1], second.shape[-1]
    count, persons = sum(sizes), int(people.max()) + 1
    means = first.mean(axis=-1, keepdims=True), second.mean(axis=-1, keepdims=True)
    apart = ((first - means[0]) * (-count / sizes[0]), (second - means[1]) * (count / sizes[1]))
    if min(sizes) < 2 or persons < 3:
        nothing = np.ones_like(means[0][..., 0])
        lost = np.full_like(nothing, np.inf)
        mean = (means[1] - means[0])[..., 0]
        return MeanSpread(mean=mean, variance=lost, freedom=nothing, uneven=nothing, single=nothing)
    signed = np.concatenate(apart, axis=-1) + (means[1] - means[0])
    found = variance_components.two_way_spread(signed, tasks, people, differences=True)
    variance = found.variance * (persons - 1) / (persons - 2)
    least = sum(1.0 / size**2 for size in sizes) if share else 0.0
    return msgspec.structs.replace(
        found,
        variance=np.maximum(variance, least),
        freedom=np.maximum(found.freedom - 1.0, 1.0),
        single=np.maximum(found.single, count * least),
    )
