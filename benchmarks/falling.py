"""What fall of success fresh tasks show: `python -m benchmarks.falling`; the test is real, the entry is made up.

The entry has 2000 trials of 200 people. For each number of fresh tasks: the smallest fall that is seen in four of five
cases, and how often an agent is flagged that did not fall.
"""

from __future__ import annotations

import numpy as np

from hthor.leaderboard.entries import entry_metrics
from hthor.leaderboard.verify import performance_drop

COUNT, PEOPLE = 2000, 200
SHARES, FRESH = (0.6, 0.72, 0.89), (60, 100, 200, 400)


def entry(share: float, seed: int = 0) -> np.ndarray:
    """Success in each trial; people differ."""
    chance = np.random.default_rng(seed)
    whose = np.array(entry_metrics.trial_participants(COUNT, PEOPLE))
    own = np.clip(share + 0.08 * chance.standard_normal(PEOPLE), 0.0, 1.0)
    return (chance.random(COUNT) < own[whose]).astype(np.float64)


def main() -> None:
    """Print the table."""
    print("| success claimed | " + " | ".join(f"{count} fresh tasks" for count in FRESH) + " |")
    print("|---|" + "---|" * len(FRESH))
    whose = entry_metrics.trial_participants(COUNT, PEOPLE)
    for share in SHARES:
        claimed, cells = entry(share), []
        for count in FRESH:
            seen = performance_drop.detectable_drop(claimed, whose, count)
            false = performance_drop.detection_rate(claimed, whose, count, 0.0)
            cells.append(f"{'none' if seen is None else f'{100 * seen:.0f} points'} ({100 * false:.1f} %)")
        print(f"| {100 * share:.0f} % | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
