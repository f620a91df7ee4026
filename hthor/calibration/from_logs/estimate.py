"""One parameter as logs tell it: value, error, how much data, by which method."""

from __future__ import annotations

from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Fit
from hthor.calibration.from_logs.models.priors import Belief, Scale, off, on

_Z90 = 1.6449
_LEAST_SHARE = 0.25
"""Of the data that an estimate needs to be trusted: with less than this it is not used."""

NEEDS: dict[str, tuple[int, str]] = {
    "v_pace": (12, "trials with a walk"),
    "learn": (60, "trials with a walk"),
    "omega": (36, "turns"),
    "t_on": (12, "trials"),
    "stop_every": (40, "stops"),
    "stop_s": (40, "stops"),
    "k_map": (20, "guided walks"),
    "t_manip": (30, "attempts"),
    "p_fail": (30, "attempts"),
    "t_notice": (15, "messages"),
    "t_read": (15, "messages"),
    "reading": (15, "messages"),
    "a0": (100, "messages"),
    "a_trust": (100, "messages"),
    "a_gain": (100, "messages"),
    "a_load": (100, "messages"),
    "a_again": (100, "messages"),
    "beta": (300, "choices"),
    "kappa": (300, "choices"),
    "w_prior": (300, "choices"),
    "lam0": (60, "exposures"),
    "a50": (60, "exposures"),
    "clutter": (60, "exposures"),
    "mu0": (100, "ratings"),
    "n0": (100, "ratings"),
    "w_s": (100, "ratings"),
    "w_f": (100, "ratings"),
    "tau_s": (100, "ratings"),
    "sigma": (12, "people"),
}
"""How much of what each estimate needs before it may be relied on: about 15 % of error, by experience."""


class Estimate(Struct, frozen=True, kw_only=True):
    """A parameter's value in its own unit; ``at`` and ``se`` are that value and its standard error on ``scale``.

    ``low`` and ``high`` bound 90 % of it, ``n`` counts the data, ``needed`` of them are wanted. ``words`` says in words
    how far it can be relied on. ``between`` is the standard deviation between people on the scale, with its standard
    error relative to it, None where everybody is taken to be alike.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    scale: Scale
    at: float
    se: float
    n: int
    needed: int
    method: str
    words: str
    between: tuple[float, float] | None = None

    @property
    def used(self) -> bool:
        """Whether there were data enough to believe it rather than what was believed before."""
        return self.n >= _LEAST_SHARE * self.needed


def of(belief: Belief, at: float, se: float, n: int, method: str) -> Estimate:
    """An estimate of a parameter of which something was believed.

    Args:
        at: value on the belief's scale, brought back to the prior's bounds when it is beyond them. se: its standard
            error there.
    """
    needed, what = NEEDS[belief.name]
    at = min(max(at, float(on(belief.low, belief.scale))), float(on(belief.high, belief.scale)))
    value, low, high = (
        min(max(float(off(at + z * se, belief.scale)), belief.low), belief.high) for z in (0.0, -_Z90, _Z90)
    )
    return Estimate(
        name=belief.name,
        unit=belief.unit,
        value=value,
        low=low,
        high=high,
        scale=belief.scale,
        at=at,
        se=se,
        n=n,
        needed=needed,
        method=method,
        words=_words(n, needed, what, se, belief.sd),
    )


def of_fit(belief: Belief, fit: Fit, n: int, method: str) -> Estimate:
    """The same, of the model's term of that name."""
    return of(belief, fit.value[belief.name], fit.se[belief.name], n, method)


def _words(n: int, needed: int, what: str, se: float, prior_sd: float) -> str:
    if n < _LEAST_SHARE * needed:
        return f"too few data: {n} {what}, {needed} are wanted; left as it was"
    if n < needed:
        return f"few data: {n} of {needed} {what}"
    return "little learnt" if se > 0.8 * prior_sd else "estimated"
