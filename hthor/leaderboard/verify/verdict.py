"""Decides whether replayed trials confirm an entry, and gives the reasons.

On the same platform every byte must be the same (V1). On another platform, rounding in the last bits may change a
trial, but rarely and in both directions (V2). An agent that is not deterministic can only be judged by its whole run
(V3): the test is whether the claimed run could be one more run like the replayed one.
"""

import functools
import math
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.leaderboard.entries import trial_outcomes
from hthor.leaderboard.entries.trial_outcomes import Outcomes
from hthor.leaderboard.entries.verification import Tier

ALIKE = 0.99
"""The share of equal outcomes that is needed at least on another platform."""
UNEVEN = {"V2": 0.05, "V3": 0.01}
"""Differences count against an entry if chance alone would favour it this much with less than this probability."""
FLIPS = 2000
"""Random exchanges of sessions from which the probability is estimated (V3)."""
_MILLION = 1_000_000
_SHOWN = 3


class ReplayedTrials(Struct, frozen=True, kw_only=True):
    """Replayed trials, by their place in the run: rows as in `Outcomes.rows`; ``twsr`` in millionths."""

    rows: Mapping[int, bytes]
    met: Mapping[int, bool]
    twsr: Mapping[int, int]


class Verdict(Struct, frozen=True, kw_only=True):
    """Whether the entry passes, how many trials were compared, and the reasons in words."""

    passed: bool
    compared: int
    equal: int
    same_bytes: int
    why: str


def choose_tier(*, repeats: bool, same_platform: bool) -> Tier:
    """How trials must be compared.

    Args:
        repeats: whether the agent gives the same actions every time. same_platform: whether the run was played on a
        platform like the verifier's.
    """
    return "V3" if not repeats else "V1" if same_platform else "V2"


def judge_trials(
    by: Tier, claimed: Outcomes, again: ReplayedTrials, drawn: Sequence[int], participants: Sequence[int]
) -> Verdict:
    """Compare an entry's claims with replayed trials.

    Args:
        drawn: places of the sample. again: has all of them, and may also have trials that had to be played before them.
        participants: the person of each trial.

    Raises:
        ValueError: if a drawn trial is missing, because a verdict on a part of a sample could be manipulated.
    """
    if missing := [place for place in drawn if place not in again.rows]:
        raise ValueError(f"{len(missing)} drawn trials were not played, such as trial {missing[0]}")
    rows = claimed.rows
    same = {place for place, row in again.rows.items() if row == rows[place]}
    alike = {
        place
        for place, row in again.rows.items()
        if trial_outcomes.outcome_bytes(row) == trial_outcomes.outcome_bytes(rows[place])
    }
    if by == "V1":
        passed, why = _bytes(again, same, alike)
    elif by == "V2":
        share = sum(place in alike for place in drawn) / len(drawn)
        gaps = np.array([int(claimed.twsr[place]) - again.twsr[place] for place in drawn])
        passed, why = judge_outcomes(share, gaps, len(drawn))
    else:
        places = sorted(again.rows)
        met = np.array([int(claimed.met[place]) - int(again.met[place]) for place in places])
        twsr = np.array([int(claimed.twsr[place]) - again.twsr[place] for place in places])
        passed, why = judge_means(met, twsr, np.array([participants[place] for place in places]))
    return Verdict(passed=passed, compared=len(again.rows), equal=len(alike), same_bytes=len(same), why=why)


def _bytes(again: ReplayedTrials, same: set[int], alike: set[int]) -> tuple[bool, str]:
    """Whether all records are the same, including records outside the sample, and the reasons."""
    other = sorted(set(again.rows) - same)
    if not other:
        return True, f"all {len(again.rows)} records are the same byte for byte"
    worse = len(set(other) - alike)
    shown = ", ".join(map(str, other[:_SHOWN])) + (" and others" if len(other) > _SHOWN else "")
    return (
        False,
        f"{len(other)} of {len(again.rows)} records are not the same, {worse} in their outcome: trials {shown}",
    )


def judge_outcomes(share: float, gaps: np.ndarray, count: int) -> tuple[bool, str]:
    """Whether nearly all outcomes of the sample are equal and the others do not favour the entry, and the reasons."""
    told = f"{100 * share:.1f} % of {count} drawn outcomes are the same; {100 * ALIKE:.0f} % are asked for"
    if share < ALIKE:
        return False, told
    better, worse = int((gaps > 0).sum()), int((gaps < 0).sum())
    chance = binomial_tail(better, better + worse)
    uneven = f"of {better + worse} that differ {better} favour the entry (p = {chance:.2g})"
    return chance >= UNEVEN["V2"], f"{told}; {uneven}"


def judge_means(met: np.ndarray, twsr: np.ndarray, participants: np.ndarray) -> tuple[bool, str]:
    """Whether the claimed run is better than the replayed run by no more than two runs of one agent differ.

    Args:
        met, twsr: by how much the entry claims more than was replayed in each trial, (N,); ``twsr`` in millionths.
        participants: the person of each trial.
    """
    told, passed = [], True
    for name, gaps, unit in (("success", met, 1.0), ("time-weighted success", twsr, 1.0 / _MILLION)):
        chance = exchange_probability(gaps, participants)
        passed = passed and chance >= UNEVEN["V3"]
        told.append(f"{100 * unit * float(gaps.mean()):+z.1f} points of {name} (p = {chance:.2g})")
    return passed, f"over {len(met)} trials the entry claims {' and '.join(told)} more than came out"


def exchange_probability(gaps: np.ndarray, participants: np.ndarray) -> float:
    """The probability of a difference this large if each person's two sessions could be exchanged."""
    sums = np.bincount(participants - participants.min(), weights=gaps.astype(np.float64))
    sums = sums[sums != 0.0]
    if not len(sums):
        return 1.0
    signs = _signs(len(sums))
    return float((1 + (signs @ sums >= sums.sum() - 1e-9).sum()) / (1 + FLIPS))


@functools.cache
def _signs(count: int) -> np.ndarray:
    """Random signs, (FLIPS, count); the same ``count`` gives the same signs on every machine."""
    bits = np.random.default_rng(abs(seeds.derive(0, "exchanged", count)))
    return bits.integers(0, 2, (FLIPS, count)) * 2 - 1


def binomial_tail(count: int, of: int) -> float:
    """The probability of this many heads or more in ``of`` throws of a coin."""
    return float(sum(math.comb(of, k) for k in range(count, of + 1)) / 2**of)
