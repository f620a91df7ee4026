"""Estimates every parameter that logs measure directly, one group after the other.

Later estimators use earlier estimates: trust at the time of an answer is estimated from the ratings, and practice from
the pace.
"""

import math
from collections.abc import Callable

import msgspec
import numpy as np

from hthor import rules
from hthor.calibration.from_logs import estimate, trial_features
from hthor.calibration.from_logs.estimate import Estimate, EstimateCollector, renumber
from hthor.calibration.from_logs.models import search_models, timing_models, trust_model
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit
from hthor.calibration.from_logs.models.priors import Belief, Beliefs
from hthor.calibration.from_logs.trial_features import Sessions
from hthor.humans.population.parameter_registry import parameter

Tell = Callable[[str], None]
HIDDEN = "map_hidden"
"""The share of messages that are followed with the map hidden, a number that is the same for everybody."""
READING = "reading"
"""The name of the time from a message of twelve words to its answer: the sum of ``t_notice`` and ``t_read``."""
_ANY_SHARE = Belief(name=HIDDEN, unit="", scale="logit", mean=0.0, sd=3.0, low=0.0, high=1.0)


def estimate_parameters(sessions: Sessions, beliefs: Beliefs, tell: Tell = lambda _: None) -> tuple[Estimate, ...]:
    """All estimates, in the registry's order, `READING` and `HIDDEN`; ``tell`` is called with the name of each step.

    If the logs say little about a parameter, its estimate stays close to the prior belief.
    """
    collector = EstimateCollector(trial_features.extract_features(sessions), dict(beliefs))
    for name, step in _STEPS.items():
        tell(name)
        step(collector)
    collector.between_people()
    return tuple(collector.estimates[name] for name in (*beliefs, READING, HIDDEN) if name in collector.estimates)


def estimate_walking(collector: EstimateCollector) -> None:
    """Walking pace and its practice, turning, starting, stopping, and following a map."""
    beliefs, walks = collector.beliefs, [(one, one.walk) for one in collector.trials if one.walk is not None]
    pace = collector.capped([(w.pace, t, w.full) for t, w in walks])
    if len(pace.y):
        practice = beliefs["learn"].term()
        fit = timing_models.fit_log_normal(
            pace, beliefs["v_pace"].term(), parameter("v_pace").effect, noise=0.03, practice=1, learn=practice
        )
        collector.add(("v_pace", "learn"), fit, len(pace.y), "median stick under way, mixed model")
    turns = collector.capped([(rate, t, w.fastest) for t, w in walks for rate in w.turns])
    if len(turns.y):
        fit = timing_models.fit_log_normal(turns, beliefs["omega"].term(), parameter("omega").effect, noise=0.05)
        collector.add(("omega",), fit, len(turns.y), "speed of turns over 45 degrees, mixed model")
    stops = [stop for _, w in walks for stop in w.stops]
    collector.median("t_on", [w.start for _, w in walks], "first move or turn", least=rules.TICK_S)
    collector.rate("stop_every", sum(w.under_way for _, w in walks), len(stops), "time under way by stops", least=0.2)
    collector.median("stop_s", stops, "standing still in a straight walk", least=rules.TICK_S / 2)
    collector.median("k_map", [r for _, w in walks for r in w.guided], "pace after an accepted message", least=0.02)


def estimate_manipulation(collector: EstimateCollector) -> None:
    """Duration and misses of attempts; a duration at the device's minimum is an upper bound of the person's own."""
    attempts = [(one, attempt) for one in collector.trials for attempt in one.attempts]
    if not attempts:
        return
    least = 1.01 * rules.HANDLING_S
    data = timing_models.make_sample(
        [(a.seconds, t.person, t.index, 1 if a.cut else -int(a.seconds <= least)) for t, a in attempts]
    )
    learn = collector.estimates.get("learn")
    practice = collector.beliefs["learn"].middle if learn is None else learn.value
    prior, effect = collector.beliefs["t_manip"].term(), parameter("t_manip").effect
    fit = timing_models.fit_log_normal(data, prior, effect, noise=0.35, practice=-1, learn=practice)
    collector.add(("t_manip",), fit, len(data.y), "attempt to outcome, mixed model")
    ended = [attempt for _, attempt in attempts if not attempt.cut and not attempt.seen]
    collector.share("p_fail", sum(attempt.missed for attempt in ended), len(ended), "misses among attempts")


def estimate_messages(collector: EstimateCollector) -> None:
    """Noticing and reading messages."""
    beliefs = dict(collector.beliefs)
    rows = [(s, one.person, one.index, int(not seen)) for one in collector.trials for s, seen in one.noticings]
    if any(not censored for *_, censored in rows):
        fit = timing_models.fit_noticing(rows, beliefs["t_notice"])
        beliefs["t_notice"] = msgspec.structs.replace(
            beliefs["t_notice"], mean=fit.value["t_notice"], sd=fit.se["t_notice"]
        )
    read = [(one, each) for one in collector.trials for each in one.readings]
    if not read:
        return
    fit = timing_models.fit_reading([each for _, each in read], renumber([t.person for t, _ in read]), beliefs)
    answers = sum(each.answered for _, each in read)
    method = "shown to answer, mixed model of two log-normals"
    collector.add(timing_models.READING_TERMS, fit, answers, method)
    collector.estimates[READING] = _reading_total(collector.beliefs, fit, answers, method)


def estimate_map_use(collector: EstimateCollector) -> None:
    """How often messages are followed with the map hidden; no data come before the logs, so the belief is vague."""
    follows = [follow for one in collector.trials for follow in one.follows]
    collector.beliefs[HIDDEN] = _ANY_SHARE
    collector.share(HIDDEN, sum(one.hidden for one in follows), len(follows), "map hidden soon after confirming")


def estimate_trust(collector: EstimateCollector) -> None:
    """Initial trust and its changes, from the ratings; then acceptance of messages, given this trust."""
    sessions: dict[int, list[int]] = {}
    for number, one in enumerate(collector.trials):
        sessions.setdefault(one.session, []).append(number)
    rated = [own for own in sessions.values() if any(collector.trials[k].experience.rating for k in own)]
    trust = np.full(len(collector.trials), collector.beliefs["mu0"].middle)
    if rated:
        data = trust_model.make_trust_data(
            [[collector.trials[k].experience for k in own] for own in rated],
            renumber([collector.trials[own[0]].person for own in rated]),
        )
        fit = trust_model.fit_trust(data, collector.beliefs)
        ratings = int((data.rating > 0.0).sum())
        collector.add(trust_model.TERMS, fit, ratings, "ratings, hierarchical Beta law")
        before, _ = trust_model.mean_trust(data, fit.value, fit.effects[data.person])
        for row, own in enumerate(rated):
            trust[own] = before[row, : len(own)]
    _answers(collector, trust)


def _answers(collector: EstimateCollector, trust: Array) -> None:
    offers = [(k, each) for k, one in enumerate(collector.trials) for each in one.offers]
    if not offers:
        return
    rows = [k for k, _ in offers]
    people = renumber([collector.trials[k].person for k in rows])
    fit = trust_model.fit_acceptance([each for _, each in offers], trust[rows], people, collector.beliefs)
    collector.add(trust_model.ACCEPTANCE_TERMS, fit, len(offers), "accepted or not, mixed logistic regression")


def estimate_choices(collector: EstimateCollector) -> None:
    """Where people chose to search."""
    made = [(one, each) for one in collector.trials for each in one.choices]
    if made:
        known = {name: _current_belief(collector, name) for name in (*search_models.CHOICE_TERMS, "t_dwell", "t_manip")}
        people = renumber([t.person for t, _ in made])
        fit = search_models.fit_choices([each for _, each in made], people, known)
        collector.add(search_models.CHOICE_TERMS, fit, len(made), "where to search, conditional logit")


def estimate_detection(collector: EstimateCollector) -> None:
    """How fast people noticed what they were searching for."""
    seen = [(one, each) for one in collector.trials for each in one.exposures]
    if seen:
        fit = search_models.fit_detection(
            [each for _, each in seen], renumber([t.person for t, _ in seen]), collector.beliefs
        )
        collector.add(search_models.DETECTION_TERMS, fit, len(seen), "noticed or not, complementary log-log")


_STEPS: dict[str, Callable[[EstimateCollector], None]] = {
    "walking": estimate_walking,
    "handling": estimate_manipulation,
    "messages": estimate_messages,
    "the map": estimate_map_use,
    "trust and answers": estimate_trust,
    "choices": estimate_choices,
    "seeing": estimate_detection,
}


def _current_belief(collector: EstimateCollector, name: str) -> Belief:
    """The current belief about a parameter: around its earlier estimate, if there is one."""
    belief, found = collector.beliefs[name], collector.estimates.get(name)
    return belief if found is None else msgspec.structs.replace(belief, mean=found.at)


def _reading_total(beliefs: Beliefs, fit: Fit, n: int, method: str) -> Estimate:
    """The time from a message to its answer, with the joint error of its two parts."""
    names = list(fit.value)
    first, second = (math.exp(fit.value[name]) for name in ("t_notice", "t_read"))
    slope = np.zeros(len(names))
    slope[names.index("t_notice")], slope[names.index("t_read")] = first / (first + second), second / (first + second)
    se = math.sqrt(max(float(slope @ fit.covariance @ slope), 0.0))
    parts = beliefs["t_notice"], beliefs["t_read"]
    total = sum(part.middle for part in parts)
    sd = math.sqrt(sum((part.sd * part.middle / total) ** 2 for part in parts))
    belief = Belief(
        name=READING,
        unit="s",
        scale="log",
        mean=math.log(total),
        sd=sd,
        low=sum(part.low for part in parts),
        high=sum(part.high for part in parts),
    )
    return estimate.make_estimate(belief, math.log(first + second), se, n, method)
