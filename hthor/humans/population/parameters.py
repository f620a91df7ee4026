"""Every parameter of a participant, in one record, and the range of each.

Each parameter has its unit and a short meaning next to it; fixed parameters have their source too. Prior, source and
identifiability of the free parameters are in `hthor.humans.population.parameter_registry`.
"""

import math

from msgspec import Struct
from msgspec.structs import fields

from hthor.errors import UnknownName

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
_SHARES = ("map_hidden", "w_prior", "spare", "dest_factor", "tour_forget", "p_fail", "p_slip", "p_ignore", "mu0")
NEUTRAL = ("map_hidden", "point_sd")
"""Parameters that change nothing at their defaults: a population that was made before them has the same people."""
_SIGNALS = ("s_offered", "s_failed")
_LOGITS = ("a0", "a_trust", "a_gain", "a_load", "a_again")


class Parameters(Struct, frozen=True, kw_only=True):
    """One participant's parameters, or a population's means; the defaults are typical values of the literature."""

    # walking
    v_pace: float = 0.60  # [m/s] stick speed under way
    stop_every: float = 4.0  # [s] mean walking time between two stops to look
    stop_s: float = 0.6  # [s] length of such a stop
    omega: float = 1.7  # [rad/s] speed of turning head and body
    k_map: float = 1.2  # [ratio] slowing while following a map
    k_read: float = 2.0  # [ratio] Slowing while reading a message. Our choice
    map_hidden: float = 0.0  # [share] of messages followed with the map hidden. Our choice: no data, so it stays shown
    point_sd: float = 0.66  # [rad] Error of a direction without the map. Source: 20 to 40 degrees off on average (m)

    # noticing: rate lam0 / (1 + (a50 / angle)^2) * exp(-(ecc / ecc_sd)^2 / 2) * share * exp(-clutter * beside)
    lam0: float = 0.9  # [1/s] rate of noticing a large object that stands alone right in front
    a50: float = 0.03  # [rad] visual angle at which that rate halves
    ecc_sd: float = 0.5  # [rad] Spread of attention around the head's direction. Our choice: 29 degrees, as eyes roam
    clutter: float = 0.1  # [log rate] lost for each small object close to it
    focus: float = 2.5  # [ratio] Rate of noticing at the place being searched, over the rate elsewhere. Our choice
    lam_furniture: float = 4.0  # [1/s] Rate of recognising furniture in view. Our choice
    d_furniture: float = 8.0  # [m] Distance at which that rate halves. Our choice

    # remembering
    tau_mem: float = 110.0  # [s] time constant of forgetting that a place was searched
    tau_seen: float = 300.0  # [s] time constant of forgetting where something out of view was seen

    # searching
    w_prior: float = 0.6  # [share] of common knowledge in where things are expected, the rest is uniform
    beta: float = 1.9  # [exponent] of Luce's choice: 0 chooses at random, a large value the best option
    kappa: float = 0.65  # [exponent] of time in what an option is worth; below 1, the cost of travel is under-weighed
    t_dwell: float = 1.9  # [s] looking at a place from close by
    e_done: float = 3.0  # [exposure] Amount that a search adds. Our choice: 95 % sure that the target is not there
    e_skip: float = 2.0  # [exposure] Amount above which a place needs no search any more. Our choice
    unseen: float = 0.7  # [pieces] Furniture of each kind expected behind unpassed doorways. Our choice
    spare: float = 0.1  # [share] Least belief that the object is behind unpassed doorways. Our choice
    dest_factor: float = 0.05  # [ratio] Belief in the target's destination, divided by that in other places. Our choice
    scan: float = 3.77  # [rad] Angle of the look round on entering a room. Our choice: 216 degrees
    scan_first: float = 4.4  # [rad] Angle of the look round at the start. Our choice: 0.7 turns
    t_on: float = 2.0  # [s] from the start of a trial to the first movement

    # several things to do
    tour_sd: float = 0.06  # [m] Error along each axis in remembering where on furniture a thing was. Our choice
    tour_forget: float = 0.08  # [chance] Probability of remembering only the furniture, not where on it. Our choice
    partner: float = 12.0  # [s] How long people hold on to a load that they cannot lift alone. Our choice
    lead: float = 3.0  # [s] How long people let the others walk first when carrying together. Our choice

    # handling
    t_manip: float = 2.5  # [s] one attempt to pick, place or open
    manip_sd: float = 0.35  # [log s] Standard deviation of one attempt's duration. Our choice
    p_fail: float = 0.15  # [chance] that an attempt misses

    # messages
    t_notice: float = 1.2  # [s] median time to notice a message
    t_read: float = 3.0  # [s] median time to read twelve words
    read_sd: float = 0.4  # [log s] Standard deviation of both times. Our choice
    a0: float = 2.0  # [logit] of accepting at trust .5, without the other terms
    a_trust: float = 3.0  # [logit] gained from trust 0 to 1
    a_gain: float = 0.4  # [logit] gained per ln(1 + seconds expected to be saved)
    a_load: float = 0.8  # [logit] lost with something in hand or about to be
    a_again: float = 0.5  # [logit] lost for each earlier refusal of the same offer
    p_slip: float = 0.02  # [chance] Pressing the wrong button. Source: 1 to 3 % in two-button choices (m)
    p_ignore: float = 0.25  # [share] Part of the unaccepted messages that are left without an answer. Our choice
    t_look: float = 3.0  # [s] How long people look at a place that a robot named before giving up. Our choice

    # trust: Beta(alpha, beta) with alpha += w_s * signal and beta += w_f * (1 - signal) after each trial
    mu0: float = 0.55  # [share] mean trust before the first trial
    n0: float = 5.0  # [counts] behind that mean
    w_s: float = 1.5  # [counts] that a full success adds
    w_f: float = 1.5  # [counts] that a full failure adds
    tau_s: float = 25.0  # [s] time constant of a message's worth: early help counts more
    s_offered: float = 0.4  # [signal] Worth of a trial with messages, none of them accepted. Our choice
    s_failed: float = 0.6  # [ratio] Factor of the signal in a failed trial. Source: outcome bias [22]; size ours
    sd_report: float = 0.7  # [points] Noise of a rating on the 1 to 7 scale. Source: .5 to .9 (m)

    # people and practice
    sigma: float = 0.25  # [ratio] standard deviation of the random effects between people, times each effect's size
    learn: float = 0.2  # [ratio] gain of speed by practice, from the first trial to the end
    n_learn: float = 3.0  # [trials] Number of trials that give 63 % of the practice. Our choice


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
    """The problem of a value in words, empty if it is valid."""
    low, high = parameter_range(name)
    if math.isfinite(value) and low <= value <= high:
        return ""
    return f"{value:g} is out of range; {name} lies from {low:g} to {high:g}"


def clamp(name: str, value: float) -> float:
    """The value itself, or the nearest value in the range."""
    low, high = parameter_range(name)
    return min(high, max(low, value))
