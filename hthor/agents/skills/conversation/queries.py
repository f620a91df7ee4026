"""Questions of a robot about its last suggestion: whether it was accepted, and later whether the object was found."""

import msgspec

from hthor.agents.skills.message_timing import AGAIN_S, kind_title
from hthor.types import Briefing, Receipt, Send

UNANSWERED_S = 12.0
"""[s] How long after a suggestion was shown a robot asks whether it was accepted; our choice: most people have read it
and answered after half of that."""
UNFOUND_S = 25.0
"""[s] How long after a suggestion was accepted a robot asks whether the object was found; our choice."""


class Queries:
    """Asks at most once about each status of each suggestion, and takes the answer for an answer to the suggestion.

    After a yes the suggestion counts as accepted, and the robot stays quiet. After a no it counts as declined long ago,
    so that the robot looks again and repeats it, unless it has repeated it often enough.
    """

    def __init__(self, briefing: Briefing) -> None:
        self._tick_s = briefing.tick_s
        self._asked: set[tuple[int, str]] = set()

    def due(self, tick: int, suggestion: Send, kind: str, receipt: Receipt) -> Send | None:
        """The question that is due about a ``suggestion`` with this ``receipt``, on an object of this ``kind``."""
        patience = {"shown": UNANSWERED_S, "accepted": UNFOUND_S}.get(receipt.status)
        key = (receipt.message, receipt.status)
        if patience is None or key in self._asked or tick < receipt.tick + patience / self._tick_s:
            return None
        self._asked.add(key)
        title = kind_title(kind)
        text = f"Have you found {title}?"
        if receipt.status == "shown":
            text = f"Did you accept my suggestion about {title}?"
        return Send(text=text, object=suggestion.object, to=receipt.by, question=True)

    def updated(self, suggestion: Receipt, answer: Receipt) -> Receipt:
        """The receipt of a suggestion once the question about it was answered."""
        if answer.status != "answered" or answer.yes is None:
            return suggestion
        if answer.yes:
            return msgspec.structs.replace(suggestion, status="accepted", tick=answer.tick)
        again = round(AGAIN_S / self._tick_s)
        return msgspec.structs.replace(suggestion, status="declined", tick=answer.tick - again)
