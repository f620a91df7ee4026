"""Every number of the proxy's behaviour, in one record; knows nothing of how they are used.

Sources in brackets: [fit] posterior medians of a prototype of this model on the published results; [lit] a value or a
range from the literature; [own] our choice, not identified by any data.
"""

from __future__ import annotations

from msgspec import Struct


class Parameters(Struct, frozen=True, kw_only=True):
    """A population's means. Those marked * differ between people by `sigma`, see `hthor.humans.person`."""

    # walking
    v_pace: float = 0.40  # m/s *, mean speed under way: stick speed times duty cycle [own: of .45 and .40 the one whose
    # success without a robot on the suite "smoke" came nearer the published one; fit: .29 to .64]
    omega: float = 1.7  # rad/s, mean speed of turning the head and body [fit]
    k_map: float = (
        1.0  # how much slower people walk after a map; dead ends come on top [own, set with v_pace; lit: 1 to 2]
    )
    k_read: float = 2.0  # how much slower people walk while they read a message [own]

    # seeing: a rate of noticing lam0 / (1 + (d/d50)^2) * exp(-(ecc/ecc_sd)^2 / 2)
    lam0: float = 0.9  # 1/s *, rate of noticing the target right in front [fit]
    d50: float = 3.3  # m, distance at which that rate halves: a 10 cm object of 1.7 degrees [fit]
    ecc_sd: float = 0.5  # rad, how far from the head's direction attention spreads [lit: eyes roam within +-29 degrees]
    focus: float = 2.5  # times that rate on the receptacle that is being searched [own: finds .97 in t_dwell]
    lam_furniture: float = 4.0  # 1/s, rate of recognising furniture in view [own]
    d_furniture: float = 8.0  # m, distance at which that rate halves [own]

    # searching
    w_prior: float = 0.6  # share of common knowledge in where people expect things, the rest is uniform [fit]
    beta: float = 1.9  # *, Luce choice exponent: 0 is random, large always the best [fit]
    kappa: float = 0.8  # exponent of time in the value p / t^kappa: people under-weigh cost [lit: 0.3 to 1]
    t_dwell: float = 1.9  # s *, looking at a receptacle from close by [fit]
    tau_mem: float = 110.0  # s, time constant of forgetting that a place was searched [fit]
    e_done: float = 3.0  # exposure that a search of a receptacle adds: 95 % sure that it is not there [own]
    e_skip: float = 2.0  # exposure at which a receptacle is passed by on the way to it [own]
    unseen: float = 0.7  # receptacles of a kind that people expect behind unopened doors [own]
    spare: float = 0.1  # least share of the belief that lies behind unpassed doors [own]
    dest_factor: float = 0.05  # how likely the target is where it shall go, relative to elsewhere [own]
    scan: float = 3.77  # rad, how far people turn to look round on entering a room: 216 degrees [own]
    scan_first: float = 4.4  # rad, and at the start: 0.7 turns [own]
    t_on: float = 2.0  # s, from the start of a trial to the first movement [fit]

    # several things to do
    tour_sd: float = 0.06  # m, along each axis, how far off people remember where on a piece of furniture a thing was
    # when they had toured the house just before [own]
    tour_forget: float = 0.08  # chance of remembering only the piece of furniture, not where on it [own]
    partner: float = 12.0  # s, how long people hold on to what they cannot lift alone before they let go [own]
    lead: float = 3.0  # s, how long people who help to carry leave it to the others to go first [own]

    # handling
    t_manip: float = 2.5  # s *, one attempt to pick, place or open [fit]
    manip_sd: float = 0.35  # sd of the logarithm of one attempt's duration [own]
    p_fail: float = 0.15  # chance that an attempt misses [lit: .05 to .2]

    # messages
    t_read: float = 3.5  # s, median of noticing and reading a message [lit: 12 words at 238 a minute, 1 to 2 s before]
    read_sd: float = 0.4  # sd of its logarithm [lit]
    a0: float = 2.0  # *, logit of confirming at trust .5 [fit]
    a_trust: float = 3.0  # change of that logit from trust 0 to 1 [fit, hardly identified]
    p_slip: float = 0.02  # chance of pressing the other button [lit]
    p_ignore: float = 0.25  # share of the messages not confirmed that are left without an answer [own]
    t_look: float = 3.0  # s, looking at the place that a robot named before giving it up [own]

    # trust: Beta(alpha, beta) with alpha += w_s * signal and beta += w_f * (1 - signal) after each trial
    mu0: float = 0.55  # *, mean trust before the first trial [fit]
    n0: float = 5.0  # counts behind it [fit]
    w_s: float = 1.5  # counts of a full success [fit]
    w_f: float = 1.5  # counts of a full failure [fit]
    tau_s: float = 25.0  # s, time constant of a message's worth: early help counts more [fit]
    s_offered: float = 0.4  # signal of a trial with messages of which none was confirmed [own]
    s_failed: float = 0.6  # times the signal when the trial failed [own; lit: outcome bias]
    sd_report: float = 0.7  # sd of a report on the 1 to 7 scale [own]

    # people and practice
    sigma: float = 0.25  # sd of the random effects between people [fit, hardly identified]
    learn: float = 0.2  # how much faster people are at last than in their first trial [fit]
    n_learn: float = 3.0  # trials in which 63 % of that is gained [own]
