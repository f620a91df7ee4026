"""Which entries are one agent: ranks count each once.

Two entries are of the same agent when a team submitted both under one name, as versions of it; when their code is the
same, no matter who submitted it; or when they did nearly the same, trial by trial.
"""

from collections.abc import Sequence

import numpy as np

from hthor import rules
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.trial_outcomes import Outcomes

ALIKE = 0.9
"""The share of trials with the same success and nearly the same time from which two agents are one. No robot and the
frontier robot, the most alike of the references, agree in about half of the trials of ``standard``; see
docs/leaderboard.md."""
NEAR_S = 1.0
"""How far two times may be from each other [s]."""


def group_duplicates(entries: Sequence[Entry], held: Sequence[Outcomes]) -> list[list[int]]:
    """Entries that are one agent, as groups of their places; linked entries are in one group."""
    home = list(range(len(entries)))

    def root(place: int) -> int:
        while home[place] != place:
            place = home[place]
        return place

    for one in range(len(entries)):
        for other in range(one):
            if _is_one(entries[one], entries[other]) or similarity(held[one], held[other]) >= ALIKE:
                home[root(one)] = root(other)
    groups: dict[int, list[int]] = {}
    for place in range(len(entries)):
        groups.setdefault(root(place), []).append(place)
    return list(groups.values())


def representatives(entries: Sequence[Entry], held: Sequence[Outcomes]) -> dict[str, str]:
    """For each entry by its id, the one that is counted in its place: of a group the best, of equals the first."""
    found: dict[str, str] = {}
    for group in group_duplicates(entries, held):
        best = min(
            group, key=lambda place: (-int(held[place].met.sum()), -int(held[place].twsr.sum()), entries[place].id)
        )
        found |= {entries[place].id: entries[best].id for place in group}
    return found


def similarity(one: Outcomes, other: Outcomes) -> float:
    """The share of trials in which both did the same: success as much as time, to within `NEAR_S`."""
    if len(one.met) != len(other.met):
        return 0.0
    near = np.abs(one.time - other.time) <= round(NEAR_S / rules.TICK_S)
    return float((near & (one.met == other.met)).mean())


def _is_one(one: Entry, other: Entry) -> bool:
    named = (one.team, one.agent.name) == (other.team, other.agent.name)
    return named or (bool(one.code) and set(one.code) == set(other.code))
