"""How far equal draws of chance reduce the trials that a comparison needs: `python -m benchmarks.pairing FOLDER`.

Plays `none`, `frontier` and `oracle` on a suite, and prints for each two how their outcomes hang together, and
how many times fewer trials it takes to compare them than with other people at other tasks for each.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

from hthor.eval.comparison import compare
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.runner import experiment, progress

AGENTS = ("none", "frontier", "oracle")


def main() -> None:
    """Play what is missing, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the runs are kept; a second call only prints")
    parser.add_argument("--suite", default="smoke")
    parser.add_argument("--participants", type=int, default=None)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=1, help="the suite is played with seeds 0, 1, ...")
    wanted = parser.parse_args()
    for seed in range(wanted.seeds):
        options = EvalOptions(
            agent=AGENTS,
            suite=wanted.suite,
            participants=wanted.participants,
            jobs=wanted.jobs,
            seed=seed,
            out=wanted.folder / str(seed),
            control=False,
        )
        for _ in experiment.run_experiment(resolve(options), lambda _name: progress.Silent()):
            pass
    print("pair                  n  only 1st/2nd   metric  difference (interval)      r  gain")
    for seed, (one, other) in itertools.product(range(wanted.seeds), itertools.combinations(AGENTS, 2)):
        pair = compare.compare_runs([wanted.folder / str(seed) / name for name in (one, other)]).pairs[0]
        for metric in ("sr", "twsr", "time_s"):
            found = pair.differences[metric]
            low, high = found.ci95 or (0.0, 0.0)
            print(
                f"{one + ' ' + other:20} {found.n:3}  {pair.mcnemar.only_first:3}/{pair.mcnemar.only_second:3}       "
                f"{metric:6} {found.difference:+7.3f} ({low:+.3f} to {high:+.3f})  {found.correlation or 0.0:5.2f}  "
                f"{found.gain or 0.0:.2f}"
            )


if __name__ == "__main__":
    main()
