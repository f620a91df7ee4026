"""How one person reads and answers messages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.calibration.from_logs.estimate_all import READING
from hthor.calibration.from_logs.features.messages import Reading
from hthor.calibration.from_logs.trial_features import Trial, TrialFeatures
from hthor.calibration.person.measure import Measure, share, unknown, weighted
from hthor.comms.claims import is_false
from hthor.humans.communication.message_reading import LEAST_WORDS, REFERENCE_WORDS, REREADING_SHARE
from hthor.humans.population.parameter_registry import parameter
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population
from hthor.types import HUMAN
from hthor.types.events import Accepted, Declined, Picked, Placed, Sent

_LEAST_READ, _LEAST_ANSWERS = 4, 6
_GAIN_S = 12.0
"""[s] The time that a true message is assumed to save: the median of what simulated people expected in these tasks."""
_DRAWS = 200
_A0_REACH = 6.0
"""[logit] How far from the middle of its prior the willingness to accept is looked for. Our choice."""


class Answer(Struct, frozen=True, kw_only=True):
    """One message of a robot and the answer to it.

    Attributes:
        accepted: whether it was confirmed. true: whether it was right.
        trust: the rating before, as a share; None before the first rating. load: 1 with something in hand.
        again: how many messages about the same object the person had declined before.
    """

    accepted: bool
    true: bool
    trust: float | None
    load: float
    again: float


def reading(trials: Sequence[TrialFeatures]) -> list[Measure]:
    """The time to notice and to read a message, and their sum for one of twelve words."""
    read = [each for one in trials for each in one.readings if each.answered]
    names = ("t_notice", "t_read", READING)
    if len(read) < _LEAST_READ:
        words = f"there were {len(read)} answered messages; it takes {_LEAST_READ}"
        return [unknown(name, "s", words) for name in names]
    notice, slow, logs = _reading_likelihood(read)
    found = zip(names, (notice, slow, notice + slow), strict=True)
    how = "from a message to its answer, with short and long messages"
    return [
        Measure(name=name, unit="s", value=middle, low=low, high=high, n=len(read), how=how)
        for name, (middle, low, high) in ((name, weighted(values, logs)) for name, values in found)
    ]


def _reading_likelihood(read: Sequence[Reading]) -> tuple[Any, Any, Any]:
    """Pairs of the two times [s] and the logarithm of the likelihood of each; every pair is one of a logarithmic grid.

    A time to answer is the sum of two log-normal ones, which is nearly log-normal itself.
    """
    grid = np.exp(np.linspace(math.log(0.1), math.log(15.0), 80))
    first, second = (axis.ravel()[:, None] for axis in np.meshgrid(grid, grid))
    y = np.log([one.seconds for one in read])
    length = np.array(
        [max(LEAST_WORDS, one.words) / REFERENCE_WORDS * (REREADING_SHARE if one.known else 1.0) for one in read]
    )
    spread, long = Parameters().read_sd ** 2, second * length
    variance = np.log1p(math.expm1(spread) * (first**2 + long**2) / (first + long) ** 2)
    z = (y - np.log(first + long) - 0.5 * (spread - variance)) / np.sqrt(variance)
    return first[:, 0], second[:, 0], (-0.5 * z * z - 0.5 * np.log(variance)).sum(axis=1)


def answers_of(trials: Sequence[Trial]) -> list[Answer]:
    """The messages that one person answered, in order; repetitions are answers of their own."""
    found: list[Answer] = []
    trust: float | None = None
    for one in trials:
        record, declined, holding = one.record, dict[str, int](), False
        sent = {event.message: event for event in record.events if isinstance(event, Sent)}
        for event in record.events:
            if event.seat == HUMAN and isinstance(event, (Picked, Placed)):
                holding = isinstance(event, Picked)
            if event.seat != HUMAN or not isinstance(event, (Accepted, Declined)) or event.message not in sent:
                continue
            about = sent[event.message]
            answer = Answer(
                accepted=isinstance(event, Accepted),
                true=not is_false(about),
                trust=trust,
                load=float(holding),
                again=float(declined.get(about.object, 0)),
            )
            found.append(answer)
            declined[about.object] = declined.get(about.object, 0) + (not answer.accepted)
        rating = record.ratings.get(HUMAN)
        trust = trust if rating is None else (rating - rules.TRUST_MIN) / (rules.TRUST_MAX - rules.TRUST_MIN)
    return found


def acceptance(answers: Sequence[Answer], population: Population) -> list[Measure]:
    """The willingness to accept, given the other weights of a population, and the shares of messages confirmed."""
    return [_willingness(answers, population), *shares(answers)]


def shares(answers: Sequence[Answer]) -> list[Measure]:
    """The shares of true and of false messages that were confirmed, among those that were answered."""
    found = []
    for name, word, true in (("confirmed_right", "right", True), ("confirmed_wrong", "wrong", False)):
        kind = [one.accepted for one in answers if one.true == true]
        how = f"answered messages that were {word}"
        if not kind:
            found.append(unknown(name, "", f"no message that was {word} was answered"))
            continue
        value, low, high = share(sum(kind), len(kind))
        found.append(Measure(name=name, unit="", value=value, low=low, high=high, n=len(kind), how=how))
    return found


def _willingness(answers: Sequence[Answer], population: Population) -> Measure:
    name, how = "a0", "confirmed or declined, at the trust of the last rating; other weights as in the population"
    if len(answers) < _LEAST_ANSWERS:
        return unknown(name, "logit", f"there were {len(answers)} answers; it takes {_LEAST_ANSWERS}")
    centre = parameter(name).prior.quantile(0.5)  # type: ignore[union-attr]
    grid = centre + np.linspace(-_A0_REACH, _A0_REACH, 121)
    logs = np.logaddexp.reduce(
        [_answer_likelihood(grid, answers, population.parameters(population.pick(0, k))) for k in range(_DRAWS)], axis=0
    )
    confirmed = sum(one.accepted for one in answers)
    value, low, high = weighted(grid, logs)
    if confirmed in (0, len(answers)):
        edge, bound = (low, "at least") if confirmed else (high, "at most")
        return Measure(
            name=name,
            unit="logit",
            value=edge,
            low=edge if confirmed else -math.inf,
            high=math.inf if confirmed else edge,
            bound="at least" if bound == "at least" else "at most",
            n=len(answers),
            how=f"{how}; every message was {'confirmed' if confirmed else 'declined'}",
        )
    return Measure(name=name, unit="logit", value=value, low=low, high=high, n=len(answers), how=how)


def _answer_likelihood(grid: Any, answers: Sequence[Answer], mean: Parameters) -> Any:
    """The logarithm of the likelihood at each willingness, with the other weights of a draw."""
    total = np.zeros(len(grid))
    for one in answers:
        trust = mean.mu0 if one.trust is None else one.trust
        gain = mean.a_gain * math.log1p(_GAIN_S) if not one.load else 0.0
        logit = grid + mean.a_trust * (trust - 0.5) + gain - mean.a_load * one.load - mean.a_again * one.again
        chance = mean.p_slip + (1.0 - 2.0 * mean.p_slip) / (1.0 + np.exp(-logit))
        total += np.log(chance if one.accepted else 1.0 - chance)
    return total


def hidden_map(trials: Sequence[TrialFeatures]) -> Measure:
    """The share of confirmed messages that were followed with the map hidden."""
    name, follows = "map_hidden", [follow for one in trials for follow in one.follows]
    if not follows:
        return unknown(name, "", "no confirmed message was followed")
    value, low, high = share(sum(one.hidden for one in follows), len(follows))
    how = "the map hidden soon after confirming"
    return Measure(name=name, unit="", value=value, low=low, high=high, n=len(follows), how=how)
