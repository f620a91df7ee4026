"""How people's trust changed, from their ratings: a hierarchical Beta model (Guo and Yang 2021).

Trust is Beta(alpha, beta); each trial adds counts for the worth of the robots in it, and the rating is the mean on
the scale of 1 to 7 with some noise. The first mean differs from person to person. Which messages are accepted at that
trust is a logistic regression with an intercept for each person.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.calibration.from_logs.features.messages import Offer
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit
from hthor.calibration.from_logs.models.priors import Belief, fit_ability
from hthor.humans.population.parameters import Parameters

TERMS = ("mu0", "n0", "w_s", "w_f", "tau_s")
_LEAST = 1e-12
ACCEPTANCE_TERMS = ("a0", "a_trust", "a_gain", "a_load", "a_again")


class Experience(Struct, frozen=True, kw_only=True):
    """What the robots did in one trial, and the rating after it.

    ``offered``: whether any message was shown; ``helped`` [s]: when the first useful message was accepted, or NaN;
    ``misled``: number of accepted messages that were of no help; ``met``: whether the goal was met; ``rating``: 1 to 7,
    0 without a rating.
    """

    offered: bool
    helped: float
    misled: int
    met: bool
    rating: int


class TrustData(Struct, frozen=True, kw_only=True):
    """The experiences of every session, (S, T) arrays; ``there`` marks the trials that are in the log."""

    offered: Array
    helped: Array
    misled: Array
    met: Array
    rating: Array
    there: Array
    person: Array


def make_trust_data(sessions: Sequence[Sequence[Experience]], person: Array) -> TrustData:
    """Sessions as arrays; ``person`` (S,) int is the person of each session."""
    shape = (len(sessions), max(map(len, sessions)))
    arrays = {name: np.zeros(shape) for name in ("offered", "helped", "misled", "met", "rating", "there")}
    for row, session in enumerate(sessions):
        for column, one in enumerate(session):
            for name in ("offered", "helped", "misled", "met", "rating"):
                arrays[name][row, column] = getattr(one, name)
            arrays["there"][row, column] = 1.0
    return TrustData(person=person, **arrays)


def repeat_session(data: TrustData, times: int) -> TrustData:
    """The first session so many times, as if people with other trust at first had had the same experiences."""
    names = ("offered", "helped", "misled", "met", "rating", "there")
    arrays = {name: np.repeat(getattr(data, name)[:1], times, axis=0) for name in names}
    return TrustData(person=np.arange(times), **arrays)


def mean_trust(data: TrustData, values: Mapping[str, float], effects: Array) -> tuple[Array, Array]:
    """Mean trust (S, T) at the beginning of each trial, and after it; ``effects`` (S,) are added to mu0's logit."""
    fixed, n0 = Parameters(), math.exp(values["n0"])
    w_s, w_f, tau = (math.exp(values[name]) for name in ("w_s", "w_f", "tau_s"))
    first = 1.0 / (1.0 + np.exp(-(values["mu0"] + effects)))
    alpha, beta = first * n0, (1.0 - first) * n0
    before, after = np.zeros(data.rating.shape), np.zeros(data.rating.shape)
    signal = _signals(data, tau, fixed)
    for column in range(data.rating.shape[1]):
        before[:, column] = alpha / (alpha + beta)
        beta = beta + w_f * data.misled[:, column]
        value, there = signal[:, column], data.there[:, column]
        alpha, beta = alpha + there * w_s * value, beta + there * w_f * (1.0 - value)
        after[:, column] = alpha / (alpha + beta)
    return before, after


def fit_trust(data: TrustData, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit initial trust, its weight and the terms of its change, with the spread of initial trust between people."""
    from scipy.special import ndtr

    rows, columns = np.nonzero(data.rating > 0.0)
    rated, noise = data.rating[rows, columns], Parameters().sd_report
    person = np.unique(data.person, return_inverse=True)[1]
    owner = person[rows]
    first = np.full(int(person.max()) + 1, 0)
    first[owner[::-1]] = np.arange(len(owner))[::-1]
    span = rules.TRUST_MAX - rules.TRUST_MIN

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        own = effects[first][person] if len(effects) else np.zeros(len(person))
        _, after = mean_trust(data, values, own)
        mean = rules.TRUST_MIN + span * after[rows, columns]
        low = np.where(rated <= rules.TRUST_MIN, -np.inf, (rated - 0.5 - mean) / noise)
        high = np.where(rated >= rules.TRUST_MAX, np.inf, (rated + 0.5 - mean) / noise)
        return np.log(np.maximum(ndtr(high) - ndtr(low), _LEAST))

    return fit_ability(likelihood, TERMS, owner, beliefs)


def _signals(data: TrustData, tau: float, fixed: Parameters) -> Array:
    """Worth of the robots (S, T) by the law of `hthor.humans.communication.trust`."""
    helped = data.helped > 0.0
    value = np.where(data.offered > 0.0, fixed.s_offered, 0.0)
    value = np.where(data.misled > 0.0, 0.0, value)
    value = np.where(helped, 0.5 + 0.5 * np.exp(-data.helped / tau), value)
    return np.where(data.met > 0.0, value, value * fixed.s_failed)


def fit_acceptance(offers: Sequence[Offer], trust: Array, person: Array, beliefs: Mapping[str, Belief]) -> Fit:
    """Fit the logit of acceptance to N offers, read by each ``person`` (N,) at mean ``trust`` (N,), 0 to 1.

    People sometimes press the wrong button (``p_slip``), so neither answer is ever certain.
    """
    gain, load, again = (np.array([getattr(one, name) for one in offers]) for name in ("gain", "load", "again"))
    accepted, slip = np.array([one.accepted for one in offers]), Parameters().p_slip

    def likelihood(values: dict[str, float], effects: Array) -> Array:
        logit = values["a0"] + effects + values["a_trust"] * (trust - 0.5) + values["a_gain"] * np.log1p(gain)
        logit = logit - values["a_load"] * load - values["a_again"] * again
        share = slip + (1.0 - 2.0 * slip) / (1.0 + np.exp(-logit))
        return np.log(np.where(accepted, share, 1.0 - share))

    return fit_ability(likelihood, ACCEPTANCE_TERMS, person, beliefs)
