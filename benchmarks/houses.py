"""What the house generator makes of many seeds: how many homes are sound at once, why others are not, what it costs.

Run as ``python -m benchmarks.houses --seeds 300``. Every seed's first attempt is generated twice, which must give the
same bytes, and proved; what is not sound is tried again as `hthor houses generate` would. Times are CPU time.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from msgspec import Struct

from hthor import jsonio
from hthor.console import progress_bar
from hthor.houses import generator, loader
from hthor.world.validation import house_soundness
from hthor.world.validation.house_soundness import check_soundness


class Try(Struct, frozen=True, kw_only=True):
    """One seed: CPU time [s] of its first attempt, of that one's proof and of all until one was sound.

    ``errors`` are those of the first attempt, pairs of a rule and words; ``attempts`` is how many it took.
    """

    seed: int
    rooms: int
    making: float
    proving: float
    whole: float
    same: bool
    errors: tuple[tuple[str, str], ...]
    attempts: int


def main() -> None:
    """Sweep and print."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--seeds", type=int, default=300, help="how many seeds, their rooms 4 to 7 in turn")
    options.add_argument("--first", type=int, default=0, help="the first of them")
    options.add_argument("--reasons", type=int, default=12, help="how many faults to print in words")
    given = options.parse_args()
    house_soundness.generate_valid_home(given.first, 5)  # so that compiling is not counted
    seeds = range(given.first, given.first + given.seeds)
    tries = [_try(seed, 4 + seed % 4) for seed in progress_bar.watched(seeds, "seeds", len(seeds), "seeds")]
    _print(tries, given.reasons)


def _try(seed: int, rooms: int) -> Try:
    begin = time.process_time()
    document, errors = _first(seed, rooms)
    made = time.process_time()
    if document is not None:
        house = loader.house_from_document(document, house_soundness.home_name(seed, rooms))
        found = check_soundness(house, house_soundness.RADIUS_M)
        errors = tuple((finding.rule, str(finding)) for finding in found if finding.severity == "error")
    proved = time.process_time()
    home = house_soundness.generate_valid_home(seed, rooms) if errors else None
    whole = time.process_time()
    same = jsonio.canonical(_first(seed, rooms)[0]) == jsonio.canonical(document)
    return Try(
        seed=seed,
        rooms=rooms,
        making=made - begin,
        proving=proved - made,
        whole=whole - proved if errors else proved - begin,
        same=same,
        errors=errors,
        attempts=1 if home is None else home.attempt + 1,
    )


def _first(seed: int, rooms: int) -> tuple[dict[str, Any] | None, tuple[tuple[str, str], ...]]:
    """The first attempt's document, or why it came to nothing."""
    try:
        return generator.generate(seed, rooms, tries=1), ()
    except generator.GeneratorError as error:
        return None, error.reasons


def _print(tries: Sequence[Try], reasons: int) -> None:
    count = len(tries)
    sound = sum(not one.errors for one in tries)
    print(f"{count} seeds, rooms 4 to 7 in turn, radius {house_soundness.RADIUS_M} m")
    print(f"sound before any retry  {sound:5d}  {sound / count:7.1%}")
    print(f"sound after retries     {count:5d}  {1:7.1%}   attempts at most {max(one.attempts for one in tries)}")
    print(f"same bytes when made again  {sum(one.same for one in tries)} of {count}")
    for rooms in sorted({one.rooms for one in tries}):
        of = [one for one in tries if one.rooms == rooms]
        print(f"  {rooms} rooms: {sum(not one.errors for one in of)} of {len(of)} sound at once")
    print(f"{'CPU time, s':28}{'median':>8}{'p90':>8}{'max':>8}")
    _row("generating one attempt", [one.making for one in tries])
    _row("proving it", [one.proving for one in tries if one.proving > 1e-3])
    _row("until sound, all attempts", [one.whole for one in tries])
    tally = Counter(rule for one in tries for rule in {rule for rule, _ in one.errors})
    for rule, number in tally.most_common():
        print(f"  {number:4d} seeds break {rule}")
    told = [(one, words) for one in tries for _, words in one.errors][:reasons]
    for one, words in told:
        print(f"  seed {one.seed}, {one.rooms} rooms: {words}")


def _row(name: str, values: Sequence[float]) -> None:
    tenths = statistics.quantiles(values, n=10, method="inclusive")
    print(f"{name:28}{statistics.median(values):8.3f}{tenths[8]:8.3f}{max(values):8.3f}")


if __name__ == "__main__":
    main()
