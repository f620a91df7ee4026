"""``python -m benchmarks.damage``: see the package."""

from __future__ import annotations

import argparse
import collections
import random
import sys
import tempfile
from pathlib import Path

from benchmarks.damage import files, lines, playground
from benchmarks.damage.asking import ask
from hthor import code_identity


def main() -> None:
    """Damage, ask, and print what did not end as it should; exit code 1 when anything did not."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.damage", description=__doc__.splitlines()[0])
    options.add_argument("--files", type=int, default=2000, help="damaged files (%(default)s)")
    options.add_argument("--lines", type=int, default=300, help="random command lines (%(default)s)")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--playground", type=Path, help="keep the sound files there, for the next time")
    given = options.parse_args()
    code_identity.keep_compiled()
    with tempfile.TemporaryDirectory() as base:
        ground = given.playground or Path(base, "ground")
        if not ground.exists():
            print("making a playground ...", file=sys.stderr)
            playground.make(ground)
        bad = _files(ground, Path(base), given.files, given.seed) + _lines(ground, given.lines, given.seed)
    sys.exit(bool(bad))


def _files(ground: Path, base: Path, count: int, seed: int) -> int:
    codes: collections.Counter[int] = collections.Counter()
    bad = 0
    for number in range(count):
        trial = files.damage(ground, base / f"copy{number}", random.Random(f"{seed} file {number}"))
        codes[trial.code] += 1
        for problem in trial.problems:
            bad += 1
            print(f"file {number}: {trial.path} ({trial.how}), hthor {trial.words}: {problem}", flush=True)
    print(f"{count} damaged files: {bad} problems; exit codes {dict(sorted(codes.items()))}", flush=True)
    return bad


def _lines(ground: Path, count: int, seed: int) -> int:
    codes: collections.Counter[int] = collections.Counter()
    bad = 0
    for number, words in enumerate(lines.lines(random.Random(f"{seed} lines"), count)):
        before = files.contents(ground)
        said = ask(ground, words)
        codes[said.code] += 1
        for problem in (*said.problems(), *files.lost(before, files.contents(ground), said)):
            bad += 1
            print(f"line {number}: hthor {' '.join(map(ascii, words))}: {problem}", flush=True)
    print(f"{count} command lines: {bad} problems; exit codes {dict(sorted(codes.items()))}", flush=True)
    return bad


if __name__ == "__main__":
    main()
