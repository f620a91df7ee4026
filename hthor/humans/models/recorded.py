"""Repeats what a participant did with stick, head, hands and buttons, from the inputs in the journal; decides nothing.

    hthor eval --agent frontier --suite smoke --humans recorded:runs/live-frontier

With the robots, seed and suite of that run, the trials go as they went: the same events, byte for byte, unless a robot
decides differently than it did. It is meant for that: to see a trial again, from any side, or to check a log. The
inputs are repeated at their steps whatever happens. A person who shall get along with another robot is `replay`, which
repeats paths instead. After the end of the log the person stands still. The rating is the logged rating.

Only people who drive their body (`hthor.types.Drive`), as live people do, have inputs in their journal.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from hthor.errors import HthorError
from hthor.humans.core.behaviour_log import INPUT_UNIT
from hthor.humans.models import _logged_trials
from hthor.humans.models._logged_trials import LoggedParticipant, LoggedTrial
from hthor.humans.population.participant import Participant
from hthor.types import SUBTICKS, Action, Briefing, Controls, Drive, Observation, Wait, is_person
from hthor.types.events import Acted, Head, Inputs, JournalEntry, Shown, Stick

_OF_RECORDER = (Stick, Head, Inputs, Acted)
"""Entries that the episode writes into every journal by itself."""

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
            trial = self._logged.find(controls.observe().pose, self._trials)
            self._again = RecordedInputs(trial, self._source)
        self._again.frame(controls)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002  everything is done in `frame`
        """Never called; stands still."""
        return Action(motion=Wait())

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the log has the answer
        """The logged rating."""
        self._trials += 1
        return self._again.trial.rating if self._again is not None and self._has_robots else None

    def state(self) -> dict[str, Any]:
        """The number of trials done."""
        return {"trials": self._trials}

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """The entries of the logged journal that a human model wrote."""
        return self._again.own_journal if self._again is not None else ()


class RecordedInputs:
    """The inputs of one logged trial, step by step.

    Raises:
        HthorError: when its journal has none.
    """

    def __init__(self, trial: LoggedTrial, source: str) -> None:
        journal = [entry for entry in trial.journal if entry.seat == trial.seat]
        inputs = next((entry for entry in journal if isinstance(entry, Inputs)), None)
        if inputs is None:
            raise HthorError(
                f"{source}, trial {trial.key} ({trial.spec.task.id}): its journal has no inputs of '{trial.seat}', as "
                "only people have who drive their body. Repeat it with --humans replay:RUN."
            )
        self.trial = trial
        self.own_journal = tuple(entry for entry in journal if not isinstance(entry, _OF_RECORDER))
        self._steering = _steering(inputs.runs)
        actions = [entry for entry in journal if isinstance(entry, Acted)]
        self._actions: dict[int, list[Acted]] = {}  # by the number of the step, of all steps of the trial
        for entry in actions:
            self._actions.setdefault(SUBTICKS * entry.tick - entry.early, []).append(entry)
        self._observed = _ticks_of(trial, actions)
        self._seen: dict[int, Observation] = {}

    def frame(self, controls: Controls) -> None:
        """Do what was done in this step."""
        tick, step = controls.tick, controls.step
        if tick >= self.trial.ticks:
            if (tick, step) == (self.trial.ticks, 0):
                controls.submit(Action(motion=Wait()))
            return
        if step == 0 and tick in self._observed:
            self._seen[tick] = controls.observe()
        for acted in self._actions.get(SUBTICKS * tick + step, ()):
            action = Action(motion=acted.motion, say=acted.say, signals=acted.signals)
            controls.submit(action, self._seen[acted.seen] if isinstance(acted.seen, int) else None)
        for drive in self._steering.get((tick, step), ()):
            controls.steer(drive)


def _steering(runs: tuple[int, ...]) -> dict[tuple[int, int], list[Drive]]:
    """The set-points of an `Inputs`, which are groups of six numbers, by tick and step."""
    steering: dict[tuple[int, int], list[Drive]] = {}
    for first in range(0, len(runs), 6):
        tick, step, *numbers = runs[first : first + 6]
        forward, left, yaw, pitch = (number * INPUT_UNIT for number in numbers)
        steering.setdefault((tick, step), []).append(Drive(forward=forward, left=left, yaw=yaw, pitch=pitch))
    return steering


def _ticks_of(trial: LoggedTrial, actions: Iterable[Acted]) -> frozenset[int]:
    """The ticks at which the person must observe: to be shown a message, or because an action names what it saw."""
    shown = {event.tick for event in trial.events if isinstance(event, Shown) and event.seat == trial.seat}
    return frozenset(shown | {entry.seen for entry in actions if isinstance(entry.seen, int)})
