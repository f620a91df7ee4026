"""The interface of a policy, which decides in a participant's place which option to take and what to answer.

Eyes, memory, legs and hands remain those of the proxy. A language model, a policy learnt from logs or a rule of thumb
chooses among options that are described to it, and answers messages.
"""

from typing import Literal, Protocol

from msgspec import Struct

Answer = Literal["accept", "decline", "ignore"]


class OptionDescription(Struct, frozen=True, kw_only=True):
    """One thing that a participant could do next while searching.

    Attributes:
        name: unique among the options of a situation, such as "Bed|1" or "door Door|2".
        text: the option in words, such as "search the bed, 3 m away".
        verb: "search" a place or "pass" a doorway.
        kind: the kind of furniture, empty for a doorway.
        knowledge: probability by common knowledge alone that the object is at this place, before any search, 0 to 1;
            for a doorway, an equal part of the probability that remains for everything behind doorways.
        uniform: the same probability for a person without common knowledge.
        metres: walking distance [m]. seconds: time to go there and search it [s].
        exposure: how thoroughly the place was searched already, after forgetting.
        closed: whether the place must be opened first.
        value: how good the option is by the proxy's own law; larger is better.
    """

    name: str
    text: str
    verb: Literal["search", "pass"]
    kind: str
    knowledge: float
    uniform: float
    metres: float
    seconds: float
    exposure: float
    closed: bool
    value: float


class Situation(Struct, frozen=True, kw_only=True):
    """What a participant knows when choosing where to search next.

    Attributes:
        instruction: the task in words.
        aim: what is searched for, "target" or "destination".
        number: counts the choices of a trial, from 0.
        left: time until the trial ends [s].
        room: name of the current room.
        holding: id of the object in hand, empty for none.
        options: what the participant could do next; never empty.
    """

    instruction: str
    aim: str
    number: int
    left: float
    room: str
    holding: str
    options: tuple[OptionDescription, ...]


class Offer(Struct, frozen=True, kw_only=True):
    """A message as a participant sees it after reading it.

    Attributes:
        number: counts the messages read in a trial, from 1.
        trust: mean trust, 0 to 1.
        useful: whether following it could still help.
        gain: time that following it is expected to save [s], never negative.
        load: work in hand, 0 to 1.
        again: how often the same offer was refused before.
        metres: walking distance to the place that it names [m], None when it names none.
        instruction: the task in words.
    """

    text: str
    object: str
    sender: str
    number: int
    trust: float
    useful: bool
    gain: float
    load: float
    again: int
    metres: float | None = None
    instruction: str = ""


class Policy(Protocol):
    """Decides in a participant's place."""

    def choose(self, situation: Situation) -> int:
        """Index in ``situation.options`` of the option to take."""
        ...

    def answer(self, offer: Offer) -> Answer:
        """The answer to a message that was read."""
        ...
