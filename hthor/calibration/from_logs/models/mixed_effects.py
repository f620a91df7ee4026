"""Models with one random effect per person, fitted by Laplace's approximation.

The effects are integrated out around their modes, one Newton search for all people at once; the other parameters
are found by a quasi-Newton search, with priors as penalties, and their errors come from the curvature there.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from msgspec import Struct

Array = Any
"""A numpy array of float64."""

_STEPS, _H, _REACH = 12, 1e-3, 1.5
_EDGE = 1e-3
_SEARCH = {"maxiter": 200, "eps": 1e-4, "ftol": 1e-9, "gtol": 1e-4}
_FAR = 5.0
"""Greatest distance of a parameter from its prior mean in the search, in standard deviations."""


class Term(Struct, frozen=True, kw_only=True):
    """One parameter of a model: the start of its search, and a normal prior."""

    name: str
    start: float
    mean: float = 0.0
    sd: float = 1.0


class Fit(Struct, frozen=True, kw_only=True):
    """A fitted model: value and standard error of each term, their covariance, and the mode of each effect."""

    value: dict[str, float]
    se: dict[str, float]
    covariance: Array
    effects: Array


Likelihood = Callable[[dict[str, float], Array], Array]
"""Takes the terms' values and the effect of each datum's person; returns each datum's log likelihood."""


def fit_mixed_model(likelihood: Likelihood, terms: Sequence[Term], person: Array, spread: Term | None) -> Fit:
    """Fit ``terms`` and an effect for each person; ``person`` (N,) is the person of each datum, from 0.

    ``spread`` is the logarithm of the effects' standard deviation, None for a model without effects.
    """
    from scipy.optimize import minimize

    count = int(person.max()) + 1 if len(person) else 0
    free = [*terms, spread] if spread is not None else list(terms)
    modes = np.zeros(count)

    def loss(point: Array) -> float:
        values = {term.name: float(at) for term, at in zip(free, point, strict=True)}
        penalty = sum(0.5 * ((at - t.mean) / t.sd) ** 2 for t, at in zip(free, point, strict=True))
        if spread is None:
            return float(penalty - likelihood(values, np.zeros(len(person))).sum())
        sd = math.exp(values[spread.name])
        marginal = _marginal(likelihood, values, person, sd, modes)
        return float(penalty - marginal)

    start = np.array([term.start for term in free])
    with np.errstate(all="ignore"):
        bounds = [(term.mean - _FAR * term.sd, term.mean + _FAR * term.sd) for term in free]
        found = minimize(loss, start, method="L-BFGS-B", bounds=bounds, options=_SEARCH)
        covariance = _inverse(_curvature(loss, found.x))
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    names = [term.name for term in free]
    return Fit(
        value=dict(zip(names, map(float, found.x), strict=True)),
        se=dict(zip(names, map(float, errors), strict=True)),
        covariance=covariance,
        effects=modes.copy(),
    )


def _marginal(likelihood: Likelihood, values: dict[str, float], person: Array, sd: float, modes: Array) -> float:
    """Logarithm of the likelihood with the effects integrated out; leaves their modes in ``modes``."""
    count = len(modes)

    def summed(effects: Array) -> Array:
        data = np.bincount(person, likelihood(values, effects[person]), count)
        return data - 0.5 * (effects / sd) ** 2

    effects, h = np.clip(modes, -4.0 * sd, 4.0 * sd), _H * max(sd, 0.05)
    here, curve = summed(effects), np.full(count, -1.0 / sd**2)
    for _ in range(_STEPS):
        up, down = summed(effects + h), summed(effects - h)
        slope, curve = (up - down) / (2.0 * h), np.minimum((up - 2.0 * here + down) / h**2, -0.1 / sd**2)
        step = np.clip(-slope / curve, -_REACH * sd, _REACH * sd)
        there = summed(effects + step)
        for _ in range(6):  # go back in the people whose step went too far
            worse = there < here - 1e-12
            if not worse.any():
                break
            step = np.where(worse, 0.3 * step, step)
            there = summed(effects + step)
        better = there >= here
        effects, here = np.where(better, effects + step, effects), np.where(better, there, here)
        if float(np.abs(step).max(initial=0.0)) < 1e-5:
            break
    modes[:] = effects
    return float((here - math.log(sd) - 0.5 * np.log(-curve)).sum())


def _curvature(loss: Callable[[Array], float], at: Array) -> Array:
    """Second derivatives of the loss, by central differences."""
    size = len(at)
    h = _EDGE * np.maximum(1.0, np.abs(at)) * 10.0
    middle, matrix = loss(at), np.zeros((size, size))
    unit = np.eye(size)
    for i in range(size):
        a = unit[i] * h[i]
        matrix[i, i] = (loss(at + a) - 2.0 * middle + loss(at - a)) / h[i] ** 2
        for j in range(i):
            b = unit[j] * h[j]
            cross = loss(at + a + b) - loss(at + a - b) - loss(at - a + b) + loss(at - a - b)
            matrix[i, j] = matrix[j, i] = cross / (4.0 * h[i] * h[j])
    return matrix


def _inverse(matrix: Array) -> Array:
    """The inverse of a matrix made positive definite: directions not determined by the data get a large error."""
    values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
    return (vectors / np.maximum(values, 1e-4)) @ vectors.T
