"""Repeats what a participant did with stick, head, hands and buttons, from the inputs in the journal; decides nothing.

    hthor eval --agent frontier --suite smoke --humans recorded:runs/live-frontier

With the seed and suite of that run, and robots that decide as they did, the trials go as they went: the same events,
byte for byte. It is meant for that: to see a trial again, from any side, or to check a log. The inputs are repeated at
their steps whatever happens; `replay`, which repeats paths instead, gets along with another robot. After the end of the
log the person stands still. The rating is the logged rating.

Only people who drive their body (`hthor.types.Drive`), as live people do, have inputs in their journal.
"""

from __future__ import annotations

from hthor.errors import HthorError
from hthor.humans.core.recorded_inputs import RecordedInputs
from hthor.humans.models import _logged_trials
from hthor.humans.models._logged_trials import LoggedModel, LoggedTrial
from hthor.types import Action, Briefing, Controls, Observation, Wait
from hthor.types.events import JournalEntry

ingredients = _logged_trials.ingredients


class Model(LoggedModel):
    """A participant whose inputs were recorded."""

    name = "recorded"
    _again: RecordedInputs | None = None

    def begin(self, briefing: Briefing) -> None:
        """Look up the task in the log; errors as in `LoggedModel.begin`."""
        self._again = None
        super().begin(briefing)

    def frame(self, controls: Controls) -> None:
        """Do what the participant did in this step.

        Raises:
            HthorError: in the first step, when the log has no inputs of this trial.
        """
        if self._again is None:
            self._again = self._inputs(self.find(controls.observe().pose))
        self._again.frame(controls)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002  everything is done in `frame`
        """Never called; stands still."""
        return Action(motion=Wait())

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """The entries of the logged journal that a human model wrote."""
        return self._again.own_journal if self._again is not None else ()

    def _inputs(self, trial: LoggedTrial) -> RecordedInputs:
        inputs = RecordedInputs(trial.seat, trial.events, trial.journal, trial.ticks)
        if not inputs.found:
            raise HthorError(
                f"{self.source}, trial {trial.key} ({trial.spec.task.id}): its journal has no inputs of "
                f"'{trial.seat}', as only people have who drive their body. Repeat it with --humans replay:RUN."
            )
        return inputs
