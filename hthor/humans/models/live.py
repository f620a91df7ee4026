"""A person who takes part themselves, through a page that they have open: `hthor live`.

The model only passes on what the person does; `hthor.live` connects it with their seat.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from hthor.errors import HthorError
from hthor.humans.population.participant import Participant
from hthor.types import Action, Briefing, Controls, Observation, Wait, is_person
from hthor.types.events import JournalEntry


class Port(Protocol):
    """Where a person's inputs come from; `hthor.live.seat.LiveSeat`."""

    def begin(self, briefing: Briefing) -> None:
        """A trial begins."""

    def frame(self, controls: Controls) -> None:
        """Do what the person does in this step."""

    def ask_rating(self) -> int | None:
        """The person's trust in the robots, 1 to 7; waits for it, and is None if they are gone."""

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """Entries for the journal of this trial."""


class Model:
    """A person at a page.

    Attributes:
        port: where their inputs come from.
    """

    alike = True

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None) -> None:
        self.participant, self._trials = participant, int(state["trials"]) if state else 0
        self.port: Port | None = None
        self._has_robots = False

    def begin(self, briefing: Briefing) -> None:
        """Brief the person.

        Raises:
            HthorError: when nobody can be there.
        """
        if self.port is None:
            raise HthorError(
                "'live' are people who take part themselves, and there is no page for them here: use 'hthor live' in "
                "place of 'hthor eval'."
            )
        self._has_robots = not all(is_person(seat) for seat in briefing.teammates)
        self.port.begin(briefing)

    def frame(self, controls: Controls) -> None:
        """Do what the person does."""
        assert self.port is not None
        self.port.frame(controls)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002  everything is done in `frame`
        """Never called; stands still."""
        return Action(motion=Wait())

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the person knows
        """Ask the person."""
        self._trials += 1
        return self.port.ask_rating() if self.port is not None and self._has_robots else None

    def state(self) -> dict[str, Any]:
        """The number of trials done."""
        return {"trials": self._trials}

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """What was noted about the trial."""
        return self.port.journal if self.port is not None else ()
