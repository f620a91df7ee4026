"""Finds out the human model's thoughts in a logged trial, for `hthor replay --mind`.

The log has no thoughts. But sessions are deterministic, so the trials up to the one in question are simulated again,
and in that one the model reports its thoughts. Reporting changes nothing, which is checked: the record of the trial
must equal the logged one.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from msgspec import Struct

from hthor import activity, code_identity
from hthor.errors import HthorError
from hthor.eval.config.sessions import Session
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import session_history
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner.trial_runner import TrialRunner
from hthor.guest import AgentInputs, GuestConfig
from hthor.humans.core.thoughts import Aim, HumanThought, TrustNow
from hthor.types import HUMAN, Action, Briefing, Observation
from hthor.types.events import (
    Accepted,
    Answered,
    Attempt,
    Covered,
    Declined,
    Exposure,
    JournalEntry,
    Offer,
    Shown,
)

SCHEMA = "hthor.mind/2"
_JOURNAL = (Attempt, Exposure, Offer)
_MESSAGES = (Shown, Accepted, Declined, Answered, Covered)
TraceEvent = HumanThought | Attempt | Exposure | Offer | Shown | Accepted | Declined | Answered | Covered
"""An event of a trace."""


class HumanTrace(Struct, frozen=True, kw_only=True):
    """The thoughts of one trial, as docs/logs.md lists them, and the participant's parameters.

    ``same`` says whether the trial went as logged.
    """

    schema: str = SCHEMA
    key: str
    same: bool
    traits: dict[str, float]
    events: tuple[TraceEvent, ...]


class TracedHuman:
    """A human model whose thoughts are recorded in the trials that begin while ``recording``."""

    def __init__(self, human: Any) -> None:
        self.human, self.recording = human, False
        self.thoughts: list[HumanThought] = []
        self._goal: object = None
        self._trust: float | None = None

    def begin(self, briefing: Briefing) -> None:
        self.human.listener = self.thoughts.append if self.recording else None
        self.human.begin(briefing)

    def act(self, observation: Observation) -> Action:
        action: Action = self.human.act(observation)
        if self.recording:
            self._record_state(observation.tick)
        return action

    def rate(self, met: bool, tick: int) -> int | None:
        rating: int | None = self.human.rate(met, tick)
        if self.recording:
            self._record_state(tick)
        return rating

    def state(self) -> Mapping[str, Any]:
        state: Mapping[str, Any] = self.human.state()
        return state

    @property
    def journal(self) -> Sequence[JournalEntry]:
        """The model's journal of this trial."""
        return tuple(getattr(self.human, "journal", ()))

    def _record_state(self, tick: int) -> None:
        """Record the person's goal and their trust whenever they change."""
        goal, trust = self.human.about, self.human.trust.mean
        if goal != self._goal:
            self._goal = goal
            self.thoughts.append(Aim(tick=tick, seat=HUMAN, about=goal))
        if trust != self._trust:
            self._trust = trust
            self.thoughts.append(TrustNow(tick=tick, seat=HUMAN, mean=round(trust, 4)))


def trace_human(
    folder: RunFolder, trial: TrialRecord, files: RunFiles, *, inputs: AgentInputs | None = None
) -> HumanTrace:
    """Run a trial of a run again and record the human's thoughts.

    Raises:
        RunError: when trials before it are missing, or another version of hthor ran them.
        HthorError: when a file of the user's is missing, or the human model does not report its thoughts.
    """
    code_identity.keep_compiled()
    spec = trial.spec
    session = Session(number=spec.session, trials=session_history.session_before(folder, trial))
    guests = GuestConfig(hidden=(str(folder.path.resolve()),), inputs=inputs or AgentInputs())
    runner = TrialRunner(session_history.replay_sources(folder, spec, files, guests))
    with runner.enter(session) as participants:
        participants.humans[HUMAN] = person = TracedHuman(participants.humans[HUMAN])
        if not all(hasattr(type(person.human), name) for name in ("about", "listener")):
            raise HthorError(
                f"the people of this run, '{spec.humans[0].model}', record no decisions. --mind works with runs whose "
                "people are the proxy, or a model based on it."
            )
        for number, one in enumerate(session.trials, 1):
            activity.say(f"playing trial {number} of {len(session.trials)} again")
            person.recording = one == spec
            record = runner.run(participants, one).record
        traits = {name: getattr(person.human.traits, name) for name in person.human.traits.__struct_fields__}
    journal = [entry for entry in record.journal if isinstance(entry, _JOURNAL)]
    messages = [event for event in record.events if isinstance(event, _MESSAGES)]
    events: list[TraceEvent] = sorted([*person.thoughts, *journal, *messages], key=lambda event: event.tick)
    same = trial_record.encode(record) == trial_record.encode(trial)
    return HumanTrace(key=trial.key, same=same, traits=traits, events=tuple(events))
