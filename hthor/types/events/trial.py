"""Events of the trial as a whole and of its clock."""

from hthor.types.events.entry import LogEntry


class Thought(LogEntry, frozen=True, kw_only=True, tag="thought"):
    """The seat's action took effect late, because deciding took time.

    Attributes:
        ticks: by how many ticks after the observation on which it was decided.
    """

    ticks: int


class Adapted(LogEntry, frozen=True, kw_only=True, tag="adapted"):
    """The robot in the seat told the system that it has changed its own policy.

    Attributes:
        divergence: [nats] how far that moved the policy, by what the robot says; see `hthor.types.Adapt`.
    """

    divergence: float


class Progress(LogEntry, frozen=True, kw_only=True, tag="progress"):
    """The share of the goal that is met has changed.

    Attributes:
        value: the share, 0 to 1.
    """

    value: float


class AgentFault(LogEntry, frozen=True, kw_only=True, tag="fault"):
    """The agent in the seat failed and takes no further part; the log's ``faults`` have its error.

    Attributes:
        fault: the kind of fault, such as "raised" or "timeout".
    """

    fault: str


class Paused(LogEntry, frozen=True, kw_only=True, tag="paused"):
    """The trial was paused; no tick passes until it is `Resumed`.

    Attributes:
        reason: why, empty for no reason given.
    """

    reason: str = ""


class Resumed(LogEntry, frozen=True, kw_only=True, tag="resumed"):
    """A paused trial went on."""


class Voided(LogEntry, frozen=True, kw_only=True, tag="voided"):
    """The trial was ended as void, and does not count; always the last event.

    Attributes:
        reason: why.
    """

    reason: str


class AdoptionJudged(LogEntry, frozen=True, kw_only=True, tag="adoption_judged"):
    """Somebody who knows better than the log said whether the person adopted a suggestion of a robot.

    Attributes:
        adopted: whether they did; None if it cannot be said, so that the trial has no adoption.
        reason: why.
    """

    adopted: bool | None
    reason: str


class PhaseBegan(LogEntry, frozen=True, kw_only=True, tag="phase_began"):
    """A phase of the task began; only in tasks with phases before the task itself.

    Attributes:
        name: the phase's name; empty for the task itself.
    """

    name: str = ""


class SaidReady(LogEntry, frozen=True, kw_only=True, tag="said_ready"):
    """The seat is ready for the next phase."""


class Success(LogEntry, frozen=True, kw_only=True, tag="success"):
    """The goal was met; always the last event. In a search the seat is that of the person who found the target."""


class Timeout(LogEntry, frozen=True, kw_only=True, tag="timeout"):
    """Time ran out before the goal was met; always the last event."""
