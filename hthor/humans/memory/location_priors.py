"""Where a person expects the target: common knowledge mixed with not knowing.

Common knowledge are the scene priors of `hthor.catalog.priors`; not knowing is the same belief in every kind of
furniture. Searchers weigh the two against each other, and what they found out since against both ("Why are the
batteries in the microwave?", Cognitive Research 2021): what was searched in vain loses belief by its exposure, see
`hthor.humans.search.option_choice`.
"""

from __future__ import annotations

from functools import cache

from hthor import catalog
from hthor.catalog import priors


@cache
def holders() -> tuple[str, ...]:
    """Kinds of furniture that things are put on or in, in the catalogue's order: what people search, no crockery."""
    return tuple(name for name in catalog.names() if catalog.kind(name).rests() and not catalog.kind(name).pickable)


@cache
def supports(target: str) -> dict[str, float]:
    """Share of common knowledge on each of `holders`; adds up to 1, uniform for an unknown target.

    A target *near* another object is where that object would be, or at the furniture it is near to; references that
    are neither are left out.
    """
    mass = dict.fromkeys(holders(), 0.0)
    for (relation, reference), weight in _weights(target).items():
        if reference in mass:
            mass[reference] += weight
        elif relation == "near":
            for kind, share in _direct(reference).items():
                mass[kind] += weight * share
    total = sum(mass.values())
    return {kind: share / total if total > 0.0 else 1.0 / len(mass) for kind, share in mass.items()}


def expectation(target: str, w_prior: float) -> dict[str, float]:
    """Belief in each kind of furniture: ``w_prior`` of `supports`, the rest uniform; adds up to 1."""
    known = supports(target)
    return {kind: w_prior * share + (1.0 - w_prior) / len(known) for kind, share in known.items()}


def _weights(target: str) -> dict[tuple[str, str], float]:
    return priors.weights(target) if target in catalog.TARGETS else {}


def _direct(target: str) -> dict[str, float]:
    """Share of each kind of furniture among those that a target lies on or in; empty for what is no target."""
    found = {ref: weight for (_, ref), weight in _weights(target).items() if ref in holders()}
    total = sum(found.values())
    return {ref: weight / total for ref, weight in found.items()}
