"""When a participant who searches in vain asks where something is, and which robot."""

from collections.abc import Sequence

from hthor.types import Observation, Send, is_person

PATIENCE_S = 20.0
"""[s] How long people search, without a message to read, before they ask and before they ask again. Our choice."""
_MOST_UNANSWERED = 2
"""[count] Questions without an answer after which people stop asking. Our choice."""


class Asking:
    """Decides what to ask in one trial.

    Args:
        teammates: everybody else. The only robot is asked; several robots, or none, are asked together with all people.
    """

    def __init__(self, teammates: Sequence[str], tick_s: float) -> None:
        robots = [seat for seat in teammates if not is_person(seat)]
        self._to = robots[0] if len(robots) == 1 else ""
        self._patience = round(PATIENCE_S / tick_s)
        self._unanswered = 0 if teammates else _MOST_UNANSWERED
        self._name, self._since = "", 0
        self._has_asked = False

    def postpone(self, tick: int) -> None:
        """Begin to wait again, because there is something to read or to say."""
        self._since = tick

    def question(self, now: Observation, name: str, kind: str) -> Send | None:
        """The question that is due.

        Args:
            name: of the thing that is searched for now, an id or a kind; empty while nothing is searched for.
            kind: its kind.
        """
        if name != self._name:
            self._name, self._since = name, now.tick
        if not name or now.tick < self._since + self._patience or self._unanswered >= _MOST_UNANSWERED:
            return None
        if self._has_asked and (now.receipt is None or now.receipt.status != "answered"):
            self._unanswered += 1
            if self._unanswered >= _MOST_UNANSWERED:
                return None
        self._since, self._has_asked = now.tick, True
        return Send(text=f"Where is the {kind.replace('_', ' ')}?", object=name, to=self._to, question=True)
