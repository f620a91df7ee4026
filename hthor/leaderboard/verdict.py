"""Whether trials that were played again bear an entry out, and on which grounds; plays nothing.

On the same platform every byte must be the same (V1). On another, chance in the last bits may turn a trial, but rarely
and to either side (V2). An agent that does not repeat itself can only be judged on the whole (V3).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from msgspec import Struct

from hthor.eval import stats
from hthor.eval.stats import Estimate
from hthor.leaderboard import outcomes
from hthor.leaderboard.outcomes import Outcomes

Tier = Literal["V1", "V2", "V3"]
ALIKE = 0.99
"""The least share of equal outcomes on another platform."""
UNEVEN = {"V2": 0.05, "V3": 0.01}
"""Mismatches that favour the entry so much as chance would do with less than this probability count against it."""
_MILLION = 1_000_000
_SHOWN = 3


class Again(Struct, frozen=True, kw_only=True):
    """Trials that were played again, by their place in the run: rows as `Outcomes.rows`, ``twsr`` in millionths."""

    rows: Mapping[int, bytes]
    met: Mapping[int, bool]
    twsr: Mapping[int, int]


class Verdict(Struct, frozen=True, kw_only=True):
    """Whether the entry stands, what was compared, and why, in words."""

    passed: bool
    compared: int
    equal: int
    same_bytes: int
    why: str


def tier(*, repeats: bool, same_platform: bool) -> Tier:
    """How the comparison has to be made.

    Args:
        repeats: whether the agent gives the same actions every time. same_platform: whether it was played on one like
            the verifier's.
    """
    return "V3" if not repeats else "V1" if same_platform else "V2"


def judge(by: Tier, claimed: Outcomes, again: Again, drawn: Sequence[int], whose: Sequence[int]) -> Verdict:
    """Compare what an entry says with what came out.

    Args:
        drawn: places of the sample; ``again`` has them, and may have others that had to be played with them.
        whose: the person of each trial.
    """
    rows = claimed.rows
    same = {place for place, row in again.rows.items() if row == rows[place]}
    alike = {place for place, row in again.rows.items() if outcomes.outcome(row) == outcomes.outcome(rows[place])}
    passed, why = {"V1": _bytes, "V2": _outcomes, "V3": _means}[by](claimed, again, drawn, whose, same, alike)
    return Verdict(passed=passed, compared=len(again.rows), equal=len(alike), same_bytes=len(same), why=why)


def _bytes(
    claimed: Outcomes, again: Again, drawn: Sequence[int], whose: Sequence[int], same: set[int], alike: set[int]
) -> tuple[bool, str]:
    """All records are the same, those that were not drawn too."""
    del claimed, drawn, whose
    other = sorted(set(again.rows) - same)
    if not other:
        return True, f"all {len(again.rows)} records are the same byte for byte"
    worse = len(set(other) - alike)
    shown = ", ".join(map(str, other[:_SHOWN])) + (" and others" if len(other) > _SHOWN else "")
    return (
        False,
        f"{len(other)} of {len(again.rows)} records are not the same, {worse} in their outcome: trials {shown}",
    )


def _outcomes(
    claimed: Outcomes, again: Again, drawn: Sequence[int], whose: Sequence[int], same: set[int], alike: set[int]
) -> tuple[bool, str]:
    """Nearly all outcomes of the sample are the same, and the others do not favour the entry."""
    del whose, same
    share = sum(place in alike for place in drawn) / len(drawn)
    told = f"{100 * share:.1f} % of {len(drawn)} drawn outcomes are the same; {100 * ALIKE:.0f} % are asked for"
    if share < ALIKE:
        return False, told
    return _evenly(claimed, again, drawn, UNEVEN["V2"], told)


def _means(
    claimed: Outcomes, again: Again, drawn: Sequence[int], whose: Sequence[int], same: set[int], alike: set[int]
) -> tuple[bool, str]:
    """The claimed means are not above the new trials' intervals, and trials that turned do not favour the entry."""
    del same, alike
    people = [whose[place] for place in drawn]
    told = []
    for name, fresh, said in (
        ("success", [float(again.met[place]) for place in drawn], float(claimed.met.mean())),
        ("time-weighted success", [again.twsr[place] / _MILLION for place in drawn], _mean(claimed.twsr)),
    ):
        found = _estimate(fresh, people)
        low, high = found.ci95 or (0.0, 1.0)
        words = f"{name} of {100 * said:.1f} % was claimed, {100 * low:.1f} to {100 * high:.1f} % came out"
        if said > high:
            return False, f"{words} in {len(drawn)} trials"
        told.append(words)
    return _evenly(claimed, again, drawn, UNEVEN["V3"], "; ".join(told))


def _evenly(claimed: Outcomes, again: Again, drawn: Sequence[int], level: float, told: str) -> tuple[bool, str]:
    """The sign test over trials whose time-weighted success is another."""
    gaps = [int(claimed.twsr[place]) - again.twsr[place] for place in drawn]
    better, worse = sum(gap > 0 for gap in gaps), sum(gap < 0 for gap in gaps)
    chance = at_least(better, better + worse)
    uneven = f"of {better + worse} that differ {better} favour the entry (p = {chance:.2g})"
    return chance >= level, f"{told}; {uneven}"


def at_least(count: int, of: int) -> float:
    """The probability of so many heads or more in ``of`` throws of a coin."""
    return float(sum(math.comb(of, k) for k in range(count, of + 1)) / 2**of)


def _mean(twsr: np.ndarray) -> float:
    return float(twsr.mean()) / _MILLION


def _estimate(values: list[float], people: Sequence[int]) -> Estimate:
    tasks = [str(place) for place in range(len(values))]
    return stats.estimate(values, tasks, people, within=stats.SHARE)
