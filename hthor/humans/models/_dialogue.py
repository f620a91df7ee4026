"""A participant and the messages of robots and other people, from the first notice to the answer."""

from collections.abc import Callable
from typing import Literal

from msgspec import Struct

from hthor.humans.communication.accept_decision import NEUTRAL_TRUST, decide_answer
from hthor.humans.communication.interpretation import Advice, AdviceTracker
from hthor.humans.communication.message_reading import MessageReader, Reading, is_remark
from hthor.humans.communication.questions import QuestionAnswering
from hthor.humans.communication.speech import Speech
from hthor.humans.communication.trust import Experience
from hthor.humans.core.policy import Offer
from hthor.humans.core.trial_context import HumanContext
from hthor.types import Observation, Reply, Send, is_person
from hthor.types.events import Asked, Misled, Replied
from hthor.types.events import Offer as OfferEntry

Saving = Callable[[Advice], tuple[float, float | None]]
"""Estimates the seconds that advice saves, and the metres to its place, None without a place."""

_ANSWERS: dict[bool | None, Literal["yes", "no", "ignore"]] = {True: "yes", False: "no", None: "ignore"}


class MessageDecision(Struct, frozen=True, kw_only=True):
    """What a participant says now, None if nothing, and the ``advice`` that they have just accepted, None if none."""

    say: Reply | Send | None = None
    advice: Advice | None = None


class Dialogue:
    """Reads messages, one at a time, says one thing at a time, and keeps the ``experience`` of the robots.

    Every answer to an offer is recorded in the journal, as `hthor.types.events.Offer`; questions of robots and others
    as `Replied`, the participant's own as `Asked`.
    """

    def __init__(self, human: HumanContext, advice: AdviceTracker) -> None:
        self.human, self.advice = human, advice
        self.reader = MessageReader(human.traits, human.root, human.tick_s)
        self.questions = QuestionAnswering(human, advice.memory, advice.subgoals)
        self.speech = Speech(human.tick_s)
        self.experience = Experience()
        self._from_people: set[int] = set()

    @property
    def is_occupied(self) -> bool:
        """Whether the participant is saying something, or has a message to read."""
        reading = self.reader.now
        return self.speech.now is not None or (reading is not None and not reading.answered)

    def is_slowing(self, tick: int) -> bool:
        """Whether reading or speaking takes attention from walking now."""
        return self.speech.now is not None or self.reader.is_reading(tick)

    def ask(self, question: Send) -> None:
        """Begin to ask a question."""
        human, words = self.human, len(question.text.split())
        seconds = round(self.speech.begin(human.now.tick, question), 2)
        human.record(Asked(tick=human.now.tick, seat=human.seat, object=question.object, words=words, seconds=seconds))

    def is_from_robot(self, advice: Advice) -> bool:
        """Whether advice is a robot's, not another person's."""
        return advice.number not in self._from_people

    def read(self, now: Observation, trust: float, busy: bool, saving: Saving) -> MessageDecision | None:
        """Look at the inbox; None while there is nothing to say. ``busy``: the participant has work in hand."""
        reader = self.reader
        reader.receive(now.tick, now.inbox)
        self.experience.offered = reader.offered
        if self.speech.now is not None:
            said = self.speech.finish(now.tick, now.inbox)
            return None if said is None else MessageDecision(say=said)
        reading = reader.ready(now.tick)
        if reading is None:
            return None
        if reading.message.question:
            self._consider(reading)
        elif is_remark(reading.message):
            reader.mark_read(reading)
        else:
            return self._decide(reading, trust, busy, saving)
        return None

    def _consider(self, reading: Reading) -> None:
        """Begin to answer a question that was read, if it was understood."""
        self.reader.mark_read(reading)
        question, human, seconds = reading.message, self.human, 0.0
        answer = self.questions.answer(question)
        if answer is not None:
            say = Reply(message=question.id, accept=answer) if isinstance(answer, bool) else answer
            seconds = self.speech.begin(human.now.tick, say)
        entry = Replied(
            tick=human.now.tick,
            seat=human.seat,
            message=question.id,
            words=reading.words,
            read_s=round((human.now.tick - reading.since) * human.tick_s, 2),
            answer="told" if isinstance(answer, Send) else _ANSWERS[answer],
            seconds=round(seconds, 2),
        )
        human.record(entry)

    def _decide(self, reading: Reading, trust: float, busy: bool, saving: Saving) -> MessageDecision:
        """Accept, decline or ignore an offer; trust in robots has no part in what other people say."""
        reader, human, now = self.reader, self.human, self.human.now
        from_person = is_person(reading.message.sender)
        if from_person:
            trust = NEUTRAL_TRUST
            self._from_people.add(reading.message.id)
        advice = self.advice.interpret(reading.message)
        relevant = advice is not None or self.advice.is_relevant(reading.message)
        offer = self._offer(reading, advice, trust, busy, saving)
        answer = decide_answer(human, offer, relevant)
        accepted = answer == "accept"
        reader.mark_answered(reading, accepted)
        self.questions.note(reading.message, accepted)
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
        helps = accepted and relevant and not from_person
        if helps and self.experience.helped is None and not self.experience.misled:
            self.experience.helped = human.seconds
        reply = None if answer == "ignore" else Reply(message=reading.message.id, accept=accepted)
        return MessageDecision(say=reply, advice=advice if accepted else None)

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
