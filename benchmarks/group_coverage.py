"""How often the 95 % interval of two groups' difference holds the truth: `python -m benchmarks.group_coverage`.

Trials succeed as in `benchmarks.coverage`. Each group of a between-subjects study has people of its own, who do the
same tasks in the same hands of ten. Plays no trials; with two runs of the same people, `--runs ONE OTHER`, it says how
much wider the intervals of their differences would be if the people had been different.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from benchmarks.coverage import NORMAL, RATES, SPREADS
from hthor.eval.comparison import compare
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import group_difference, paired_difference, pairing, result_file
from hthor.eval.statistics import variance_components

DESIGNS = ((6, 6, 60), (18, 18, 60), (6, 6, 30), (7, 6, 60), (3, 3, 30), (60, 60, 600))
"""People in either group, and tasks of the suite."""


def hands(people: int, tasks: int) -> tuple[np.ndarray, np.ndarray]:
    """Which task and which person each trial of a group has; equal for groups of equal size."""
    chance, each = np.random.default_rng(1), tasks // 10
    decks = [chance.permutation(tasks) for _ in range(math.ceil(people / each))]
    own = [decks[person // each][person % each * 10 : person % each * 10 + 10] for person in range(people)]
    return np.concatenate(own), np.repeat(np.arange(people), 10)


def share_held(
    design: tuple[int, int, int], rate: float, spread: tuple[float, float], repeats: int, difference: float = 0.0
) -> tuple[float, float]:
    """The share of data sets whose interval holds the true difference, and the intervals' mean width."""
    first, second, tasks = design
    task_sd, person_sd = spread
    chance, scale = np.random.default_rng(11), math.sqrt(task_sd**2 + person_sd**2 + 1.0)
    of_task = task_sd * chance.normal(size=(repeats, tasks))
    groups = []
    for people, true in ((first, rate), (second, rate + difference)):
        done, who = hands(people, tasks)
        of_person = person_sd * chance.normal(size=(repeats, people))
        noise = chance.normal(size=(repeats, len(done)))
        level = NORMAL.inv_cdf(true) * scale
        groups.append(((level + of_task[:, done] + of_person[:, who] + noise > 0.0).astype(float), done, who))
    (one, task_one, person_one), (other, task_other, person_other) = groups
    found = group_difference.group_spread(
        one,
        other,
        np.concatenate([task_one, task_other]),
        np.concatenate([person_one, person_other + first]),
        share=True,
    )
    low, high = paired_difference.interval_ends(found, share=True)
    return float(np.mean((low <= difference) & (high >= difference))), float(np.mean(high - low))


def widening(one: Path, other: Path) -> dict[str, float]:
    """For two paired runs: the width of each uplift's interval as if the people were different, over its own width."""
    first, second = compare.load_runs([one, other])
    pairs = pairing.pair_trials(first.records, second.records).pairs
    found = {}
    for metric in result_file.UPLIFT_METRICS:
        own = paired_difference.paired_difference(pairs, metric)
        rows = [np.array([side.metrics.number(metric) for side in some]) for some in _sides(pairs)]
        tasks = variance_components.group_codes([pair.one.spec.task.id for pair in pairs])
        people = variance_components.group_codes([pair.one.spec.session for pair in pairs])
        apart = group_difference.difference_of_groups(
            rows[0],
            rows[1],
            np.concatenate([tasks, tasks]),
            np.concatenate([people, people + int(people.max()) + 1]),
            metric,
            limit_s=pairs[0].one.spec.task.time_limit,
        )
        if own is not None and own.ci95 is not None and apart.ci95 is not None:
            found[metric] = (apart.ci95[1] - apart.ci95[0]) / (own.ci95[1] - own.ci95[0])
    return found


def _sides(pairs: tuple[pairing.Pair, ...]) -> tuple[list[TrialRecord], list[TrialRecord]]:
    return [pair.one for pair in pairs], [pair.other for pair in pairs]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=1000, help="data sets a row")
    parser.add_argument("--runs", type=Path, nargs=2, help="two runs of the same people")
    wanted = parser.parse_args()
    if wanted.runs:
        for metric, ratio in widening(*wanted.runs).items():
            print(f"{metric:8} {ratio:.2f}")
        return
    print("people, tasks     sd task/person   " + "   ".join(f"rate {rate:.2f}" for rate in RATES))
    for design in DESIGNS:
        for spread in SPREADS:
            repeats = min(wanted.repeats, 500_000 // (10 * design[0]))
            row = [share_held(design, rate, spread, repeats) for rate in RATES]
            cells = "   ".join(f"{100.0 * held:5.1f} ({width:.2f})" for held, width in row)
            print(
                f"{design[0]} + {design[1]}, {design[2]:4}      {spread[0]:.1f}/{spread[1]:.1f}   {cells}", flush=True
            )


if __name__ == "__main__":
    main()
