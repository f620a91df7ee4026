"""How surely a forged entry is caught: `python -m benchmarks.forging`; the draw and the comparison are real, the trials
are those of a made-up entry, so that a thousand draws take seconds.

A forger changes some outcomes to the better and makes everything follow from that, hashes too, so that only playing
trials again can tell. `python -m benchmarks.forging ENTRY OUT` writes such a copy of a real entry.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np

from hthor import seeds
from hthor.eval.stats import Estimate
from hthor.leaderboard import draw, files, outcomes, verdict, worth
from hthor.leaderboard.entry import Entry
from hthor.leaderboard.outcomes import Outcomes

COUNT, PEOPLE, SAMPLE = 2000, 200, 200
SHARES = (0.005, 0.01, 0.03, 0.05)
_MILLION = 1_000_000


def forged(entry: Entry, share: float, control: Entry | None = None) -> Entry:
    """A copy of an entry in which this share of the trials, or all that failed, did better; the copy is in order.

    Args:
        control: the entry without a robot that its uplift is over.
    """
    held = better(outcomes.unpack(entry.trials), share)
    whose = worth.people(entry.trials.count, entry.run.participants)
    fresh: dict[str, Estimate] = worth.scores(held, whose, alone=entry.alone)
    return msgspec.structs.replace(
        entry,
        metrics=msgspec.structs.replace(entry.metrics, **fresh),
        counts=msgspec.structs.replace(entry.counts, successes=int(held.met.sum())),
        splits=worth.splits(held, whose),
        uplift=worth.uplift(entry, held, control, outcomes.unpack(control.trials)) if control else entry.uplift,
        hashes=msgspec.structs.replace(entry.hashes, merkle=held.merkle),
        trials=outcomes.pack(held),
        verification=None,
    )


def better(held: Outcomes, share: float, seed: int = 0) -> Outcomes:
    """The same trials, but this share of all did better: of those that failed, as far as there are enough."""
    failed = np.flatnonzero(~held.met)
    order = seeds.shuffled(len(failed), seed, "forging")
    chosen = failed[order[: round(share * len(held.met))]]
    met, twsr, time = held.met.copy(), held.twsr.copy(), held.time.copy()
    met[chosen], twsr[chosen], time[chosen] = True, _MILLION * 6 // 10, 600
    return msgspec.structs.replace(held, met=met, twsr=twsr, time=time)


def made_up(seed: int = 0) -> Outcomes:
    """A run's columns that never was."""
    chance = np.random.default_rng(seed)
    met = chance.random(COUNT) < 0.72
    time = np.where(met, chance.integers(150, 900, COUNT), 900)
    return Outcomes(
        met=met,
        adopted=chance.random(COUNT) < 0.5,
        faulty=np.zeros(COUNT, dtype=bool),
        twsr=np.where(met, np.minimum(_MILLION, 300 * _MILLION // np.maximum(time, 1)), 0),
        time=time,
        trust=chance.integers(1, 8, COUNT),
        leaves=[chance.bytes(outcomes.LEAF) for _ in range(COUNT)],
        labels={},
    )


def caught(tier: verdict.Tier, share: float, draws: int, *, sample: int = SAMPLE) -> int:
    """In how many draws an entry is refuted of which this share of the outcomes was made better."""
    true = made_up()
    claimed = better(true, share)
    rows, whose = true.rows, worth.people(COUNT, PEOPLE)
    found = 0
    for number in range(draws):
        drawn = draw.sample(f"commit {number}", claimed.merkle, COUNT, sample)
        again = verdict.Again(
            rows={place: rows[place] for place in drawn},
            met={place: bool(true.met[place]) for place in drawn},
            twsr={place: int(true.twsr[place]) for place in drawn},
        )
        found += not verdict.judge(tier, claimed, again, drawn, whose).passed
    return found


def main() -> None:
    """Print the table, or write a forged entry."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.forging", description=__doc__.splitlines()[0])
    options.add_argument("entry", nargs="?", type=Path, help="an entry's file")
    options.add_argument("out", nargs="?", type=Path, help="where its forged copy goes")
    options.add_argument("--share", type=float, default=0.3, help="of the trials that do better there (%(default)s)")
    options.add_argument("--draws", type=int, default=1000, help="for the table (%(default)s)")
    given = options.parse_args()
    if given.entry is not None and given.out is not None:
        entry = files.read(given.entry)
        beside = [files.read(path) for path in sorted(given.entry.parent.glob("*.json"))]
        control = next((one for one in beside if entry.uplift and one.hashes.run == entry.uplift.control), None)
        files.write(given.out, forged(entry, given.share, control))
        return
    print(f"caught of {given.draws} draws of {SAMPLE} among {COUNT} trials\n", file=sys.stderr)
    for line in _lines(given.draws):
        print(line)


def _lines(draws: int) -> Iterator[str]:
    yield "| changed outcomes | V1 | V2 | V3 |"
    yield "|---|---|---|---|"
    for share in (0.0, *SHARES):
        counts = (caught(tier, share, draws) for tier in ("V1", "V2", "V3"))
        yield f"| {100 * share:g} % | " + " | ".join(str(count) for count in counts) + " |"


if __name__ == "__main__":
    main()
