"""Whether a participant accepts a message that was read, and how much time it would save.

People accept more often when they trust the robots and when they expect to save time, and less often with work in hand
or after refusals of the same offer: a logit, as in Trust-POMDP (Chen et al. 2018, 2020), lowered by workload
(Mangalindan et al. 2024). Sometimes they press the wrong button. Nobody accepts a message on purpose that has nothing
to do with the task. A message that is not accepted is declined, or left without an answer.

The time saved compares two plans: without the message people search on, option by option, the most promising first;
with it they walk to the place that it names and look there.
"""

import math

from hthor.humans.core.policy import Answer, Offer
from hthor.humans.core.thoughts import Weighed
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.motor.locomotion import Walker
from hthor.humans.population.parameters import Parameters
from hthor.humans.search.option_choice import OptionChoice
from hthor.humans.search.option_description import Option
from hthor.types import Vec3

NEUTRAL_TRUST = 0.5
"""[share] Mean trust that adds nothing to the logit of an offer. Our choice: the middle of the scale."""
_BESIDE_M = 1.0
"""[m] Distance from the named place at which the estimated path to it ends. Our choice."""


def acceptance_terms(traits: Parameters, offer: Offer) -> dict[str, float]:
    """The terms of the logit of accepting, by name; the logit is their sum."""
    return {
        "a0": traits.a0,
        "trust": traits.a_trust * (offer.trust - NEUTRAL_TRUST),
        "gain": traits.a_gain * math.log1p(offer.gain),
        "load": -traits.a_load * offer.load,
        "again": -traits.a_again * offer.again,
    }


def decide_answer(human: HumanContext, offer: Offer, relevant: bool = True) -> Answer:
    """The answer of the participant, or of the policy in their place; ``relevant``: the offer is about the task."""
    if human.policy is not None:
        return human.policy.answer(offer)
    traits, number = human.traits, offer.number
    parts = acceptance_terms(traits, offer)
    share = 1.0 / (1.0 + math.exp(-sum(parts.values()))) if relevant else 0.0
    answer: Answer = "accept" if human.draw("accept", number) < share else "decline"
    slipped = human.draw("slip", number) < traits.p_slip
    if slipped:
        answer = "decline" if answer == "accept" else "accept"
    elif answer == "decline" and human.draw("ignore", number) < traits.p_ignore:
        answer = "ignore"
    if human.listener is not None:
        human.listener(
            Weighed(
                tick=human.now.tick,
                seat=human.seat,
                number=number,
                terms={name: round(part, 4) for name, part in parts.items()},
                share=round(share, 4),
                relevant=relevant,
                slipped=slipped,
                answer=answer,
            )
        )
    return answer


def expected_search_time(options: list[Option], left: float, kappa: float) -> float:
    """Expected duration of a search [s], best option first; at most ``left``, which it takes if it finds nothing."""
    expected, elapsed, remaining = 0.0, 0.0, 1.0
    beliefs = [option.value * option.seconds**kappa for option in options]
    total = max(1.0, sum(beliefs))
    for option, belief in sorted(zip(options, beliefs, strict=True), key=lambda pair: (-pair[0].value, pair[0].name)):
        elapsed += option.seconds
        if elapsed >= left:
            break
        share = belief / total
        expected += share * elapsed
        remaining -= share
    return min(left, expected + max(0.0, remaining) * left)


def walk_to_message(human: HumanContext, walker: Walker, position: Vec3) -> tuple[float, float]:
    """Path length [m] to the named place as far as the house is known, and time [s] to go there and look."""
    point = (position[0], position[1])
    metres = walker.map.planner.distance(human.here, point, _BESIDE_M)
    if not math.isfinite(metres):
        metres = math.dist(human.here, point)
    return metres, metres * human.traits.k_map / human.traits.v_pace + human.traits.t_look


def time_saved(
    human: HumanContext, walker: Walker, search: OptionChoice, position: Vec3 | None
) -> tuple[float, float | None]:
    """Time [s] that following is expected to save, never negative, and path length [m], None without a place."""
    if position is None:
        return 0.0, None
    metres, seconds = walk_to_message(human, walker, position)
    searching = expected_search_time(search.recent(), human.seconds_left, human.traits.kappa)
    return max(0.0, searching - seconds), metres
