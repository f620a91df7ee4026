"""``python -m benchmarks.recovery``: are people's parameters found again in their logs? Some ten minutes of one core.

Populations are drawn from the prior; of each, a dozen simulated people do ten tasks in the real world, and the
estimators read their logs. Printed is how true and estimated values correlate, and how many of the 90 % intervals held
the truth.
"""

from __future__ import annotations

import argparse
import sys

from hthor import code_identity
from hthor.calibration.from_logs import parameter_recovery


def main() -> None:
    """Simulate, estimate, print; exit code 1 when a bar is missed."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.recovery", description=__doc__.splitlines()[0])
    options.add_argument("--datasets", type=int, default=32, help="how many populations (%(default)s)")
    options.add_argument(
        "--first", type=int, default=0, help="number of the first, for several processes (%(default)s)"
    )
    options.add_argument("--people", type=int, default=12, help="people of each (%(default)s)")
    options.add_argument("--suite", default="paper", help="the tasks they do (%(default)s)")
    options.add_argument("--seed", type=int, default=0)
    given = options.parse_args()
    code_identity.keep_compiled()
    datasets = []
    for dataset in parameter_recovery.run_recovery(
        given.datasets, people=given.people, seed=given.seed, suite=given.suite, first=given.first
    ):
        datasets.append(dataset)
        print(f"{len(datasets)} of {given.datasets} datasets", file=sys.stderr)
    rows = parameter_recovery.summarize_recovery(datasets)
    print(f"{'parameter':12} {'r':>6} {'covered':>8} {'datasets':>9}  bar")
    for row in rows:
        verdict = "" if row.bar is None else f"{row.bar:.1f} {'met' if row.passed else 'MISSED'}"
        print(f"{row.name:12} {row.r:6.3f} {row.covered:8.2f} {row.datasets:9d}  {verdict}")
    if not all(row.passed for row in rows):
        sys.exit(1)


if __name__ == "__main__":
    main()
