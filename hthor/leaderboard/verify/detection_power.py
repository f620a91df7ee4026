"""How surely a verification would have caught a forged entry: by simulation over what it saw; plays nothing.

The forger makes one outcome in twenty a success, three of sixty, and everything else follow from that. They know
nothing of the draw, and a new draw of the same size meets them. What chance does without them is what was seen: where
the entry and the new trials differ, either could have been the claim.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hthor import seeds
from hthor.leaderboard.entries import trial_outcomes
from hthor.leaderboard.entries.trial_outcomes import Outcomes
from hthor.leaderboard.entries.verification import Tier
from hthor.leaderboard.verify import verdict
from hthor.leaderboard.verify.verdict import Again

TURNED = 0.05
"""The share of all outcomes that the forger turns."""
_GAMES = 400
_WORTH = 600_000
"""Time-weighted success of a turned trial, in millionths."""


def chance(by: Tier, claimed: Outcomes, again: Again, drawn: Sequence[int], whose: Sequence[int]) -> float:
    """The probability that this tier refutes such an entry with so large a draw."""
    count = len(claimed.met)
    turned = max(1, round(TURNED * count))
    if by == "V1":
        return round(_hit(count, len(again.rows), turned), 4)
    places = list(drawn) if by == "V2" else sorted(again.rows)
    draw = np.random.default_rng(abs(seeds.derive(0, "catching", by, count, len(places))))
    game = _outcomes if by == "V2" else _whole
    return round(sum(game(claimed, again, places, whose, turned, draw) for _ in range(_GAMES)) / _GAMES, 4)


def _hit(count: int, compared: int, turned: int) -> float:
    """The probability that of so many turned trials one is among those that were compared."""
    if turned > count - compared:
        return 1.0
    return 1.0 - math.comb(count - compared, turned) / math.comb(count, turned)


def _forge(
    claimed: Outcomes, again: Again, places: Sequence[int], whose: np.ndarray, turned: int, draw: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """An honest claim, as chance might have had it, that was forged: gaps of success and of its worth, what differs."""
    met = np.array([[bool(claimed.met[place]), again.met[place]] for place in places])
    twsr = np.array([[int(claimed.twsr[place]), again.twsr[place]] for place in places])
    swap = draw.integers(0, 2, int(whose.max()) + 1)[whose]
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


def _outcomes(
    claimed: Outcomes, again: Again, places: Sequence[int], whose: Sequence[int], turned: int, draw: np.random.Generator
) -> bool:
    del whose
    _, worth, lies = _forge(claimed, again, places, np.arange(len(places)), turned, draw)
    rows = [
        (trial_outcomes.outcome(again.rows[place]), trial_outcomes.outcome(row))
        for place, row in _rows(claimed, places)
    ]
    other = {number for number, (came, said) in enumerate(rows) if came != said} | set(lies.tolist())
    return not verdict.by_outcomes(1.0 - len(other) / len(places), worth, len(places))[0]


def _rows(claimed: Outcomes, places: Sequence[int]) -> list[tuple[int, bytes]]:
    rows = claimed.rows
    return [(place, rows[place]) for place in places]


def _whole(
    claimed: Outcomes, again: Again, places: Sequence[int], whose: Sequence[int], turned: int, draw: np.random.Generator
) -> bool:
    owners = np.array([whose[place] for place in places])
    met, worth, _ = _forge(claimed, again, places, owners, turned, draw)
    return not verdict.as_a_whole(met, worth, owners)[0]
