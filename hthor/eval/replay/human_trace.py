"""Finds out the human model's thoughts in a logged trial, for `hthor replay --mind`.

The log has no thoughts. But sessions are deterministic, so the trials up to the one in question are simulated again,
and in that one the model reports its thoughts. Reporting changes nothing, which is checked: the record of the trial
must equal the logged one.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from msgspec import Struct

from hthor import activity, code_identity
from hthor.errors import HthorError, UnknownName
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import session_history
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner import session_runner
from hthor.guest import AgentInputs, GuestConfig
from hthor.humans.core.thoughts import Aim, HumanThought, TrustNow
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session
from hthor.types import Action, Briefing, HumanSeat, Observation, TrialSpec
from hthor.types.events import (
    Accepted,
    Answered,
    Attempt,
    Covered,
    Declined,
    Exposure,
    JournalEntry,
    MessageEvent,
    Offer,
    Shown,
)

SCHEMA = "hthor.mind/2"
_JOURNAL = (Attempt, Exposure, Offer)
_MESSAGES = (Shown, Accepted, Declined, Answered, Covered)
TraceEvent = HumanThought | Attempt | Exposure | Offer | Shown | Accepted | Declined | Answered | Covered
"""An event of a trace."""


class HumanTrace(Struct, frozen=True, kw_only=True):
    """The thoughts of one person in a trial, as docs/logs.md lists them, and the participant's parameters.

    ``seat`` is the person's; ``same`` says whether the trial went as logged.
    """

    schema: str = SCHEMA
    key: str
    seat: str
    same: bool
    traits: dict[str, float]
    events: tuple[TraceEvent, ...]


class TracedHuman:
    """A human model whose thoughts are recorded in the trials that begin while ``recording``."""

    def __init__(self, seat: str, human: Any) -> None:
        self.seat, self.human, self.recording = seat, human, False
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

    def record_belief(self, tick: int, object: str) -> None:
        """Let the model record its belief, if it can."""
        if (tell := getattr(self.human, "record_belief", None)) is not None:
            tell(tick, object)

    @property
    def journal(self) -> Sequence[JournalEntry]:
        """The model's journal of this trial."""
        return tuple(getattr(self.human, "journal", ()))

    def _record_state(self, tick: int) -> None:
        """Record the person's goal and their trust whenever they change."""
        goal, trust = self.human.about, self.human.trust.mean
        if goal != self._goal:
            self._goal = goal
            self.thoughts.append(Aim(tick=tick, seat=self.seat, about=goal))
        if trust != self._trust:
            self._trust = trust
            self.thoughts.append(TrustNow(tick=tick, seat=self.seat, mean=round(trust, 4)))


def trace_human(
    folder: RunFolder, trial: TrialRecord, files: RunFiles, *, seat: str = "", inputs: AgentInputs | None = None
) -> HumanTrace:
    """Run a trial of a run again and record the thoughts of the person in a seat, by default the first one.

    Raises:
        UnknownName: when nobody sits there.
        RunError: when trials before it are missing, or another version of hthor ran them.
        HthorError: when a file of the user's is missing, or the human model does not report its thoughts.
    """
    code_identity.keep_compiled()
    spec = trial.spec
    human = _person(spec, seat)
    session = Session(number=spec.session, trials=session_history.session_before(folder, trial))
    guests = GuestConfig(hidden=(str(folder.path.resolve()),), inputs=inputs or AgentInputs())
    runner = TrialRunner(session_history.replay_sources(folder, spec, files, guests))
    with runner.enter(session) as participants:
        participants.humans[human.seat] = person = TracedHuman(human.seat, participants.humans[human.seat])
        if not all(hasattr(type(person.human), name) for name in ("about", "listener")):
            raise HthorError(
                f"the people of this run, '{human.model}', record no decisions. --mind works with runs whose "
                "people are the proxy, or a model based on it."
            )
        for number, one in enumerate(session.trials, 1):
            activity.say(f"playing trial {number} of {len(session.trials)} again")
            person.recording = one == spec
            record = session_runner.run_trial(runner, participants, one).record
        traits = {name: getattr(person.human.traits, name) for name in person.human.traits.__struct_fields__}
    journal = [entry for entry in record.journal if isinstance(entry, _JOURNAL) and entry.seat == human.seat]
    messages = [event for event in record.events if isinstance(event, _MESSAGES) and _reader(event) in ("", human.seat)]
    events: list[TraceEvent] = sorted([*person.thoughts, *journal, *messages], key=lambda event: event.tick)
    same = trial_record.encode(folder.corrected(record)) == trial_record.encode(trial)
    return HumanTrace(key=trial.key, seat=human.seat, same=same, traits=traits, events=tuple(events))


def _person(spec: TrialSpec, seat: str) -> HumanSeat:
    people = {human.seat: human for human in spec.humans}
    if seat and seat not in people:
        raise UnknownName("person", seat, people)
    return people[seat] if seat else spec.humans[0]


def _reader(event: MessageEvent) -> str:
    """The seat whose panel an event of a message is about; empty for a covered message where there is one panel."""
    return event.reader if isinstance(event, Covered) else event.seat
