"""The numbers of a person in plain words, for the person and for the experimenter, and why some are not known."""

from __future__ import annotations

from msgspec import Struct

from hthor.calibration.from_logs.estimate_all import HIDDEN, READING


class Wording(Struct, frozen=True, kw_only=True):
    """How a number is called for people who do not know the model.

    Attributes:
        title: what it is. unknown: why no session of this length tells it; empty if one can.
        percent: whether it is shown as a percentage.
    """

    title: str
    unknown: str = ""
    percent: bool = False


_HIDDEN_MIND = "it is about what is in mind, which a log of what was done does not show"
_EYES = "it takes to know what was looked at, and a page does not follow the eyes"
_LONGER = "it takes many more trials than one session has"
_PAUSES = "one session has too few stops to tell them from other pauses"
_OF_MANY = "it is about how people differ from each other, so one person has none"

PARAMETERS: dict[str, Wording] = {
    "v_pace": Wording(title="walking speed"),
    "omega": Wording(title="speed of turning"),
    "t_on": Wording(title="time until the first move"),
    "k_map": Wording(title="slowing while following a map"),
    "t_manip": Wording(title="time of the hands for one thing"),
    "p_fail": Wording(title="misses of the hands", percent=True),
    READING: Wording(title="time from a message of twelve words to the answer"),
    "t_notice": Wording(title="of that, until it is noticed"),
    "t_read": Wording(title="of that, to read and decide"),
    "a0": Wording(title="willingness to accept a message"),
    "mu0": Wording(title="trust in the robot at first, 0 to 1"),
    "stop_every": Wording(title="time under way between short stops", unknown=_PAUSES),
    "stop_s": Wording(title="length of a short stop", unknown=_PAUSES),
    "lam0": Wording(title="rate of noticing things", unknown=_EYES),
    "a50": Wording(title="visual angle of things that are noticed half as fast", unknown=_EYES),
    "clutter": Wording(title="slowing of noticing by things close by", unknown=_EYES),
    "t_dwell": Wording(title="looking at a place from close by", unknown=_EYES),
    "tau_mem": Wording(title="forgetting that a place was searched", unknown=_HIDDEN_MIND),
    "tau_seen": Wording(title="forgetting where something was seen", unknown=_HIDDEN_MIND),
    "w_prior": Wording(title="share of common knowledge in expectations", unknown=_HIDDEN_MIND),
    "beta": Wording(title="how strictly the best place is searched next", unknown=_HIDDEN_MIND),
    "kappa": Wording(title="weight of time when choosing where to search", unknown=_HIDDEN_MIND),
    "a_trust": Wording(title="effect of trust on accepting", unknown=_LONGER),
    "a_gain": Wording(title="effect of the time to be saved on accepting", unknown=_LONGER),
    "a_load": Wording(title="effect of work in hand on accepting", unknown=_LONGER),
    "a_again": Wording(title="effect of earlier refusals on accepting", unknown=_LONGER),
    "n0": Wording(title="firmness of trust at first", unknown=_LONGER),
    "w_s": Wording(title="what a success adds to trust", unknown=_LONGER),
    "w_f": Wording(title="what a failure takes from trust", unknown=_LONGER),
    "tau_s": Wording(title="how fast the worth of help fades", unknown=_LONGER),
    "learn": Wording(title="gain by practice", unknown=_LONGER),
    "sigma": Wording(title="how much people differ", unknown=_OF_MANY),
}
"""The parameters of the model of people, in the order of the table; the first ones can be measured."""

OTHERS: dict[str, Wording] = {
    "confirmed_right": Wording(title="right messages confirmed, of those answered", percent=True),
    "confirmed_wrong": Wording(title="wrong messages confirmed, of those answered", percent=True),
    HIDDEN: Wording(title="messages followed with the map hidden", percent=True),
    "first_rating": Wording(title="first rating of trust, 1 to 7"),
    "last_rating": Wording(title="last rating of trust, 1 to 7"),
    "look_round": Wording(title="angle turned before the first step"),
    "rise_s": Wording(title="time from standing to walking speed"),
    "clearance": Wording(title="distance kept from walls and furniture while walking"),
}
"""What else was measured; the model of people has no number for these, so there is nothing to compare with."""
