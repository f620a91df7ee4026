"""Study groups of six, drawn from simulated people.

The published study had six people in each condition. A group consists of whole rounds of people, in which every task is
done once, as in the study; as many of its trials are dropped as the study lost. Groups share people, so there can be
many more groups than people, but their spread is that of people drawn from one population.
"""

import math
from collections.abc import Mapping

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.evidence import FIGURES
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS
from hthor.errors import HthorError

Array = np.ndarray
PEOPLE = 6
"""People in a group."""
DRAWS = 4000
"""Number of groups that are drawn."""


class StudyGroups(Struct, frozen=True, kw_only=True, eq=False):
    """The G groups of one condition; arrays (G,), NaN if a group has no such value.

    ``trust`` is (G, T), the mean rating by trial; ``slope`` the mean over people of their slopes [points per trial].
    """

    sr: Array
    twsr: Array
    ratio: Array
    adoption: Array
    lower: Array
    least: Array
    trust: Array
    slope: Array


def group_figures(groups: Mapping[str, StudyGroups]) -> dict[str, Array]:
    """Each of the eight figures in every group, (G,)."""
    return {name: getattr(groups[name.split()[1]], name.split()[0]) for name in FIGURES if name.split()[1] in groups}


def make_groups(
    played: Table,
    t_star: Array,
    *,
    round_size: int,
    valid: Mapping[str, int],
    counted: Mapping[str, int],
    seed: int = 0,
    draws: int = DRAWS,
) -> dict[str, StudyGroups]:
    """Groups of every condition that was run: whole rounds of ``round_size`` people, who together do every task once.

    By condition, ``valid`` of a group's trials count, and ``counted`` for adoption; the rest are dropped at random.

    Raises:
        HthorError: when there are too few people for a group.
    """
    found = {}
    for number, condition in enumerate(CONDITIONS):
        rows = np.flatnonzero(played.condition == number)
        if rows.size:
            one = played.take(rows)
            rng = np.random.Generator(np.random.Philox(key=seeds.derive(seed, "groups", condition)))
            found[condition] = _groups(one, t_star, rng, round_size, valid[condition], counted.get(condition, 0), draws)
    return found


def _groups(
    one: Table, t_star: Array, rng: np.random.Generator, round_size: int, valid: int, counted: int, draws: int
) -> StudyGroups:
    people = _people(one)
    chosen = _chosen(len(people), round_size, rng, draws)  # (G, 6) rows of `people`
    rows = people[chosen].reshape(draws, -1)  # (G, 60) rows of the table
    mixed = np.take_along_axis(rows, np.argsort(rng.random(rows.shape), axis=1), axis=1)
    kept, asked = mixed[:, : valid or None], mixed[:, : counted or None]
    twsr, spent = tables.twsr(one, t_star), tables.time_spent_s(one)
    met = one.met[kept].sum(axis=1)
    trust = one.trust.astype(float)[people][chosen]  # (G, 6, T)
    return StudyGroups(
        sr=one.met[kept].mean(axis=1),
        twsr=twsr[kept].mean(axis=1),
        ratio=np.where(met > 0, twsr[kept].sum(axis=1) / np.maximum(met, 1), np.nan),
        adoption=one.adopted[asked].mean(axis=1),
        lower=np.percentile(spent[kept], 25.0, axis=1),
        least=spent[kept].min(axis=1),
        trust=trust.mean(axis=1),
        slope=slopes(trust).mean(axis=1),
    )


def _people(one: Table) -> Array:
    """(people, T) rows of each person's trials, in order; people in order of their numbers."""
    order = np.lexsort((one.index, one.participant))
    count = len(np.unique(one.participant))
    if len(one) % count or not np.array_equal(one.index[order], np.tile(np.arange(len(one) // count), count)):
        raise HthorError("some people's trials are missing; finish the run by repeating the command.")
    rows: Array = order.reshape(count, -1)
    return rows


def _chosen(count: int, round_size: int, rng: np.random.Generator, draws: int) -> Array:
    """(draws, 6) the people of each group, in whole rounds if six people can be whole rounds."""
    size = round_size if PEOPLE % round_size == 0 else 1
    units, wanted = count // size, PEOPLE // size
    if units < wanted:
        raise HthorError(f"{count} people are too few for a group of {PEOPLE}; ask for {PEOPLE} or more.")
    picked = np.argsort(rng.random((draws, units)), axis=1)[:, :wanted]
    members: Array = (picked[:, :, None] * size + np.arange(size)).reshape(draws, PEOPLE)
    return members


def slopes(trust: Array) -> Array:
    """Least-squares slope along the last axis [points per trial]."""
    steps = np.arange(trust.shape[-1]) - (trust.shape[-1] - 1) / 2.0
    found: Array = (trust * steps).sum(axis=-1) / max(1e-12, float((steps**2).sum()))
    return found


def log_count(k: int, n: int, p: float, phi: float) -> float:
    """Log probability [nats] of k of n clustered trials: beta-binomial, with ``phi`` times the binomial variance."""
    p, rho = min(max(p, 0.005), 0.995), min(max((phi - 1.0) / (n - 1.0), 1e-4), 0.5)
    a, b = p * (1.0 - rho) / rho, (1.0 - p) * (1.0 - rho) / rho
    ways = math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)
    return ways + _log_beta(k + a, n - k + b) - _log_beta(a, b)


def log_normal(x: float, mean: float, sd: float) -> float:
    """Log density [nats] of a normal number."""
    return -0.5 * ((x - mean) / sd) ** 2 - math.log(sd) - 0.5 * math.log(2.0 * math.pi)


def _log_beta(a: float, b: float) -> float:
    return math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)
