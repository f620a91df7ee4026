"""How surely a forged entry is caught: `python -m benchmarks.forging`; the draw and the comparison are real, the trials
are those of a made-up entry, so that a thousand draws take seconds.

A forger changes some outcomes to the better and makes everything follow from that, hashes too, so that only playing
trials again can tell. `python -m benchmarks.forging ENTRY OUT` writes such a copy of a real entry.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
import numpy as np

from hthor import seeds, tasks
from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries import entry_metrics, files, trial_outcomes
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.trial_outcomes import Outcomes
from hthor.leaderboard.verify import verdict, verify
from hthor.tasks import Suite
from hthor.types import TaskSpec

COUNT, SAMPLE = 2000, 200
SHARES = (0.005, 0.01, 0.03, 0.05)
_MILLION = 1_000_000


def forged(entry: Entry, share: float, control: Entry | None = None, suite: Suite | None = None) -> Entry:
    """A copy of an entry in which this share of the trials, or all that failed, did better; the copy is in order.

    Args:
        control: the entry without a robot that its uplift is over. suite: its tasks, so that what the times are worth
            follows from them too.
    """
    held = better(
        trial_outcomes.unpack(entry.trials), share, tasks=trial_outcomes.tasks_of_trials(suite, entry) if suite else ()
    )
    whose = entry_metrics.trial_participants(entry.trials.count, entry.run.participants)
    fresh: dict[str, Estimate] = entry_metrics.entry_scores(held, whose, alone=entry.alone)
    return msgspec.structs.replace(
        entry,
        metrics=msgspec.structs.replace(entry.metrics, **fresh),
        counts=msgspec.structs.replace(entry.counts, successes=int(held.met.sum())),
        splits=entry_metrics.split_scores(held, whose),
        uplift=entry_metrics.entry_uplift(entry, held, control, trial_outcomes.unpack(control.trials))
        if control
        else entry.uplift,
        hashes=msgspec.structs.replace(entry.hashes, merkle=held.merkle),
        trials=trial_outcomes.pack(held),
    )


def better(held: Outcomes, share: float, seed: int = 0, tasks: Sequence[TaskSpec] = ()) -> Outcomes:
    """The same trials, but this share of all did better: of those that failed, as far as there are enough."""
    failed = np.flatnonzero(~held.met)
    order = seeds.shuffled(len(failed), seed, "forging")
    chosen = failed[order[: round(share * len(held.met))]]
    met, twsr, time = held.met.copy(), held.twsr.copy(), held.time.copy()
    met[chosen], twsr[chosen], time[chosen] = True, _MILLION * 6 // 10, 600
    for place in chosen.tolist() if tasks else ():
        good = tasks[place].t_star
        twsr[place] = round(_MILLION * round(good / max(good, 60.0), 6))
    return msgspec.structs.replace(held, met=met, twsr=twsr, time=time)


def made_up(seed: int = 0, count: int = COUNT) -> Outcomes:
    """A run's columns that never was."""
    chance = np.random.default_rng(seed)
    met = chance.random(count) < 0.72
    time = np.where(met, chance.integers(150, 900, count), 900)
    return Outcomes(
        met=met,
        adopted=np.zeros(count, dtype=bool),
        faulty=np.zeros(count, dtype=bool),
        twsr=np.where(met, np.minimum(_MILLION, 300 * _MILLION // np.maximum(time, 1)), 0),
        time=time,
        trust=chance.integers(1, 8, count),
        sent=np.ones(count, dtype=np.int64),
        accepted=np.zeros(count, dtype=np.int64),
        useful=np.zeros(count, dtype=np.int64),
        leaves=[chance.bytes(trial_outcomes.LEAF) for _ in range(count)],
        labels={},
    )


def caught(
    tier: verdict.Tier, share: float, draws: int, *, sample: int = SAMPLE, count: int = COUNT, noise: float = 0.0
) -> int:
    """In how many draws an entry is refuted of which this share of the outcomes was made better.

    Args:
        sample: trials that are drawn, of ``count``. noise: the share of trials in which two runs of the agent differ in
            success, either way, for an agent that does not repeat itself.
    """
    true = made_up(count=count)
    claimed = better(true, share)
    whose = entry_metrics.trial_participants(count, count // 10)
    found = 0
    for number in range(draws):
        drawn = verify.draw_sample(f"commit {number}", claimed.merkle, count, sample)
        came = _another(true, noise, number)
        rows = came.rows
        again = verdict.ReplayedTrials(
            rows={place: rows[place] for place in drawn},
            met={place: bool(came.met[place]) for place in drawn},
            twsr={place: int(came.twsr[place]) for place in drawn},
        )
        found += not verdict.judge_trials(tier, claimed, again, drawn, whose).passed
    return found


def _another(true: Outcomes, noise: float, number: int) -> Outcomes:
    """Another run of the same agent: of so many trials the success comes out otherwise, either way as often."""
    if not noise:
        return true
    chance = np.random.default_rng(number)
    met, twsr, half = true.met.copy(), true.twsr.copy(), round(noise * len(true.met) / 2)
    lost = chance.permutation(np.flatnonzero(true.met))[:half]
    won = chance.permutation(np.flatnonzero(~true.met))[:half]
    met[lost], twsr[lost], met[won], twsr[won] = False, 0, True, _MILLION * 6 // 10
    return msgspec.structs.replace(true, met=met, twsr=twsr)


def main() -> None:
    """Print the table, or write a forged entry."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.forging", description=__doc__.splitlines()[0])
    options.add_argument("entry", nargs="?", type=Path, help="an entry's file")
    options.add_argument("out", nargs="?", type=Path, help="where its forged copy goes")
    options.add_argument("--share", type=float, default=0.3, help="of the trials that do better there (%(default)s)")
    options.add_argument("--suite", default="", help="the suite of the entry, for what times are worth")
    options.add_argument("--draws", type=int, default=1000, help="for the table (%(default)s)")
    given = options.parse_args()
    if given.entry is not None and given.out is not None:
        entry = files.read_entry(given.entry)
        beside = [files.read_entry(path) for path in sorted(given.entry.parent.glob("*.json"))]
        control = next((one for one in beside if entry.uplift and one.hashes.run == entry.uplift.control), None)
        suite = tasks.load_suite(given.suite) if given.suite else None
        files.write_document(given.out, forged(entry, given.share, control, suite))
        return
    for line in _lines(given.draws):
        print(line, flush=True)


CASES: tuple[tuple[str, verdict.Tier, int, int, float], ...] = (
    ("V1", "V1", 2000, 200, 0.0),
    ("V2", "V2", 2000, 200, 0.0),
    ("V3, 20 % of trials differ from run to run", "V3", 2000, 200, 0.2),
    ("V3, all drawn, 20 % differ", "V3", 2000, 2000, 0.2),
    ("V1, 60 tasks", "V1", 60, 20, 0.0),
    ("V2, 60 tasks", "V2", 60, 20, 0.0),
    ("V1, 60 tasks, all drawn", "V1", 60, 60, 0.0),
    ("V2, 60 tasks, all drawn", "V2", 60, 60, 0.0),
    ("V3, 60 tasks, all drawn, none differs", "V3", 60, 60, 0.0),
)
"""How entries are verified: the tier, how many trials there are and are drawn, and how many differ between runs."""


def _lines(draws: int) -> Iterator[str]:
    yield "| of " + str(draws) + " draws | trials | drawn | none | 0.5 % | 1 % | 3 % | 5 % |"
    yield "|---|---|---|---|---|---|---|---|"
    for name, tier, count, sample, noise in CASES:
        shares = (0.0, *SHARES)
        counts = [caught(tier, share, draws, sample=sample, count=count, noise=noise) for share in shares]
        yield f"| {name} | {count} | {sample} | " + " | ".join(str(found) for found in counts) + " |"


if __name__ == "__main__":
    main()
