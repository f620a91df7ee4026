"""Where a participant expects an object: common knowledge mixed with ignorance.

Common knowledge means the scene priors of `hthor.catalog.priors`; ignorance means equal belief in every kind of
furniture. People weigh the two, and new evidence against both ("Why are the batteries in the microwave?", Cognitive
Research 2021): a place searched in vain loses belief by its exposure, see `hthor.humans.search.option_choice`.
"""

from functools import cache

from hthor import catalog
from hthor.catalog import priors


@cache
def receptacle_kinds() -> tuple[str, ...]:
    """Kinds of furniture that things are put on or in, in the catalogue's order; without crockery."""
    return tuple(name for name in catalog.names() if catalog.kind(name).rests() and not catalog.kind(name).pickable)


@cache
def prior_shares(target: str) -> dict[str, float]:
    """Common knowledge: the probability of each of `receptacle_kinds`; adds up to 1, uniform for an unknown target.

    A target *near* another object is expected where that object is expected, and a target near furniture at that
    furniture; other references are left out.
    """
    mass = dict.fromkeys(receptacle_kinds(), 0.0)
    for (relation, reference), weight in _weights(target).items():
        if reference in mass:
            mass[reference] += weight
        elif relation == "near":
            for kind, share in _direct(reference).items():
                mass[kind] += weight * share
    total = sum(mass.values())
    return {kind: share / total if total > 0.0 else 1.0 / len(mass) for kind, share in mass.items()}


def location_belief(target: str, w_prior: float) -> dict[str, float]:
    """Belief in each kind of furniture: ``w_prior`` of `prior_shares`, the rest uniform; adds up to 1."""
    known = prior_shares(target)
    return {kind: w_prior * share + (1.0 - w_prior) / len(known) for kind, share in known.items()}


def _weights(target: str) -> dict[tuple[str, str], float]:
    return priors.weights(target) if target in catalog.TARGETS else {}


def _direct(target: str) -> dict[str, float]:
    """Shares of the furniture that a target lies on or in; empty for an object that is not a target."""
    weights = {ref: weight for (_, ref), weight in _weights(target).items() if ref in receptacle_kinds()}
    total = sum(weights.values())
    return {ref: weight / total for ref, weight in weights.items()}
