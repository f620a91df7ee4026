"""Every parameter that logs measure directly, estimated from them one after the other; reads no files.

What an earlier estimate has found is known to the later ones: the trust at which a message was answered comes from the
ratings, practice from the pace.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import msgspec
import numpy as np

from hthor import rules
from hthor.calibration.from_logs import estimate, trial_features
from hthor.calibration.from_logs.accumulator import Desk, numbers
from hthor.calibration.from_logs.estimate import Estimate
from hthor.calibration.from_logs.load_sessions import Sessions
from hthor.calibration.from_logs.models import (
    acceptance_model,
    choice_model,
    detection_model,
    reading_time,
    timing_models,
    trust_model,
)
from hthor.calibration.from_logs.models.mixed_effects import Array, Fit
from hthor.calibration.from_logs.models.priors import Belief, Beliefs
from hthor.errors import MissingExtra
from hthor.humans.population.parameter_registry import parameter

Tell = Callable[[str], None]
READING = "reading"
"""The name of the time from a message to its answer, of twelve words: the sum of ``t_notice`` and ``t_read``."""


def everything(sessions: Sessions, beliefs: Beliefs, tell: Tell = lambda _: None) -> tuple[Estimate, ...]:
    """All estimates, in the registry's order, and `READING`.

    Args:
        beliefs: what was believed before; priors where the logs tell little.
        tell: told what is being estimated, for people who wait.

    Raises:
        MissingExtra: without scipy.
    """
    _need_scipy()
    desk = Desk(trial_features.reduce(sessions), dict(beliefs))
    for name, step in _STEPS.items():
        tell(name)
        step(desk)
    desk.between_people()
    return tuple(desk.found[name] for name in (*beliefs, READING) if name in desk.found)


def walking(desk: Desk) -> None:
    """Pace with its practice, turning, starting, stopping, following a map."""
    beliefs, walks = desk.beliefs, [(one, one.walk) for one in desk.trials if one.walk is not None]
    pace = desk.capped([(w.pace, t, w.full) for t, w in walks])
    if len(pace.y):
        practice = beliefs["learn"].term()
        fit = timing_models.log_normal(
            pace, beliefs["v_pace"].term(), parameter("v_pace").effect, noise=0.03, practice=1, learn=practice
        )
        desk.keep(("v_pace", "learn"), fit, len(pace.y), "median stick under way, mixed model")
        desk.spread("v_pace", fit)
    turns = desk.capped([(rate, t, w.fastest) for t, w in walks for rate in w.turns])
    if len(turns.y):
        fit = timing_models.log_normal(turns, beliefs["omega"].term(), parameter("omega").effect, noise=0.05)
        desk.keep(("omega",), fit, len(turns.y), "speed of turns over 45 degrees, mixed model")
        desk.spread("omega", fit)
    stops = [stop for _, w in walks for stop in w.stops]
    desk.median("t_on", [w.start for _, w in walks], "first move or turn", least=rules.TICK_S)
    desk.rate("stop_every", sum(w.under_way for _, w in walks), len(stops), "time under way by stops", least=0.2)
    desk.median("stop_s", stops, "standing still in a straight walk", least=rules.TICK_S / 2)
    desk.median("k_map", [r for _, w in walks for r in w.guided], "pace after a confirmed message", least=0.02)


def handling(desk: Desk) -> None:
    """Length and misses of attempts with the hands; what takes the device's least time might be faster without it."""
    attempts = [(one, attempt) for one in desk.trials for attempt in one.attempts]
    if not attempts:
        return
    least = 1.01 * rules.HANDLING_S
    data = timing_models.sample(
        [(a.seconds, t.person, t.index, 1 if a.cut else -int(a.seconds <= least)) for t, a in attempts]
    )
    practice = desk.found["learn"].value if "learn" in desk.found else desk.beliefs["learn"].middle
    prior, effect = desk.beliefs["t_manip"].term(), parameter("t_manip").effect
    fit = timing_models.log_normal(data, prior, effect, noise=0.35, practice=-1, learn=practice)
    desk.keep(("t_manip",), fit, len(data.y), "attempt to outcome, mixed model")
    desk.spread("t_manip", fit)
    ended = [attempt for _, attempt in attempts if not attempt.cut]
    desk.share("p_fail", sum(attempt.missed for attempt in ended), len(ended), "misses among attempts")


def messages(desk: Desk) -> None:
    """Noticing and reading messages."""
    beliefs = dict(desk.beliefs)
    rows = [(s, one.person, one.index, int(not seen)) for one in desk.trials for s, seen in one.noticings]
    if any(not censored for *_, censored in rows):
        fit = reading_time.notice(rows, beliefs["t_notice"])
        beliefs["t_notice"] = msgspec.structs.replace(
            beliefs["t_notice"], mean=fit.value["t_notice"], sd=fit.se["t_notice"]
        )
    read = [(one, each) for one in desk.trials for each in one.readings]
    if not read:
        return
    fit = reading_time.durations([each for _, each in read], numbers([t.person for t, _ in read]), beliefs)
    answers = sum(each.answered for _, each in read)
    method = "shown to answer, mixed model of two log-normals"
    desk.keep(("t_notice", "t_read"), fit, answers, method)
    desk.found[READING] = _whole(desk.beliefs, fit, answers, method)
    desk.spread("t_read", fit)


def trust_and_answers(desk: Desk) -> None:
    """First trust and what moves it, by the ratings; then, at that trust, which messages were confirmed."""
    sessions: dict[int, list[int]] = {}
    for number, one in enumerate(desk.trials):
        sessions.setdefault(one.session, []).append(number)
    rated = [own for own in sessions.values() if any(desk.trials[k].experience.rating for k in own)]
    trust = np.full(len(desk.trials), desk.beliefs["mu0"].middle)
    if rated:
        data = trust_model.course(
            [[desk.trials[k].experience for k in own] for own in rated],
            numbers([desk.trials[own[0]].person for own in rated]),
        )
        fit = trust_model.dynamics(data, desk.beliefs)
        ratings = int((data.rating > 0.0).sum())
        desk.keep(trust_model.TERMS, fit, ratings, "ratings, hierarchical Beta law")
        desk.spread("mu0", fit)
        before, _ = trust_model.means(data, fit.value, fit.effects[data.person])
        for row, own in enumerate(rated):
            trust[own] = before[row, : len(own)]
    _answers(desk, trust)


def _answers(desk: Desk, trust: Array) -> None:
    offers = [(k, each) for k, one in enumerate(desk.trials) for each in one.offers]
    if not offers:
        return
    rows = [k for k, _ in offers]
    people = numbers([desk.trials[k].person for k in rows])
    fit = acceptance_model.regression([each for _, each in offers], trust[rows], people, desk.beliefs)
    desk.keep(acceptance_model.TERMS, fit, len(offers), "confirmed or not, mixed logistic regression")
    desk.spread("a0", fit)


def choices(desk: Desk) -> None:
    """Where people chose to search."""
    made = [(one, each) for one in desk.trials for each in one.choices]
    if made:
        known = {name: _found(desk, name) for name in ("beta", "kappa", "w_prior", "t_dwell", "t_manip")}
        people = numbers([t.person for t, _ in made])
        fit = choice_model.conditional_logit([each for _, each in made], people, known)
        desk.keep(("beta", "kappa", "w_prior"), fit, len(made), "where to search, conditional logit")
        desk.spread("beta", fit)


def seeing(desk: Desk) -> None:
    """How fast people noticed what they looked for."""
    seen = [(one, each) for one in desk.trials for each in one.exposures]
    if seen:
        fit = detection_model.regression([each for _, each in seen], numbers([t.person for t, _ in seen]), desk.beliefs)
        desk.keep(("lam0", "a50", "clutter"), fit, len(seen), "noticed or not, complementary log-log")
        desk.spread("lam0", fit)


_STEPS: dict[str, Callable[[Desk], None]] = {
    "walking": walking,
    "handling": handling,
    "messages": messages,
    "trust and answers": trust_and_answers,
    "choices": choices,
    "seeing": seeing,
}


def _need_scipy() -> None:
    try:
        import scipy.optimize  # noqa: F401
    except ImportError:
        raise MissingExtra("estimating parameters from logs", "calibration") from None


def _found(desk: Desk, name: str) -> Belief:
    """What is believed by now: the median of an earlier estimate, where there is one."""
    belief, found = desk.beliefs[name], desk.found.get(name)
    return belief if found is None else msgspec.structs.replace(belief, mean=found.at)


def _whole(beliefs: Beliefs, fit: Fit, n: int, method: str) -> Estimate:
    """The time from a message to its answer, with the error that its two parts have together."""
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
    return estimate.of(belief, math.log(first + second), se, n, method)
