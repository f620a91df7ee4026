"""Where a person expects the target: common knowledge mixed with not knowing; knows nothing of any one house."""

from __future__ import annotations

from functools import cache

from hthor import catalog
from hthor.catalog import priors


@cache
def supports(target: str) -> dict[str, float]:
    """Share of common knowledge on each of the eight receptacles; adds up to 1, uniform for an unknown target.

    A target *near* another object is where that object would be; references that are neither are left out.
    """
    kinds = catalog.RECEPTACLES
    mass = dict.fromkeys(kinds, 0.0)
    for (relation, reference), weight in _weights(target).items():
        if reference in mass:
            mass[reference] += weight
        elif relation == "near":
            for kind, share in _direct(reference).items():
                mass[kind] += weight * share
    total = sum(mass.values())
    return {kind: mass[kind] / total if total > 0.0 else 1.0 / len(kinds) for kind in kinds}


def expectation(target: str, w_prior: float) -> dict[str, float]:
    """Belief in each kind of receptacle: ``w_prior`` of `supports`, the rest uniform; adds up to 1."""
    known = supports(target)
    return {kind: w_prior * share + (1.0 - w_prior) / len(known) for kind, share in known.items()}


def _weights(target: str) -> dict[tuple[str, str], float]:
    return priors.weights(target) if target in catalog.TARGETS else {}


def _direct(target: str) -> dict[str, float]:
    """Share of each receptacle among those that a target lies on or in; empty for what is no target."""
    found = {ref: weight for (_, ref), weight in _weights(target).items() if ref in catalog.RECEPTACLES}
    total = sum(found.values())
    return {ref: weight / total for ref, weight in found.items()}
