"""The probability that a verification would have caught a forged entry, simulated from the observed trials.

The forger turns one outcome in twenty (three of sixty) into a success, with all numbers consistent, without knowing
which trials will be drawn. Random differences between runs are taken from the observed ones: where the entry and the
replayed trials differ, either of them could have been claimed.
"""

import math
from collections.abc import Sequence

import numpy as np

from hthor import seeds
from hthor.leaderboard.entries import trial_outcomes
from hthor.leaderboard.entries.trial_outcomes import Outcomes
from hthor.leaderboard.entries.verification import Tier
from hthor.leaderboard.verify import verdict
from hthor.leaderboard.verify.verdict import ReplayedTrials

TURNED = 0.05
"""The share of all outcomes that the forger changes."""
_GAMES = 400
_WORTH = 600_000
"""Time-weighted success of a changed trial, in millionths."""


def detection_probability(
    by: Tier, claimed: Outcomes, again: ReplayedTrials, drawn: Sequence[int], participants: Sequence[int]
) -> float:
    """The probability that this tier refutes an entry forged in this way, with a sample of this size."""
    count = len(claimed.met)
    turned = max(1, round(TURNED * count))
    if by == "V1":
        return round(_hit(count, len(again.rows), turned), 4)
    places = list(drawn) if by == "V2" else sorted(again.rows)
    draw = np.random.default_rng(abs(seeds.derive(0, "catching", by, count, len(places))))
    owners = np.arange(len(places)) if by == "V2" else np.array([participants[place] for place in places])
    outcome, rows = trial_outcomes.outcome_bytes, claimed.rows
    unlike = {number for number, place in enumerate(places) if outcome(again.rows[place]) != outcome(rows[place])}
    caught = 0
    for _ in range(_GAMES):
        gaps, worth, lies = _forge(claimed, again, places, owners, turned, draw)
        if by == "V2":
            share = 1.0 - len(unlike | set(lies.tolist())) / len(places)
            caught += not verdict.judge_outcomes(share, worth, len(places))[0]
        else:
            caught += not verdict.judge_means(gaps, worth, owners)[0]
    return round(caught / _GAMES, 4)


def _hit(count: int, compared: int, turned: int) -> float:
    """The probability that at least one changed trial is among the compared trials."""
    if turned > count - compared:
        return 1.0
    return 1.0 - math.comb(count - compared, turned) / math.comb(count, turned)


def _forge(
    claimed: Outcomes,
    again: ReplayedTrials,
    places: Sequence[int],
    participants: np.ndarray,
    turned: int,
    draw: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forge a random honest claim; return the differences of success and of TWSR, and the forged trials."""
    met = np.array([[bool(claimed.met[place]), again.met[place]] for place in places])
    twsr = np.array([[int(claimed.twsr[place]), again.twsr[place]] for place in places])
    swap = draw.integers(0, 2, int(participants.max()) + 1)[participants]
    rows = np.arange(len(places))
    said, came = met[rows, swap], met[rows, 1 - swap]
    worth, true = twsr[rows, swap].copy(), twsr[rows, 1 - swap]
    among = int(draw.hypergeometric(turned, len(claimed.met) - turned, len(places)))
    failed = np.flatnonzero(~said)
    lies = draw.permutation(failed)[:among]
    gaps = said.astype(np.int64) - came
    gaps[lies] += 1
    worth[lies] = _WORTH
    return gaps, worth - true, lies
