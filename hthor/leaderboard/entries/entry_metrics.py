"""Computes an entry's numbers from the outcomes of its trials."""

from collections.abc import Sequence

import numpy as np

from hthor import rules
from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import DIGITS
from hthor.eval.results import paired_difference
from hthor.eval.results.result_file import UPLIFT_METRICS, Uplift
from hthor.eval.statistics import intervals
from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries.entry import Entry, Group
from hthor.leaderboard.entries.trial_outcomes import Outcomes
from hthor.trials import sessions

MEASURED = ("sr", "twsr", "adoption", "usefulness", "time_s", "trust")
"""Metrics that can be computed from the contents of an entry."""
_MILLION = 1_000_000


def metric_values(held: Outcomes, metric: str, *, alone: bool) -> np.ndarray:
    """A metric's value in each trial, (N,); empty, (0,), if the metric has no meaning without a robot.

    Usefulness has a value only in trials in which a message was accepted, (M,); see `accepted_trials`.
    """
    if alone and metric in ("adoption", "usefulness", "trust"):
        return np.zeros(0)
    some = accepted_trials(held)
    columns = {
        "sr": held.met.astype(np.float64),
        "twsr": held.twsr / _MILLION,
        "adoption": held.adopted.astype(np.float64),
        "usefulness": np.round(held.useful[some] / held.accepted[some], DIGITS),
        "time_s": np.round(held.time * rules.TICK_S, DIGITS),
        "trust": held.trust.astype(np.float64),
    }
    found: np.ndarray = columns[metric]
    return found


def accepted_trials(held: Outcomes) -> np.ndarray:
    """Indices of the trials in which a message was accepted."""
    return np.flatnonzero(held.accepted > 0)


def trial_participants(count: int, participants: int) -> list[int]:
    """The participant of each trial, if every task is done once."""
    sizes = [sessions.count_trials(count, [person]) for person in range(participants)]
    return [person for person, size in enumerate(sizes) for _ in range(size)]


def entry_scores(held: Outcomes, participants: Sequence[int], *, alone: bool) -> dict[str, Estimate]:
    """Means and intervals of all metrics in `MEASURED`."""
    owners = {"usefulness": [participants[place] for place in accepted_trials(held).tolist()]}
    return {
        metric: _estimate(
            metric_values(held, metric, alone=alone), owners.get(metric, participants), metric, held.time_limit_s
        )
        for metric in MEASURED
    }


def split_scores(held: Outcomes, participants: Sequence[int]) -> dict[str, dict[str, Group]]:
    """Success rates of the trials that have a property in common, by property and value."""
    found: dict[str, dict[str, Group]] = {}
    for name, (names, codes) in held.labels.items():
        found[name] = {}
        for code, value in enumerate(names):
            where = np.flatnonzero(codes == code)
            mine = [participants[place] for place in where.tolist()]
            rows = {metric: metric_values(held, metric, alone=False)[where] for metric in ("sr", "twsr")}
            found[name][value] = Group(**{metric: _estimate(row, mine, metric) for metric, row in rows.items()})
    return found


def entry_uplift(entry: Entry, held: Outcomes, control: Entry, without: Outcomes) -> Uplift:
    """How the metrics differ from those of the same people at the same tasks without a robot."""
    participants = np.array(trial_participants(entry.trials.count, entry.run.participants), dtype=np.int64)
    tasks = np.arange(entry.trials.count, dtype=np.int64)
    found = {
        metric: paired_difference.difference_of_values(
            metric_values(without, metric, alone=True),
            metric_values(held, metric, alone=False),
            tasks,
            participants,
            registry.get(metric),
            limit_s=held.time_limit_s,
        )
        for metric in UPLIFT_METRICS
    }
    return Uplift(control=control.hashes.run, sr=found["sr"], twsr=found["twsr"], time_s=found["time_s"])


def _estimate(some: np.ndarray, participants: Sequence[int], metric: str, limit_s: float | None = None) -> Estimate:
    row = some.tolist()
    tasks = [str(place) for place in range(len(row))]
    return intervals.estimate(row, tasks, participants[: len(row)], within=registry.get(metric).range(limit_s))
