"""``python -m benchmarks``: how fast hthor is, as one table.

Times are CPU time of one process unless a row says otherwise; whatever is compiled is compiled before. Numbers that
are compared come from the same run, so that ratios hold on a noisy machine too.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import sys
from collections.abc import Callable, Iterator

from benchmarks import driving, environment, guests, rendering, scaling, scenes, table, trials
from hthor import code_identity, tasks

PARTS = ("trials", "environment", "rendering", "learners", "processes", "guests")


def main() -> None:
    """Measure and print."""
    options = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.splitlines()[0])
    options.add_argument("--quick", action="store_true", help="fewer repeats: a first idea in about a minute")
    options.add_argument("--json", action="store_true", help="JSON instead of a table")
    options.add_argument("--suite", default=scenes.SUITE, help=f"one of {', '.join(tasks.suite_names())} (%(default)s)")
    options.add_argument("--part", action="append", choices=PARTS, help="only this part; may be given more than once")
    options.add_argument("--profile", default="fast,nice", help="profiles of pictures, comma-separated (%(default)s)")
    given = options.parse_args()
    code_identity.keep_compiled()
    rows: list[table.Row] = []
    for part in given.part or PARTS:
        print(f"measuring {part} ...", file=sys.stderr)
        rows += _measures(given)[part]()
        if not given.json:
            table.put(rows, as_json=False)
            rows = []
    if given.json:
        table.put(rows, as_json=True)


def _measures(given: argparse.Namespace) -> dict[str, Callable[[], Iterator[table.Row]]]:
    suite, quick = given.suite, given.quick
    sizes = (128,) if quick else rendering.SIZES
    profiles = [name for name in given.profile.split(",") if name]
    return {
        "trials": lambda: itertools.chain(
            trials.rows(suite, 2 if quick else 6), driving.rows(suite, 4 if quick else 12)
        ),
        "environment": lambda: environment.rows(scenes.scenes(suite), suite, 1 if quick else 5),
        "rendering": lambda: rendering.rows(scenes.scenes(suite), profiles, sizes),
        "learners": lambda: _learners(600 if quick else 3000),
        "processes": lambda: scaling.rows(suite, 5 if quick else 30),
        "guests": lambda: guests.rows(suite, 300 if quick else 2000, 1 if quick else 3),
    }


def _learners(decisions: int) -> Iterator[table.Row]:
    """The environments of Gymnasium, which are an extra."""
    if importlib.util.find_spec("gymnasium") is None:
        yield table.Row(part="learners", what="decisions", value=None, unit="", remark="needs the extra learn")
        return
    from benchmarks import gym_decisions

    yield from gym_decisions.rows(decisions)


if __name__ == "__main__":
    main()
