"""Whether a participant accepts a message that was read.

Acceptance is likelier with trust in the robots and with the time that it is expected to save, and less likely with work
in hand or after refusals of the same offer: a logit, as in Trust-POMDP (Chen et al. 2018, 2020), lowered by workload
(Mangalindan et al. 2024). Sometimes a finger slips. Nobody confirms on purpose what has nothing to do with the task.
What is not confirmed is declined, or left without an answer.
"""

import math
from typing import Any

from hthor.humans.core.policy import Answer, Offer
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.population.parameters import Parameters
from hthor.types import HUMAN, Event

NEUTRAL_TRUST = 0.5
"""[share] Mean trust at which ``a0`` is the whole logit of a plain offer. Our choice: the middle of the scale."""


def acceptance_terms(traits: Parameters, offer: Offer) -> dict[str, float]:
    """The parts of the logit of confirming, by name; they add up."""
    return {
        "a0": traits.a0,
        "trust": traits.a_trust * (offer.trust - NEUTRAL_TRUST),
        "gain": traits.a_gain * math.log1p(offer.gain),
        "load": -traits.a_load * offer.load,
        "again": -traits.a_again * offer.again,
    }


def decide_answer(human: HumanContext, offer: Offer, relevant: bool = True) -> Answer:
    """The participant's answer, or that of the policy that decides in their place.

    Args:
        relevant: whether the message is about anything in the task.
    """
    if human.policy is not None:
        return human.policy.answer(offer)
    traits, number = human.traits, offer.number
    parts = acceptance_terms(traits, offer)
    share = 1.0 / (1.0 + math.exp(-sum(parts.values()))) if relevant else 0.0
    answer: Answer = "confirm" if human.draw("accept", number) < share else "decline"
    slipped = human.draw("slip", number) < traits.p_slip
    if slipped:
        answer = "decline" if answer == "confirm" else "confirm"
    elif answer == "decline" and human.draw("ignore", number) < traits.p_ignore:
        answer = "ignore"
    if human.listener is not None:
        data: dict[str, Any] = {**{name: round(part, 4) for name, part in parts.items()}, "share": round(share, 4)}
        data |= {"message": offer.number, "relevant": relevant, "slipped": slipped, "answer": answer}
        human.listener(Event(tick=human.now.tick, seat=HUMAN, kind="weighed", data=data))
    return answer
