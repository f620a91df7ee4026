"""Repeats what a participant did with stick, head, hands and buttons, from the inputs in the journal; decides nothing.

    hthor eval --agent frontier --suite smoke --humans recorded:runs/live-frontier

With the robots, seed and suite of that run, the trials go as they went: the same events, byte for byte, unless a robot
decides differently than it did. It is meant for that: to see a trial again, from any side, or to check a log. The
inputs are repeated at their steps whatever happens. A person who shall get along with another robot is `replay`, which
repeats paths instead. After the end of the log the person stands still. The rating is the logged rating.

Only people who drive their body (`hthor.types.Drive`), as live people do, have inputs in their journal.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hthor.errors import HthorError
from hthor.humans.core.recorded_inputs import RecordedInputs
from hthor.humans.models import _logged_trials
from hthor.humans.models._logged_trials import LoggedParticipant, LoggedTrial
from hthor.humans.population.participant import Participant
from hthor.types import Action, Briefing, Controls, Observation, Wait, is_person
from hthor.types.events import JournalEntry

ingredients = _logged_trials.ingredients


class Model:
    """A participant whose inputs were recorded.

    Args:
        participant: its number selects the participant of the log.
        state: the number of trials done.
        source: the run folder or log.
    """

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None, source: str = "") -> None:
        self._trials = int(state["trials"]) if state else 0
        self._participant, self._source = participant, source
        self._logged = LoggedParticipant("recorded", participant.number, source)
        self._again: RecordedInputs | None = None

    def begin(self, briefing: Briefing) -> None:
        """Look up the task in the log.

        Raises:
            HthorError: when the log has no such task of this participant.
        """
        self._again, self._has_robots = None, not all(is_person(seat) for seat in briefing.teammates)
        self._logged.begin(briefing)

    def frame(self, controls: Controls) -> None:
        """Do what the participant did in this step.

        Raises:
            HthorError: in the first step, when the log has no inputs of this trial.
        """
        if self._again is None:
            self._trial = self._logged.find(controls.observe().pose, self._trials)
            self._again = self._inputs(self._trial)
        self._again.frame(controls)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002  everything is done in `frame`
        """Never called; stands still."""
        return Action(motion=Wait())

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the log has the answer
        """The logged rating."""
        self._trials += 1
        return self._trial.rating if self._again is not None and self._has_robots else None

    def state(self) -> dict[str, Any]:
        """The number of trials done."""
        return {"trials": self._trials}

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """The entries of the logged journal that a human model wrote."""
        return self._again.own_journal if self._again is not None else ()

    def _inputs(self, trial: LoggedTrial) -> RecordedInputs:
        inputs = RecordedInputs(trial.seat, trial.events, trial.journal, trial.ticks)
        if not inputs.found:
            raise HthorError(
                f"{self._source}, trial {trial.key} ({trial.spec.task.id}): its journal has no inputs of "
                f"'{trial.seat}', as only people have who drive their body. Repeat it with --humans replay:RUN."
            )
        return inputs
