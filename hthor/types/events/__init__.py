"""Events of a trial's log, one class for each kind; docs/logs.md lists them with their fields.

`Event` is what the log's ``events`` may have, `JournalEntry` what its ``journal`` may have. Code that reads a log asks
for a class: ``isinstance(event, Sent)``.
"""

from hthor.types.events.bodies import (
    Blocked,
    Closed,
    Dropped,
    Held,
    InWay,
    Lifted,
    Lowered,
    Opened,
    Picked,
    Placed,
    Refused,
    Released,
)
from hthor.types.events.entry import LogEntry
from hthor.types.events.journal import (
    Acted,
    Asked,
    Attempt,
    Choice,
    Exposure,
    ExposureRow,
    Head,
    Inputs,
    Misled,
    Note,
    Offer,
    OptionRow,
    Replied,
    Stick,
)
from hthor.types.events.messages import Accepted, Answered, Covered, Declined, Displayed, MessageEvent, Sent, Shown
from hthor.types.events.predictions import Believed, Predicted
from hthor.types.events.trial import (
    Adapted,
    AdoptionJudged,
    AgentFault,
    Paused,
    PhaseBegan,
    Progress,
    Resumed,
    SaidReady,
    Success,
    Thought,
    Timeout,
    Voided,
)

Event = (
    Sent
    | Shown
    | Accepted
    | Declined
    | Covered
    | Answered
    | Displayed
    | Picked
    | Placed
    | Dropped
    | Opened
    | Closed
    | Held
    | Lifted
    | Lowered
    | Released
    | Blocked
    | InWay
    | Refused
    | Predicted
    | Adapted
    | Thought
    | Progress
    | PhaseBegan
    | SaidReady
    | AgentFault
    | Paused
    | Resumed
    | AdoptionJudged
    | Voided
    | Success
    | Timeout
)
"""An event of the trial."""
JournalEntry = (
    Stick | Head | Inputs | Acted | Attempt | Exposure | Choice | Offer | Misled | Asked | Replied | Believed | Note
)
"""An entry of the journal."""

__all__ = [
    "Accepted",
    "Acted",
    "Adapted",
    "AdoptionJudged",
    "AgentFault",
    "Answered",
    "Asked",
    "Attempt",
    "Believed",
    "Blocked",
    "Choice",
    "Closed",
    "Covered",
    "Declined",
    "Displayed",
    "Dropped",
    "Event",
    "Exposure",
    "ExposureRow",
    "Head",
    "Held",
    "InWay",
    "Inputs",
    "JournalEntry",
    "Lifted",
    "LogEntry",
    "Lowered",
    "MessageEvent",
    "Misled",
    "Note",
    "Offer",
    "Opened",
    "OptionRow",
    "Paused",
    "PhaseBegan",
    "Picked",
    "Placed",
    "Predicted",
    "Progress",
    "Refused",
    "Released",
    "Replied",
    "Resumed",
    "SaidReady",
    "Sent",
    "Shown",
    "Stick",
    "Success",
    "Thought",
    "Timeout",
    "Voided",
]
