"""What one person did and saw in a session, from its log: nothing of what others did out of their sight."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import Struct

from hthor import rules
from hthor.comms.claims import is_false
from hthor.episode import EpisodeLog
from hthor.eval.records.trial_record import TrialRecord
from hthor.types import HouseSpec, Vec3, is_person
from hthor.types.events import Accepted, Answered, Declined, LogEntry, Picked, Placed, Sent, Shown, Success


class OwnMessage(Struct, frozen=True, kw_only=True):
    """A message that the person saw, and what they did with it.

    Attributes:
        sender: the seat that sent it. text: its words. place: [m] the place that it named, if any.
        shown_s: [s] when the person saw it first. answer: accepted, declined, answered, or empty for none.
        answer_s: [s] from then to the answer; None without one.
        wrong: whether what it said of a place was wrong; None where it said nothing of one.
        found_s: [s] from the confirmation until the person had, or had found, what it was about; None if they did not.
    """

    sender: str
    text: str
    place: Vec3 | None
    shown_s: float
    answer: str = ""
    answer_s: float | None = None
    wrong: bool | None = None
    found_s: float | None = None


class OwnTrial(Struct, frozen=True, kw_only=True):
    """One trial of a person.

    Attributes:
        record: the whole trial, of which only the person's own path is drawn. seat: the person's.
        number: of the trial in the session, from 1. instruction: the task in words.
        met: whether the goal was met. seconds: how long it took. rating: their trust after it, 1 to 7.
        messages: those that the person saw. robots: what robots did with things themselves, in words.
    """

    record: TrialRecord
    house: HouseSpec
    seat: str
    number: int
    instruction: str
    met: bool
    seconds: float
    rating: int | None
    messages: tuple[OwnMessage, ...]
    robots: tuple[str, ...]


class OwnSession(Struct, frozen=True, kw_only=True):
    """All trials of a person that count, in order; ``voided`` is how many did not count."""

    participant: int
    trials: tuple[OwnTrial, ...]
    voided: int = 0

    @property
    def messages(self) -> tuple[OwnMessage, ...]:
        """All messages that the person saw."""
        return tuple(message for trial in self.trials for message in trial.messages)

    @property
    def has_robots(self) -> bool:
        """Whether there was a robot in any trial."""
        return any(trial.record.spec.robots for trial in self.trials)


def own_trial(record: TrialRecord, house: HouseSpec, seat: str) -> OwnTrial:
    """A trial from the side of the person in a seat."""
    return OwnTrial(
        record=record,
        house=house,
        seat=seat,
        number=record.spec.index + 1,
        instruction=record.spec.task.instruction,
        met=record.met,
        seconds=round(record.ticks * rules.TICK_S, 1),
        rating=record.ratings.get(seat),
        messages=tuple(_messages(record.log, seat)),
        robots=tuple(_robots(record.log, house)),
    )


def _messages(log: EpisodeLog, seat: str) -> list[OwnMessage]:
    sent = {event.message: event for event in log.events if isinstance(event, Sent)}
    own = [event for event in log.events if event.seat == seat]
    found = []
    for shown in own:
        if not isinstance(shown, Shown) or shown.message not in sent:
            continue
        message = sent[shown.message]
        answer = _answer(own, shown.message)
        accepted = isinstance(answer, Accepted)
        found.append(
            OwnMessage(
                sender=message.seat,
                text=message.text,
                place=message.position,
                shown_s=_seconds(shown.tick),
                answer="" if answer is None else answer.kind,
                answer_s=None if answer is None else _seconds(answer.tick - shown.tick),
                wrong=None if message.position is None else is_false(message),
                found_s=_found(log, seat, message.object, answer.tick) if accepted and answer is not None else None,
            )
        )
    return found


def _answer(own: Sequence[LogEntry], message: int) -> Accepted | Declined | Answered | None:
    kinds = (Accepted, Declined, Answered)
    return next((event for event in own if isinstance(event, kinds) and event.message == message), None)


def _found(log: EpisodeLog, seat: str, name: str, since: int) -> float | None:
    """[s] From a confirmation until the person picked the thing up, put something on or in it, or found it."""
    for event in log.events:
        if event.tick < since or event.seat != seat:
            continue
        if isinstance(event, Picked) and _is(event.object, name):
            return _seconds(event.tick - since)
        if isinstance(event, Placed) and _is(event.on, name):
            return _seconds(event.tick - since)
        if isinstance(event, Success) and not any(isinstance(one, Picked) for one in log.events):
            return _seconds(event.tick - since)
    return None


def _is(name: str, said: str) -> bool:
    """Whether a thing is the one that a message named, by its id or its kind."""
    return bool(said) and (name == said or name.startswith(f"{said}_") or name.rstrip("0123456789_") == said)


def _robots(log: EpisodeLog, house: HouseSpec) -> list[str]:
    """What robots brought where."""
    kinds = {thing.id: thing.kind for thing in house.things}
    return [
        f"After {_seconds(event.tick):.0f} s the {event.seat} put the {plain(event.object)} on or in the "
        f"{plain(kinds.get(event.on, event.on))}."
        for event in log.events
        if isinstance(event, Placed) and not is_person(event.seat)
    ]


def plain(name: str) -> str:
    """An id or a kind as a person would say it."""
    return name.rstrip("0123456789_").replace("_", " ")


def _seconds(ticks: int) -> float:
    return round(ticks * rules.TICK_S, 1)
