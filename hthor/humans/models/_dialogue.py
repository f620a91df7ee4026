"""A person and the robots' messages, from the first notice to the answer."""

from __future__ import annotations

from msgspec import Struct

from hthor.humans.behaviours.behaviours import Errands
from hthor.humans.communication.accept_decision import answer
from hthor.humans.communication.interpretation import Claim, Claims
from hthor.humans.communication.message_reading import Reader, Reading
from hthor.humans.communication.time_saving import gain
from hthor.humans.communication.trust import Experience
from hthor.humans.core.policy import Offer
from hthor.humans.core.trial_context import Subject
from hthor.types import Observation, Reply


class Said(Struct, frozen=True, kw_only=True):
    """What came of a message that was read: the ``reply``, None when it was ignored, and the ``claim`` to follow."""

    reply: Reply | None = None
    claim: Claim | None = None


class Talk:
    """Hears robots, one message at a time, and keeps what a trial's robots were worth (``experience``).

    Every answer is written into the journal as "offer", see `answer` for the law and `Offer` for the terms: ``number``
    of the message among those that were read, ``relevant`` when it was about the task at all, ``words`` its length and
    ``read_s`` the seconds from when it was shown to the answer.
    """

    def __init__(self, me: Subject, claims: Claims) -> None:
        self.me, self.claims = me, claims
        self.reader = Reader(me.traits, me.root, me.tick_s)
        self.experience = Experience()

    def hear(self, now: Observation, trust: float, busy: bool, errands: Errands | None) -> Said | None:
        """Look at the inbox; None while there is nothing to answer.

        Args:
            trust: mean trust, 0 to 1.
            busy: whether the person has something in hand, or is about to take it.
            errands: what the person would do otherwise; None before they have opened their eyes.
        """
        reader = self.reader
        reader.receive(now.tick, now.inbox)
        self.experience.offered = reader.offered
        reading = reader.ready(now.tick)
        if reading is None:
            return None
        claim = self.claims.meaning(reading.message)
        relevant = claim is not None or self.claims.concerns(reading.message)
        offer = self._offer(reading, claim, trust, busy, errands)
        said = answer(self.me, offer, relevant)
        confirmed = said == "confirm"
        reader.settle(reading, confirmed)
        self.me.note(
            "offer",
            message=reading.message.id,
            number=offer.number,
            trust=round(trust, 4),
            useful=offer.useful,
            relevant=relevant,
            gain=round(offer.gain, 2),
            load=offer.load,
            again=offer.again,
            words=reading.words,
            read_s=round((now.tick - reading.since) * self.me.tick_s, 2),
            answer=said,
        )
        if confirmed and relevant and self.experience.helped is None and not self.experience.misled:
            self.experience.helped = now.tick * self.me.tick_s
        reply = None if said == "ignore" else Reply(message=reading.message.id, accept=confirmed)
        return Said(reply=reply, claim=claim if confirmed else None)

    def mislead(self) -> None:
        """A robot's word led nowhere."""
        self.experience.misled, self.experience.helped = True, None
        self.me.note("misled")

    def _offer(self, reading: Reading, claim: Claim | None, trust: float, busy: bool, errands: Errands | None) -> Offer:
        saved, metres = 0.0, None
        if claim is not None and errands is not None:
            search = errands.searching(claim.errand)
            saved, metres = gain(self.me, errands.walker, search, claim.position)
        message = reading.message
        return Offer(
            text=message.text,
            object=message.object,
            sender=message.sender,
            number=reading.number,
            trust=trust,
            useful=claim is not None,
            gain=saved,
            load=float(busy),
            again=reading.again,
            metres=metres,
            instruction=self.me.task.instruction,
        )
