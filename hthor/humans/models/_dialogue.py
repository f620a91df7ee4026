"""A participant and the robots' messages, from the first notice to the answer."""

from collections.abc import Callable

from msgspec import Struct

from hthor.humans.communication.accept_decision import decide_answer
from hthor.humans.communication.interpretation import Advice, AdviceTracker
from hthor.humans.communication.message_reading import MessageReader, Reading
from hthor.humans.communication.trust import Experience
from hthor.humans.core.policy import Offer
from hthor.humans.core.trial_context import HumanContext
from hthor.types import Observation, Reply
from hthor.types.events import Misled
from hthor.types.events import Offer as OfferEntry

Saving = Callable[[Advice], tuple[float, float | None]]
"""Estimates the seconds that advice saves, and the metres to its place, None without a place."""


class MessageDecision(Struct, frozen=True, kw_only=True):
    """The decision on a message: the ``reply``, None when it was ignored, and the ``advice``, None unless accepted."""

    reply: Reply | None = None
    advice: Advice | None = None


class Dialogue:
    """Reads messages, one at a time, and keeps the participant's ``experience`` of the robots.

    Every answer is recorded in the journal, as `hthor.types.events.Offer`.
    """

    def __init__(self, human: HumanContext, advice: AdviceTracker) -> None:
        self.human, self.advice = human, advice
        self.reader = MessageReader(human.traits, human.root, human.tick_s)
        self.experience = Experience()

    def read(self, now: Observation, trust: float, busy: bool, saving: Saving) -> MessageDecision | None:
        """Look at the inbox; None while there is nothing to answer. ``busy``: the participant has work in hand."""
        reader, human = self.reader, self.human
        reader.receive(now.tick, now.inbox)
        self.experience.offered = reader.offered
        reading = reader.ready(now.tick)
        if reading is None:
            return None
        advice = self.advice.interpret(reading.message)
        relevant = advice is not None or self.advice.is_relevant(reading.message)
        offer = self._offer(reading, advice, trust, busy, saving)
        answer = decide_answer(human, offer, relevant)
        accepted = answer == "accept"
        reader.mark_answered(reading, accepted)
        entry = OfferEntry(
            tick=now.tick,
            seat=human.seat,
            message=reading.message.id,
            number=offer.number,
            trust=round(trust, 4),
            useful=offer.useful,
            relevant=relevant,
            gain=round(offer.gain, 2),
            load=offer.load,
            again=offer.again,
            words=reading.words,
            read_s=round((now.tick - reading.since) * human.tick_s, 2),
            answer=answer,
        )
        human.record(entry)
        if accepted and relevant and self.experience.helped is None and not self.experience.misled:
            self.experience.helped = now.tick * human.tick_s
        reply = None if answer == "ignore" else Reply(message=reading.message.id, accept=accepted)
        return MessageDecision(reply=reply, advice=advice if accepted else None)

    def record_misled(self) -> None:
        """Record that the accepted advice was of no help."""
        self.experience.misled, self.experience.helped = True, None
        self.human.record(Misled(tick=self.human.now.tick, seat=self.human.seat))

    def _offer(self, reading: Reading, advice: Advice | None, trust: float, busy: bool, saving: Saving) -> Offer:
        gain, metres = saving(advice) if advice is not None else (0.0, None)
        message = reading.message
        return Offer(
            text=message.text,
            object=message.object,
            sender=message.sender,
            number=reading.number,
            trust=trust,
            useful=advice is not None,
            gain=gain,
            load=float(busy),
            again=reading.again,
            metres=metres,
            instruction=self.human.task.instruction,
        )
