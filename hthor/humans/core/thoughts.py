"""What a simulated participant believed and decided, for `hthor replay --mind`; no log has it."""

from msgspec import Struct

from hthor.humans.core.policy import Answer
from hthor.types.events import LogEntry
from hthor.types.house import Vec3


class Aim(LogEntry, frozen=True, kw_only=True, tag="aim"):
    """The participant turned to something else.

    Attributes:
        about: begin, tour, search, fetch, deliver, follow or rest, with the object's kind where there is one.
    """

    about: str


class Noticed(LogEntry, frozen=True, kw_only=True, tag="noticed"):
    """An object or a piece of furniture was noticed.

    Attributes:
        object: its id. position: [m], house frame, where it is.
    """

    object: str
    position: Vec3


class Forgot(LogEntry, frozen=True, kw_only=True, tag="forgot"):
    """An object or a piece of furniture was forgotten.

    Attributes:
        object: its id. position: [m], house frame, where an object had been seen.
    """

    object: str
    position: Vec3 | None = None


class PlaceBelief(Struct, frozen=True, kw_only=True):
    """What is believed of one known place.

    Attributes:
        id: the furniture's id. kind: its kind.
        belief: probability, 0 to 1, that the object is there, before the place was searched.
        exposure: how thoroughly it was searched, after forgetting.
    """

    id: str
    kind: str
    belief: float
    exposure: float


class Beliefs(LogEntry, frozen=True, kw_only=True, tag="beliefs"):
    """Where the participant believed an object to be when they chose where to search.

    Attributes:
        aim: what is searched for: "target", "destination" or "room".
        ahead: probability, 0 to 1, that it is behind doorways not yet passed.
        places: every place that the participant knows.
    """

    aim: str
    ahead: float
    places: tuple[PlaceBelief, ...]


class RankedOptions(LogEntry, frozen=True, kw_only=True, tag="choice"):
    """The options of a choice, the best first.

    Attributes:
        aim: what is searched for: "target", "destination" or "room".
        options: their names. values: how good each is by the proxy's law. metres: [m] the path to each.
        chosen: the name of the chosen one.
    """

    aim: str
    options: tuple[str, ...]
    values: tuple[float, ...]
    metres: tuple[float, ...]
    chosen: str


class Weighed(LogEntry, frozen=True, kw_only=True, tag="weighed"):
    """How the participant came to the answer to a message.

    Attributes:
        number: counts the messages read in the trial, from 1, as in the journal's `Offer`.
        terms: the terms of the logit of accepting, by name. share: the probability of accepting, 0 to 1.
        relevant: whether the message was about the task. slipped: whether the wrong button was pressed.
        answer: the answer.
    """

    number: int
    terms: dict[str, float]
    share: float
    relevant: bool
    slipped: bool
    answer: Answer


class TrustNow(LogEntry, frozen=True, kw_only=True, tag="trust"):
    """Trust in the robots has changed.

    Attributes:
        mean: mean trust, 0 to 1.
    """

    mean: float


HumanThought = Aim | Noticed | Forgot | Beliefs | RankedOptions | Weighed | TrustNow
"""One event of a participant's mind."""
