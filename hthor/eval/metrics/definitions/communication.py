"""Metrics of the robots' messages: their outcomes, and how good they were as a channel.

A suggestion is a message of a robot that is neither a question nor the answer to one. It counts once, however many
people it is for, with the best of its ends: accepted by anybody, else declined, else covered, else unanswered.
"""

import functools
import statistics

from msgspec import UNSET

from hthor import rules
from hthor.comms import claims
from hthor.episode.recording.episode_log import EpisodeLog
from hthor.eval.metrics.metric import HIGHER, LOWER, SECONDS, SHARE, Metric, Trial
from hthor.types import is_person
from hthor.types.events import Accepted, AdoptionJudged, Covered, Declined, Offer, Sent, Shown

_End = Accepted | Declined | Covered
_ENDS: tuple[type[_End], ...] = (Accepted, Declined, Covered)
"""The ends of a suggestion, the best first."""


def adoption(trial: Trial) -> float | None:
    """1 when the human accepted at least one robot message, else 0 (P); with several people, the share who did.

    An event `adoption_judged`, which a correction adds, replaces what the log says, or leaves the person out.
    """
    shares = adoption_by_person(trial)
    return statistics.mean(map(int, shares.values())) if shares else None


def adoption_by_person(trial: Trial) -> dict[str, float]:
    """1 for each person who accepted at least one robot message, else 0; only with several people."""
    suggestions, answers = _suggestions(trial.log), _answers(trial.log, Accepted)
    accepting = {seat for seat, message in answers if message in suggestions}
    found: dict[str, bool | None] = {seat: seat in accepting for seat in trial.people}
    found |= {event.seat: event.adopted for event in trial.log.events if isinstance(event, AdoptionJudged)}
    return {seat: float(adopted) for seat, adopted in found.items() if adopted is not None}


def sent(trial: Trial) -> int:
    """Messages of all robots; questions and answers do not count."""
    return len(_suggestions(trial.log))


def accepted(trial: Trial) -> int:
    """Messages that the human accepted; with several people, that any of them accepted."""
    return len(_ended(trial.log, Accepted))


def declined(trial: Trial) -> int:
    """Messages that the human declined; with several people, that some declined and nobody accepted."""
    return len(_ended(trial.log, Declined))


def covered(trial: Trial) -> int:
    """Messages that a newer one covered before anybody had answered."""
    return len(_ended(trial.log, Covered))


def unanswered(trial: Trial) -> int:
    """Messages that were open when the trial ended."""
    return len(_suggestions(trial.log)) - sum(len(_ended(trial.log, kind)) for kind in _ENDS)


def false_claims(trial: Trial) -> int:
    """Messages that were wrong when they were sent."""
    return sum(claims.is_false(message) for message in _statements(trial.log))


def precision(trial: Trial) -> float | None:
    """Share of the robots' claims that were true when they were made (at most 1 m off); only trials with a claim.

    What a robot says about where it, another robot or a person is, is not counted as a claim.
    """
    made = _claims(trial.log)
    return sum(not claims.is_false(message) for message in made) / len(made) if made else None


def first_useful(trial: Trial) -> float | None:
    """Seconds until a robot sent the first true claim that a person accepted; only trials with such a claim."""
    accepted = _true_claims(trial.log) & _ended(trial.log, Accepted)
    ticks = [message.tick for message in _statements(trial.log) if message.message in accepted]
    return min(ticks) * rules.TICK_S if ticks else None


def interruptions(trial: Trial) -> float | None:
    """Robots' messages that were shown to the human, per minute; with several people, the mean of theirs.

    An answer to a person's question does not count.
    """
    messages = {message.message for message in _sent(trial.log) if message.answers is None}
    shown = sum(message in messages for _, message in _shown(trial.log))
    minutes = trial.log.ticks * rules.TICK_S / 60.0
    return shown / len(trial.people) / minutes if trial.log.ticks else None


def useful(trial: Trial) -> int:
    """Accepted messages that were true when sent, new to a person who accepted them, and could still help."""
    new = {(entry.seat, entry.message) for entry in trial.log.journal if isinstance(entry, Offer) and entry.useful}
    taken = {message for seat, message in _answers(trial.log, Accepted) if (seat, message) in new}
    return len(taken & _true_claims(trial.log) & set(_suggestions(trial.log)))


def usefulness(trial: Trial) -> float | None:
    """Share of the accepted messages that were `useful`; only trials with an accepted message."""
    accepted = len(_ended(trial.log, Accepted))
    return useful(trial) / accepted if accepted else None


def _sent(log: EpisodeLog) -> list[Sent]:
    """The messages that robots sent."""
    return [event for event in log.events if isinstance(event, Sent) and not is_person(event.seat)]


def _statements(log: EpisodeLog) -> list[Sent]:
    """The messages in which robots said something: all but questions."""
    return [message for message in _sent(log) if not message.question]


def _suggestions(log: EpisodeLog) -> dict[int, Sent]:
    """The robots' suggestions, by number."""
    return {message.message: message for message in _statements(log) if message.answers is None}


def _answers(log: EpisodeLog, kind: type[_End]) -> set[tuple[str, int]]:
    """Who ended which message by an event of this kind; a message is covered by its sender or another."""
    return {(event.seat, event.message) for event in log.events if isinstance(event, kind)}


def _shown(log: EpisodeLog) -> list[tuple[str, int]]:
    """Who was shown which message."""
    return [(event.seat, event.message) for event in log.events if isinstance(event, Shown)]


def _ended(log: EpisodeLog, kind: type[_End]) -> set[int]:
    """The suggestions that ended with an event of this kind, and for nobody with a better one."""
    better = {message for end in _ENDS[: _ENDS.index(kind)] for _, message in _answers(log, end)}
    return ({message for _, message in _answers(log, kind)} - better) & set(_suggestions(log))


def _claims(log: EpisodeLog) -> list[Sent]:
    """The messages that claim where a thing is; claims about bodies do not count."""
    return [message for message in _statements(log) if message.off is not UNSET and message.object not in log.paths]


def _true_claims(log: EpisodeLog) -> set[int]:
    return {message.message for message in _claims(log) if not claims.is_false(message)}


_message = functools.partial(Metric, section="messages", needs_robot=True)

METRICS = (
    _message("adoption", "adoption", adoption, unit=SHARE, better=HIGHER, rank=40, main=True),
    _message(
        "adoption_by", "adoption", adoption_by_person, unit=SHARE, better=HIGHER, rank=920, by_seat=True, several=True
    ),
    _message("sent", "messages sent, a trial", sent, decimals=2, rank=210),
    _message("accepted", "accepted", accepted, decimals=2, rank=220, part_of="sent"),
    _message("declined", "declined", declined, decimals=2, rank=230, part_of="sent"),
    _message("covered", "covered by a newer one", covered, decimals=2, rank=240, part_of="sent"),
    _message("unanswered", "unanswered", unanswered, decimals=2, rank=250, part_of="sent"),
    _message("false_claims", "messages that were false, a trial", false_claims, decimals=2, better=LOWER, rank=260),
    _message("precision", "true among the claims", precision, unit=SHARE, better=HIGHER, rank=270),
    _message(
        "first_useful_s",
        "first useful message after",
        first_useful,
        short="first useful message",
        unit=SECONDS,
        better=LOWER,
        rank=280,
        timed=True,
    ),
    _message(
        "interruptions_per_min",
        "messages shown, a minute",
        interruptions,
        "interruptions a minute",
        decimals=2,
        rank=290,
    ),
    _message(
        "useful", "accepted messages that were true and new, a trial", useful, decimals=2, better=HIGHER, rank=300
    ),
    _message("usefulness", "true and new among the accepted", usefulness, unit=SHARE, better=HIGHER, rank=310),
)
