"""What a person answers to a message that they have read.

People confirm the likelier the more they trust the robots and the more time it is expected to save them, and less
likely with work in hand or when they refused the same before: a logit, as in Trust-POMDP (Chen et al. 2018, 2020),
lowered by workload (Mangalindan et al. 2024). Now and then a finger slips. Nobody confirms on purpose what has nothing
to do with what they are about. What was not confirmed is declined, or left without an answer.
"""

from __future__ import annotations

import math
from typing import Any

from hthor.humans.core.policy import Answer, Offer
from hthor.humans.core.trial_context import Subject
from hthor.humans.population.parameters import Parameters
from hthor.types import HUMAN, Event


def terms(traits: Parameters, offer: Offer) -> dict[str, float]:
    """What speaks for confirming, as parts of a logit that add up."""
    return {
        "a0": traits.a0,
        "trust": traits.a_trust * (offer.trust - 0.5),
        "gain": traits.a_gain * math.log1p(offer.gain),
        "load": -traits.a_load * offer.load,
        "again": -traits.a_again * offer.again,
    }


def answer(me: Subject, offer: Offer, relevant: bool = True) -> Answer:
    """The person's answer, or that of the policy which decides in their place.

    Args:
        relevant: whether the message is about anything that the person has to do.
    """
    if me.policy is not None:
        return me.policy.answer(offer)
    traits, number = me.traits, offer.number
    parts = terms(traits, offer)
    share = 1.0 / (1.0 + math.exp(-sum(parts.values()))) if relevant else 0.0
    said: Answer = "confirm" if me.draw("accept", number) < share else "decline"
    slipped = me.draw("slip", number) < traits.p_slip
    if slipped:
        said = "decline" if said == "confirm" else "confirm"
    elif said == "decline" and me.draw("ignore", number) < traits.p_ignore:
        said = "ignore"
    if me.think is not None:
        data: dict[str, Any] = {**{name: round(part, 4) for name, part in parts.items()}, "share": round(share, 4)}
        data |= {"message": offer.number, "relevant": relevant, "slipped": slipped, "answer": said}
        me.think(Event(tick=me.now.tick, seat=HUMAN, kind="weighed", data=data))
    return said
