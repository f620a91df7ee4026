"""What went on in a person's mind in a logged trial: played again, with somebody listening; draws nothing.

The log has no thoughts. But a person's session repeats itself to the byte, so the trials up to the one in question are
simulated once more, and in that one the person is listened to. Listening changes nothing, which is checked: the record
of the trial that was played again must equal the logged one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor import activity, code_identity
from hthor.errors import HthorError
from hthor.eval.config.sessions import Session
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import session_history
from hthor.eval.runner import trial_runner
from hthor.guest import AgentInputs
from hthor.types import HUMAN, Action, Briefing, Event, Observation

SCHEMA = "hthor.mind/1"
_JOURNAL = ("attempt", "exposure", "offer")


class HumanTrace(Struct, frozen=True, kw_only=True):
    """What was thought in one trial, as `docs/logs.md` lists it, and the numbers of who thought it.

    ``same`` says whether the trial went as it was logged.
    """

    schema: str = SCHEMA
    key: str
    same: bool
    traits: dict[str, float]
    events: tuple[Event, ...]


class TracedHuman:
    """A human model of which somebody listens to the thoughts, in the trials that begin while ``listening``."""

    def __init__(self, human: Any) -> None:
        self.human, self.listening = human, False
        self.thoughts: list[Event] = []
        self._aim: object = None
        self._trust: float | None = None

    def begin(self, briefing: Briefing) -> None:
        self.human.listener = self.thoughts.append if self.listening else None
        self.human.begin(briefing)

    def act(self, observation: Observation) -> Action:
        action: Action = self.human.act(observation)
        if self.listening:
            self._look_in(observation.tick)
        return action

    def rate(self, met: bool, tick: int) -> int | None:
        rating: int | None = self.human.rate(met, tick)
        if self.listening:
            self._look_in(tick)
        return rating

    def state(self) -> Mapping[str, Any]:
        state: Mapping[str, Any] = self.human.state()
        return state

    @property
    def journal(self) -> Sequence[Event]:
        """As the model has it."""
        return tuple(getattr(self.human, "journal", ()))

    def _look_in(self, tick: int) -> None:
        """What the person is about, and how far they trust, whenever it changes."""
        aim, trust = self.human.about, self.human.trust.mean
        if aim != self._aim:
            self._aim = aim
            self._tell(tick, "aim", about=aim)
        if trust != self._trust:
            self._trust = trust
            self._tell(tick, "trust", mean=round(trust, 4))

    def _tell(self, tick: int, kind: str, **data: Any) -> None:
        self.thoughts.append(Event(tick=tick, seat=HUMAN, kind=kind, data=data))


def trace_human(
    folder: Path, wanted: TrialRecord, *, agents: Sequence[str] = (), humans: str = "", given: AgentInputs | None = None
) -> HumanTrace:
    """Play a trial of a run again and listen.

    Args:
        folder: the run's. wanted: the trial.
        agents: files of the run's agents that are not built in. humans: where its people come from, when the name in
            the log does not find them. given: arguments and files that the agents were given.

    Raises:
        RunError: when trials before it are missing, or another version of hthor played them.
        HthorError: when a file is needed, or the person is one whose mind cannot be looked into.
    """
    code_identity.keep_compiled()
    spec = wanted.spec
    session = Session(participant=spec.participant, trials=session_history.session_before(folder, wanted))
    stage = trial_runner.TrialRunner(session_history.replay_sources(folder, spec, agents, humans, given))
    with stage.enter(session) as company:
        company.human = person = TracedHuman(company.human)
        if not all(hasattr(type(person.human), name) for name in ("about", "listener")):
            raise HthorError(
                f"the people of this run, '{spec.human}', have no mind to look into. --mind takes runs whose people "
                "are the proxy, or a model made of it."
            )
        for number, trial in enumerate(session.trials, 1):
            activity.say(f"playing trial {number} of {len(session.trials)} again")
            person.listening = trial == spec
            done = stage.play(company, trial)
        traits = {name: getattr(person.human.traits, name) for name in person.human.traits.__struct_fields__}
    return _stream(wanted, done, person.thoughts, traits)


def _stream(wanted: TrialRecord, done: TrialRecord, thoughts: Sequence[Event], traits: dict[str, float]) -> HumanTrace:
    written = [event for event in done.journal if event.kind in _JOURNAL]
    said = [event for event in done.events if event.kind in ("shown", "confirmed", "declined", "covered")]
    events = sorted([*thoughts, *written, *said], key=lambda event: event.tick)
    same = trial_record.encode(done) == trial_record.encode(wanted)
    return HumanTrace(key=wanted.key, same=same, traits=traits, events=tuple(events))
