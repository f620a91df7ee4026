"""Signals: what a seat tells the system. They take no time, and other seats do not hear them."""

from typing import Literal

from msgspec import Struct

from hthor.types.house import HUMAN


class Show(Struct, tag="show", frozen=True, kw_only=True):
    """A person shows or hides a part of their display; ``what`` is shown if ``on``, else hidden."""

    what: Literal["panel", "map"]
    on: bool = True


class Ready(Struct, tag="ready", frozen=True, kw_only=True):
    """The seat is ready for the next phase of the task."""


class Predict(Struct, tag="predict", frozen=True, kw_only=True):
    """What a robot thinks of a person's mind; nobody hears it, and nothing depends on it but two metrics.

    Attributes:
        person: the person's seat. object: id of the object that ``places`` is about, empty for none.
        places: the probability, 0 to 1, that the person expects the object at each place, by the furniture's id; what
            is missing to 1 is for all other places.
        next: the probability, 0 to 1, of each activity that the person may be busy with: "begin" (looking round),
            "search", "follow" (a message), "rest", or "fetch", "haul" or "deliver" and an object's id.
    """

    person: str = HUMAN
    object: str = ""
    places: dict[str, float] = {}
    next: dict[str, float] = {}


class Adapt(Struct, tag="adapt", frozen=True, kw_only=True):
    """A robot has changed its own policy during the trial; nothing depends on it but two metrics.

    Attributes:
        divergence: [nats] how far the change has moved the policy, as the divergence (Kullback-Leibler) of its next
            action's probabilities from those that it would have had without any change in this trial.
    """

    divergence: float


Signal = Show | Ready | Predict | Adapt
