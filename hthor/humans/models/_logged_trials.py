"""The trials of a participant in a run's log, as `replay` and `recorded` need them: paths, looks, actions, words."""

import hashlib
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from hthor import documents, log_corrections, rules
from hthor.errors import HthorError
from hthor.humans.population.participant import Participant
from hthor.log_corrections import Corrections
from hthor.log_format import LineDecoder, Logged, OtherVersion
from hthor.types import HUMAN, Briefing, Close, Drop, Motion, Open, Pick, Place, Pose, Send, Show, TrialSpec, is_person
from hthor.types.events import (
    Accepted,
    Answered,
    Attempt,
    Closed,
    Declined,
    Displayed,
    Dropped,
    Event,
    Head,
    Held,
    JournalEntry,
    Lowered,
    Opened,
    PhaseBegan,
    Picked,
    Placed,
    Released,
    SaidReady,
    Sent,
    Stick,
    Voided,
)

_START_M = 0.002
"""[m] Distance within which a trial begins at a logged pose. Our choice: poses are logged to a millimetre."""
_MILLI = 1000.0
"""[1/unit] Poses and pitches are logged in thousandths. Source: docs/files.md."""
_NONE = Corrections()
_HINT = "Give a run folder or its trials.jsonl, as in --humans replay:runs/oracle-paper-seed0."


class LoggedTrial(Logged, frozen=True, kw_only=True):
    """One trial of a log and the ``seat`` of the participant in it; other fields of its line are ignored."""

    seat: str = HUMAN
    key: str = ""
    spec: TrialSpec
    ticks: int
    ratings: dict[str, int | None]
    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    journal: tuple[JournalEntry, ...] = ()

    def is_of(self, briefing: Briefing) -> bool:
        """Whether this trial has the task of the briefing."""
        task = self.spec.task
        words = (briefing.instruction, briefing.target, briefing.relation, briefing.time_limit)
        logged = (task.instruction, task.goal.target, task.goal.relation, task.time_limit)
        if words[:2] + words[3:] != logged[:2] + logged[3:] or len(briefing.phases) != len(task.phases):
            return False
        if task.phases:  # what people have to remember is not in the briefing
            return [job.target for job in briefing.todo] == [job.target for job in task.goal.todo]
        return words == logged and briefing.todo == task.goal.todo

    def phase_began(self, name: str) -> int:
        """The tick at which the phase of this name began; empty for the task itself."""
        ticks = [event.tick for event in self.events if isinstance(event, PhaseBegan) and event.name == name]
        return ticks[0] if ticks else self.ticks

    def said_ready(self) -> tuple[int, ...]:
        """The ticks at which the participant was ready for the next phase."""
        return tuple(event.tick for event in self.events if isinstance(event, SaidReady) and event.seat == self.seat)

    def begins_at(self, pose: Pose) -> bool:
        """Whether the participant stood at ``pose`` when this trial began."""
        x, y, _ = self.paths[self.seat][0]
        return math.dist((x / _MILLI, y / _MILLI), (pose.x, pose.y)) < _START_M

    def hand_actions(self) -> Iterator[tuple[int, Motion]]:
        """The actions of the hands, each with the tick at which it took effect."""
        for event in self.events:
            motion = _hand_action(event) if event.seat == self.seat else None
            if motion is not None:
                yield event.tick, _where(motion, event.tick, self._own_journal)

    def utterances(self) -> Iterator[tuple[int, bool | Send]]:
        """What the participant said, with its tick: True for an accepted message or a yes, False for a no, or words."""
        for event in self.events:
            said = _utterance(event) if event.seat == self.seat else None
            if said is not None:
                yield event.tick, said

    def display_changes(self) -> Iterator[tuple[int, Show]]:
        """What the participant showed and hid on their display, with its tick."""
        for event in self.events:
            if isinstance(event, Displayed) and event.seat == self.seat:
                yield event.tick, Show(what=event.what, on=event.on)

    @property
    def rating(self) -> int | None:
        """The participant's rating of the robots."""
        return self.ratings[self.seat]

    @property
    def _own_journal(self) -> tuple[JournalEntry, ...]:
        return tuple(entry for entry in self.journal if entry.seat == self.seat)

    def poses(self) -> list[Pose]:
        """Pose of the head, every `rules.LOG_EVERY_TICKS` ticks."""
        pitch = self._pitch()
        return [
            Pose(x=x / _MILLI, y=y / _MILLI, yaw=yaw / _MILLI, pitch=pitch(k * rules.LOG_EVERY_TICKS))
            for k, (x, y, yaw) in enumerate(self.paths[self.seat])
        ]

    def moving(self) -> Callable[[int], bool | None]:
        """Whether the stick was pushed at a tick; None if the log does not say."""
        runs = next((entry.runs for entry in self._own_journal if isinstance(entry, Stick)), None)
        if runs is None:
            return lambda _: None
        value = _steps(runs)
        return lambda tick: value(tick) > 0

    def _pitch(self) -> Callable[[int], float]:
        runs = next((entry.pitch for entry in self._own_journal if isinstance(entry, Head)), (0, 0))
        value = _steps(runs)
        return lambda tick: value(tick) / _MILLI


class LoggedModel:
    """A human model that repeats the trials of a participant of a log, found again one by one.

    A subclass says what ``name`` it has on the command line.

    Args:
        participant: its number selects the participant of the log.
        state: the number of trials done.
        source: the run folder or log.

    Attributes:
        trial: the logged trial that is repeated; None before `find`.

    Raises:
        HthorError: when there is no such log, or no such participant in it.
    """

    name: str

    def __init__(self, participant: Participant, state: Mapping[str, Any] | None = None, source: str = "") -> None:
        if not source:
            raise HthorError(
                f"{self.name} needs the run to repeat: --humans {self.name}:RUN, a run folder or its trials.jsonl."
            )
        logged = read_logged_trials(source)
        if participant.number not in logged:
            raise HthorError(
                f"{source} has no participant {participant.number}; it holds {', '.join(map(str, sorted(logged)))}. "
                "Evaluate with that run's suite, seed and number of participants."
            )
        self.participant, self.source = participant, source
        self.trial: LoggedTrial | None = None
        self._logged = logged[participant.number]
        self._done = int(state["trials"]) if state else 0

    def begin(self, briefing: Briefing) -> None:
        """Look up the task in the log.

        Raises:
            HthorError: when the log has no such task of this participant.
        """
        self._briefing, self.trial = briefing, None
        self._fitting = [one for one in self._logged if one.is_of(briefing)]
        if not self._fitting:
            raise self._unknown()

    def find(self, start: Pose) -> LoggedTrial:
        """The trial with this task from this start, by preference the one with the same place in its session.

        Raises:
            HthorError: when the participant did no such task from there.
        """
        here = [one for one in self._fitting if one.begins_at(start)]
        if not here:
            raise self._unknown()
        self.trial = next((one for one in here if one.spec.index == self._done), here[0])
        return self.trial

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the log has the answer
        """The logged rating; None without a robot."""
        self._done += 1
        has_robots = not all(is_person(seat) for seat in self._briefing.teammates)
        return self.trial.rating if self.trial is not None and has_robots else None

    def state(self) -> dict[str, Any]:
        """The number of trials done."""
        return {"trials": self._done}

    def _unknown(self) -> HthorError:
        trials = ", ".join(f"{one.spec.index}: {one.spec.task.id}" for one in self._logged)
        return HthorError(
            f"{self.source}: participant {self.participant.number} did no such task as '{self._briefing.instruction}' "
            f"from this place; their trials are {trials}. Only the trials of that log can be repeated: evaluate with "
            "that run's suite, seed and number of participants."
        )


def read_logged_trials(source: str) -> dict[int, list[LoggedTrial]]:
    """The trials of each participant in a run folder or a log.

    Raises:
        HthorError: when there is no such log, or it cannot be read.
    """
    path = _log(source)
    return _read(str(path), log_corrections.beside(path))


def ingredients(source: str = "") -> dict[str, str]:
    """Everything that decides how people from a log behave: the log's bytes, and the corrections of its trials."""
    return {"log_sha256": _log_sha256(source)} if source else {}


def _log_sha256(source: str) -> str:
    path = _log(source)
    corrections = log_corrections.beside(path)
    return hashlib.sha256(_bytes(path) + "".join(corrections.hashes[-1:]).encode()).hexdigest()


def _log(source: str) -> Path:
    path = Path(source)
    return path / log_corrections.LOG_NAME if path.is_dir() else path


@cache
def _read(path: str, known: Corrections = _NONE) -> dict[int, list[LoggedTrial]]:
    decoder, skipped = LineDecoder(LoggedTrial), Counter[str]()
    trials: dict[int, list[LoggedTrial]] = {}
    for number, line in enumerate(_bytes(Path(path)).splitlines(keepends=True), 1):
        if not line.endswith(b"\n"):
            break  # the run was stopped while it wrote this line
        try:
            trial = decoder.decode(line, skipped)
        except OtherVersion as other:
            raise HthorError(other.sentence(Path(path))) from None
        except documents.Unreadable as error:
            raise HthorError(f"{path}, line {number}: {error}. {_HINT}") from None
        corrected = log_corrections.corrected_events(trial.events, trial.ticks, known.of(trial.key))
        trial = msgspec.structs.replace(trial, events=corrected)
        for human in trial.spec.humans:
            own = msgspec.structs.replace(trial, seat=human.seat)
            trials.setdefault(human.participant, []).append(own)
    trials = {number: _counting(own) for number, own in trials.items()}
    if not any(trials.values()):
        raise HthorError(f"{path} has no complete trial. {_HINT}")
    return {number: sorted(own, key=lambda trial: trial.spec.index) for number, own in trials.items()}


def _counting(own: list[LoggedTrial]) -> list[LoggedTrial]:
    """The trials that count: of each the last attempt that was not voided."""
    valid = [trial for trial in own if not (trial.events and isinstance(trial.events[-1], Voided))]
    last = {trial.spec.index: trial for trial in sorted(valid, key=lambda trial: trial.spec.attempt or 0)}
    return list(last.values())


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise HthorError(f"there is no log to replay at {path}: {error.strerror}. {_HINT}") from None


def _utterance(event: Event) -> bool | Send | None:
    """What an event says that the participant said."""
    if isinstance(event, (Accepted, Declined)):
        return isinstance(event, Accepted)
    if isinstance(event, Answered):
        return event.yes  # None if words follow
    if not isinstance(event, Sent):
        return None
    return Send(
        text=event.text,
        object=event.object,
        position=event.position,
        to=event.to,
        question=event.question,
        answers=event.answers,
    )


def _hand_action(event: Event) -> Motion | None:
    """The motion of the hands that led to an event; None for other events."""
    match event:
        case Picked() | Held():
            return Pick(object=event.object)
        case Placed():
            return Place(on=event.on)
        case Dropped() | Lowered() | Released():
            return Drop()
        case Opened():
            return Open(thing=event.thing)
        case Closed():
            return Close(thing=event.thing)
        case _:
            return None


def _where(motion: Motion, tick: int, journal: tuple[JournalEntry, ...]) -> Motion:
    """The same motion; if the journal has the exact position of something put down, with that position."""
    if not isinstance(motion, Place):
        return motion
    tried = [entry for entry in journal if isinstance(entry, Attempt) and entry.what == "place" and entry.tick <= tick]
    at = tried[-1].at if tried else None
    return motion if at is None else Place(on=motion.on, position=at)


def _steps(runs: Sequence[int]) -> Callable[[int], int]:
    """A step function from flat pairs of a tick and the value from then on."""
    ticks, values = runs[::2], runs[1::2]
    place = 0

    def value(tick: int) -> int:
        nonlocal place
        if ticks and ticks[min(place, len(ticks) - 1)] > tick:
            place = 0
        while place + 1 < len(ticks) and ticks[place + 1] <= tick:
            place += 1
        return values[place] if values and ticks[place] <= tick else 0

    return value
