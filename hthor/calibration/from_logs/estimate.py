"""One parameter estimated from logs: value, error, amount of data, method."""

from msgspec import Struct

from hthor.calibration.from_logs.models.mixed_effects import Fit
from hthor.calibration.from_logs.models.priors import Belief, Scale, from_scale, to_scale

_Z90 = 1.6449
_LEAST_SHARE = 0.25
"""Share of the data in `NEEDS` below which an estimate is not used."""

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
"""Data that each estimate needs to be reliable: its error is then about 15 %, by experience."""


class Estimate(Struct, frozen=True, kw_only=True):
    """A parameter's value in its own unit; ``at`` and ``se`` are that value and its standard error on ``scale``.

    ``low`` and ``high`` bound a 90 % interval, ``n`` counts the data, ``needed`` is how many are wanted. ``words`` says
    how reliable it is. ``between`` is the standard deviation between people on the scale, with its relative standard
    error, None where no difference between people is modelled.
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
        """Whether there were enough data to use it instead of the prior belief."""
        return self.n >= _LEAST_SHARE * self.needed


def make_estimate(belief: Belief, at: float, se: float, n: int, method: str) -> Estimate:
    """An estimate of a parameter with a prior belief.

    Args:
        at: value on the belief's scale, clipped to the prior's bounds. se: its standard error there.
    """
    needed, what = NEEDS[belief.name]
    at = min(max(at, float(to_scale(belief.low, belief.scale))), float(to_scale(belief.high, belief.scale)))
    value, low, high = (
        min(max(float(from_scale(at + z * se, belief.scale)), belief.low), belief.high) for z in (0.0, -_Z90, _Z90)
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


def estimate_from_fit(belief: Belief, fit: Fit, n: int, method: str) -> Estimate:
    """An estimate from a fitted model's term of the parameter's name."""
    return make_estimate(belief, fit.value[belief.name], fit.se[belief.name], n, method)


def _words(n: int, needed: int, what: str, se: float, prior_sd: float) -> str:
    if n < _LEAST_SHARE * needed:
        return f"too few data: {n} {what}, {needed} are wanted; left as it was"
    if n < needed:
        return f"few data: {n} of {needed} {what}"
    return "little learnt" if se > 0.8 * prior_sd else "estimated"
