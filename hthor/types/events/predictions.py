"""What robots say that a person believes and will do next, and what the person believed and did."""

from msgspec import field

from hthor.types.events.entry import LogEntry


class Predicted(LogEntry, frozen=True, kw_only=True, tag="predicted"):
    """The robot in the seat told the system what it thinks of a person's mind; nobody heard it.

    Attributes:
        person: the person's seat.
        object: id of the object that ``places`` is about, empty for none.
        places: the probability, 0 to 1, that the person expects the object at each place, by the furniture's id; what
            is missing to 1 is for all other places.
        next: the probability, 0 to 1, of each activity that the person may be busy with, such as "search" or
            "fetch apple".
    """

    person: str
    object: str = ""
    places: dict[str, float] = field(default_factory=dict)
    next: dict[str, float] = field(default_factory=dict)


class Believed(LogEntry, frozen=True, kw_only=True, tag="believed"):
    """What a simulated person had in mind when a robot predicted it (`Predicted`).

    Attributes:
        object: id of the object that the robot named, empty for none.
        places: the probability, 0 to 1, that the person gave to each place, by the furniture's id or by the seat of
            whoever holds the object; what is missing to 1 was for places not yet seen.
        next: the person's activity: "begin", "search", "follow", "rest", or "fetch", "haul" or "deliver" with an
            object's id.
    """

    object: str = ""
    places: dict[str, float] = field(default_factory=dict)
    next: str = ""
