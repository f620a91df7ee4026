"""The belief about each parameter before logs are used, normal on a suitable scale, and fits that start from it."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Array, Fit, Likelihood, Term, fit_mixed_model
from hthor.humans.population.distributions import Beta, LogNormal, LogUniform
from hthor.humans.population.parameter_registry import PARAMETERS, Parameter, parameter
from hthor.humans.population.parameters import Parameters

Scale = Literal["log", "logit", "plain"]
_SHARES = (0.1587, 0.5, 0.8413)
_EDGES = (0.0005, 0.9995)
_LEAST = 1e-6
_SPREAD_SD = 1.5
SPREAD = "spread"
"""Name of the term for the spread between people."""


class Belief(Struct, frozen=True, kw_only=True):
    """A parameter on its scale: normal around ``mean`` with ``sd``; ``low`` and ``high`` bound it in its own unit."""

    name: str
    unit: str
    scale: Scale
    mean: float
    sd: float
    low: float
    high: float

    @property
    def middle(self) -> float:
        """The median in the parameter's own unit."""
        return float(from_scale(self.mean, self.scale))

    def term(self) -> Term:
        """The parameter as a term of a model, with this belief as its prior."""
        return Term(name=self.name, start=self.mean, mean=self.mean, sd=self.sd)


Beliefs = Mapping[str, Belief]


def to_scale(value: Any, scale: Scale) -> Any:
    """A value, or an array of values, on a scale."""
    if scale == "log":
        return np.log(np.maximum(value, _LEAST))
    if scale == "logit":
        share = np.clip(value, 1e-4, 1.0 - 1e-4)
        return np.log(share / (1.0 - share))
    return value


def from_scale(value: Any, scale: Scale) -> Any:
    """The inverse of `to_scale`."""
    if scale == "log":
        return np.exp(value) if isinstance(value, np.ndarray) else math.exp(value)
    return 1.0 / (1.0 + np.exp(-value)) if scale == "logit" else value


def spread_term(effect: float) -> Term:
    """The logarithm of the standard deviation between people, with a wide prior around its default."""
    centre = math.log(Parameters().sigma * effect)
    return Term(name=SPREAD, start=centre, mean=centre, sd=_SPREAD_SD)


def fit_ability(likelihood: Likelihood, names: Sequence[str], person: Array, beliefs: Beliefs, *more: Term) -> Fit:
    """Fit the parameters of these names, ``more`` terms, and the spread of the first parameter between people."""
    terms = [*(beliefs[name].term() for name in names), *more]
    return fit_mixed_model(likelihood, terms, person, spread_term(parameter(names[0]).effect))


def scale_of(parameter: Parameter) -> Scale:
    """The scale on which a parameter's errors are most nearly symmetric."""
    if isinstance(parameter.prior, LogUniform | LogNormal):
        return "log"
    return "logit" if isinstance(parameter.prior, Beta) else "plain"


def prior_beliefs() -> dict[str, Belief]:
    """The beliefs from the registry's priors."""
    return {
        p.name: _belief(p, [p.prior.quantile(share) for share in _SHARES]) for p in PARAMETERS if p.prior is not None
    }


def population_beliefs(names: Sequence[str], draws: Any, weights: Any) -> dict[str, Belief]:
    """The beliefs from a population: ``draws`` (D, P) in the parameters' units, ``weights`` (D,)."""
    draws_of = dict(zip(names, np.asarray(draws).T, strict=True))
    return {
        p.name: _belief(p, [_quantile(draws_of[p.name], weights, share) for share in _SHARES])
        for p in PARAMETERS
        if p.name in draws_of
    }


def _belief(parameter: Parameter, quantiles: Sequence[float]) -> Belief:
    kind, prior = scale_of(parameter), parameter.prior
    assert prior is not None
    low, middle, high = (float(to_scale(value, kind)) for value in quantiles)
    return Belief(
        name=parameter.name,
        unit=parameter.unit,
        scale=kind,
        mean=middle,
        sd=max(0.5 * (high - low), 1e-3),
        low=prior.quantile(_EDGES[0]),
        high=prior.quantile(_EDGES[1]),
    )


def _quantile(values: Any, weights: Any, share: float) -> float:
    order = np.argsort(values, kind="stable")
    total = np.cumsum(np.asarray(weights)[order])
    return float(np.asarray(values)[order][min(np.searchsorted(total, share * total[-1]), len(values) - 1)])
