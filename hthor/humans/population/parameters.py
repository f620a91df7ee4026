"""Every number of the proxy's behaviour, in one record.

What each of them is, its prior, its source and what could identify it stands in
`hthor.humans.population.parameter_registry`.
"""

from __future__ import annotations

from msgspec import Struct


class Parameters(Struct, frozen=True, kw_only=True):
    """One person's numbers, or the means of a population; the defaults are typical values of the literature."""

    # walking
    v_pace: float = 0.60  # m/s, stick speed under way
    stop_every: float = 4.0  # s under way from one stop to look to the next, on average
    stop_s: float = 0.6  # s, length of such a stop
    omega: float = 1.7  # rad/s, speed of turning the head and body
    k_map: float = 1.2  # how much slower people walk after a map
    k_read: float = 2.0  # how much slower people walk while they read a message

    # seeing: a rate of noticing lam0 / (1 + (a50 / angle)^2) * exp(-(ecc / ecc_sd)^2 / 2) * share * exp(-clutter * n)
    lam0: float = 0.9  # 1/s, rate of noticing a large target right in front that stands alone
    a50: float = 0.03  # rad, visual angle at which that rate halves
    ecc_sd: float = 0.5  # rad, how far from the head's direction attention spreads
    clutter: float = 0.1  # how much each small thing close beside the target takes off the logarithm of the rate
    focus: float = 2.5  # times that rate on the receptacle that is being searched
    lam_furniture: float = 4.0  # 1/s, rate of recognising furniture in view
    d_furniture: float = 8.0  # m, distance at which that rate halves

    # remembering
    tau_mem: float = 110.0  # s, time constant of forgetting that a place was searched
    tau_seen: float = 300.0  # s, time constant of forgetting where something was seen that is out of view

    # searching
    w_prior: float = 0.6  # share of common knowledge in where people expect things, the rest is uniform
    beta: float = 1.9  # Luce choice exponent: 0 is random, large always the best
    kappa: float = 0.65  # exponent of time in the value p / t^kappa: below 1, people under-weigh the cost of travel
    t_dwell: float = 1.9  # s, looking at a receptacle from close by
    e_done: float = 3.0  # exposure that a search of a receptacle adds: 95 % sure that it is not there
    e_skip: float = 2.0  # exposure at which a receptacle is passed by on the way to it
    unseen: float = 0.7  # receptacles of a kind that people expect behind unopened doors
    spare: float = 0.1  # least share of the belief that lies behind unpassed doors
    dest_factor: float = 0.05  # how likely the target is where it shall go, relative to elsewhere
    scan: float = 3.77  # rad, how far people turn to look round on entering a room: 216 degrees
    scan_first: float = 4.4  # rad, and at the start: 0.7 turns
    t_on: float = 2.0  # s, from the start of a trial to the first movement

    # several things to do
    tour_sd: float = 0.06  # m, along each axis, how far off people remember where on a piece of furniture a thing was
    tour_forget: float = 0.08  # chance of remembering only the piece of furniture, not where on it
    partner: float = 12.0  # s, how long people hold on to what they cannot lift alone before they let go
    lead: float = 3.0  # s, how long people who help to carry leave it to the others to go first

    # handling
    t_manip: float = 2.5  # s, one attempt to pick, place or open
    manip_sd: float = 0.35  # sd of the logarithm of one attempt's duration
    p_fail: float = 0.15  # chance that an attempt misses

    # messages
    t_notice: float = 1.2  # s, median of noticing that a message has come
    t_read: float = 3.0  # s, median of reading a message of twelve words
    read_sd: float = 0.4  # sd of the logarithm of both
    a0: float = 2.0  # logit of confirming at trust .5, when nothing else speaks for or against it
    a_trust: float = 3.0  # change of that logit from trust 0 to 1
    a_gain: float = 0.4  # change of that logit per ln(1 + seconds that following is expected to save)
    a_load: float = 0.8  # how much of that logit work in hand takes off: carrying something, reaching for something
    a_again: float = 0.5  # how much of that logit each earlier refusal of the same offer takes off
    p_slip: float = 0.02  # chance of pressing the other button
    p_ignore: float = 0.25  # share of the messages not confirmed that are left without an answer
    t_look: float = 3.0  # s, looking at the place that a robot named before giving it up

    # trust: Beta(alpha, beta) with alpha += w_s * signal and beta += w_f * (1 - signal) after each trial
    mu0: float = 0.55  # mean trust before the first trial
    n0: float = 5.0  # counts behind it
    w_s: float = 1.5  # counts of a full success
    w_f: float = 1.5  # counts of a full failure
    tau_s: float = 25.0  # s, time constant of a message's worth: early help counts more
    s_offered: float = 0.4  # signal of a trial with messages of which none was confirmed
    s_failed: float = 0.6  # times the signal when the trial failed: outcome bias
    sd_report: float = 0.7  # sd of a report on the 1 to 7 scale

    # people and practice
    sigma: float = 0.25  # sd of the random effects between people, see `hthor.humans.population.parameter_registry`
    learn: float = 0.2  # how much faster people are at last than in their first trial
    n_learn: float = 3.0  # trials in which 63 % of that is gained
