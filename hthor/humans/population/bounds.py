"""The range of each parameter."""

import math

from msgspec.structs import fields

from hthor.errors import UnknownName
from hthor.humans.population.parameters import Parameters

_LEAST = 1e-6
"""[unit] Least value of a parameter that must be above zero, in its own unit. Our choice."""
_MOST = 1e6
"""[unit] Greatest value of a parameter, in its own unit. Our choice."""
_MOST_LOGIT = 50.0
"""[logit] Greatest size of a logit. Our choice."""
_POSITIVE = (
    *("v_pace", "stop_every", "omega", "k_map", "k_read", "lam0", "a50", "ecc_sd", "focus", "lam_furniture"),
    *("d_furniture", "tau_mem", "tau_seen", "t_dwell", "t_manip", "t_notice", "t_read", "n0", "tau_s", "n_learn"),
)
"""Parameters that are divided by, or changed on their logarithm."""
_SHARES = ("w_prior", "spare", "dest_factor", "tour_forget", "p_fail", "p_slip", "p_ignore", "mu0")
_SIGNALS = ("s_offered", "s_failed")
_LOGITS = ("a0", "a_trust", "a_gain", "a_load", "a_again")


def parameter_range(name: str) -> tuple[float, float]:
    """The least and the greatest value of a parameter, in its unit.

    Raises:
        UnknownName: when there is no such parameter.
    """
    if name not in parameter_names():
        raise UnknownName("parameter", name, parameter_names())
    if name in _SHARES or name in _SIGNALS:
        return 0.0, 1.0
    if name in _LOGITS:
        return -_MOST_LOGIT, _MOST_LOGIT
    return (_LEAST if name in _POSITIVE else 0.0), _MOST


def parameter_names() -> tuple[str, ...]:
    """Names of all parameters, free and fixed, in the order of `Parameters`."""
    return tuple(field.name for field in fields(Parameters))


def range_problem(name: str, value: float) -> str:
    """What is wrong with a value, empty if nothing is."""
    low, high = parameter_range(name)
    if math.isfinite(value) and low <= value <= high:
        return ""
    return f"{value:g} is out of range; {name} lies from {low:g} to {high:g}"


def clamp(name: str, value: float) -> float:
    """The value itself, or the nearest in the range."""
    low, high = parameter_range(name)
    return min(high, max(low, value))
