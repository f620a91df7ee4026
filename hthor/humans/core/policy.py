"""The seam where something else decides in a person's place: which option, what answer.

The person's eyes, memory, legs and hands go on as they are. A language model, a policy cloned from logs or a rule of
thumb only chooses among options that are described to it, and answers messages.
"""

from __future__ import annotations

from typing import Literal, Protocol

from msgspec import Struct

Answer = Literal["confirm", "decline", "ignore"]


class Choice(Struct, frozen=True, kw_only=True):
    """One thing that a person could do next while they look for something.

    Attributes:
        name: unique in its situation, such as "Bed|1" or "door Door|2".
        text: what a person would call it, such as "search the bed, 3 m away".
        verb: "search" a place or "pass" a doorway.
        kind: the kind of furniture, empty for a doorway.
        knowledge: share of common knowledge that the thing is at this very place, before anything was searched, 0 to 1;
            of a doorway what is left for everything behind doorways, in equal parts.
        uniform: the same share for somebody who knows nothing about where such things are.
        metres: way to walk [m]. seconds: what going there and searching it takes this person [s].
        exposure: how thoroughly it was searched already, faded.
        closed: whether it must be opened first.
        value: what the person's own law makes of it, larger is better.
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
    """What a person knows when they choose: what they are told to do, what for they search, and for how long.

    ``number`` counts the choices of a trial; ``aim`` is "target" or "destination"; ``left`` [s] is the time that is
    left; ``room`` the room's name; ``holding`` what is in hand; ``options`` are never empty.
    """

    instruction: str
    aim: str
    number: int
    left: float
    room: str
    holding: str
    options: tuple[Choice, ...]


class Offer(Struct, frozen=True, kw_only=True):
    """A message as the person who has read it sees it.

    ``trust`` is mean trust, 0 to 1; ``useful`` whether it could still help; ``gain`` [s] the time that following it is
    expected to save, never negative; ``load`` the work in hand, 0 to 1; ``again`` how often the same was refused;
    ``metres`` the way to the place that it names, None when it names none; ``instruction`` what the person has to do.
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
    """Decides in a person's place."""

    def choose(self, situation: Situation) -> int:
        """Index of the option to take."""
        ...

    def answer(self, offer: Offer) -> Answer:
        """What to say to a message that was read."""
        ...
