"""Metrics of the robots' messages: their outcomes, and how good they were as a channel."""

import functools

from hthor import rules
from hthor.comms import claims
from hthor.episode import EpisodeLog
from hthor.eval.metrics.metric import HIGHER, LOWER, SECONDS, SHARE, Metric, Trial
from hthor.types import HUMAN, Event

_OUTCOMES = ("accepted", "declined", "covered")


def adoption(trial: Trial) -> int:
    """1 when the human accepted at least one robot message, else 0 (P)."""
    return int(bool(_accepted(trial.log) & _robot_messages(trial.log)))


def sent(trial: Trial) -> int:
    """Messages of all robots."""
    return len(_sent(trial.log))


def accepted(trial: Trial) -> int:
    """Messages that the human accepted."""
    return _outcome(trial.log, "accepted")


def declined(trial: Trial) -> int:
    """Messages that the human declined."""
    return _outcome(trial.log, "declined")


def covered(trial: Trial) -> int:
    """Messages that a newer one covered before the human had answered."""
    return _outcome(trial.log, "covered")


def unanswered(trial: Trial) -> int:
    """Messages that were open when the trial ended."""
    return len(_sent(trial.log)) - sum(_outcome(trial.log, kind) for kind in _OUTCOMES)


def false_claims(trial: Trial) -> int:
    """Messages that were wrong when they were sent."""
    return sum(claims.is_false(event.data) for event in _sent(trial.log))


def precision(trial: Trial) -> float | None:
    """Share of the robots' claims that were true when they were made (at most 1 m off); only trials with a claim.

    What a robot says about where it, another robot or the human is, is not counted as a claim.
    """
    made = _claims(trial.log)
    return sum(not claims.is_false(event.data) for event in made) / len(made) if made else None


def first_useful(trial: Trial) -> float | None:
    """Seconds until a robot sent the first true claim that the human accepted; only trials with such a claim."""
    accepted = _true_claims(trial.log) & _accepted(trial.log)
    ticks = [event.tick for event in _sent(trial.log) if event.data.get("message") in accepted]
    return min(ticks) * rules.TICK_S if ticks else None


def interruptions(trial: Trial) -> float | None:
    """Robots' messages that were shown to the human, per minute."""
    robots = _robot_messages(trial.log)
    shown = sum(event.kind == "shown" and event.data.get("message") in robots for event in trial.log.events)
    return shown / (trial.log.ticks * rules.TICK_S / 60.0) if trial.log.ticks else None


def useful(trial: Trial) -> int:
    """Accepted messages that were true when they were sent and new to the human and could still help."""
    new = {
        event.data.get("message") for event in trial.log.journal if event.kind == "offer" and event.data.get("useful")
    }
    return len(_true_claims(trial.log) & _accepted(trial.log) & new)


def usefulness(trial: Trial) -> float | None:
    """Share of the accepted messages that were `useful`; only trials with an accepted message."""
    accepted = len(_accepted(trial.log) & _robot_messages(trial.log))
    return useful(trial) / accepted if accepted else None


def _sent(log: EpisodeLog) -> list[Event]:
    """The events that robots sent messages."""
    return [event for event in log.events if event.kind == "sent" and event.seat != HUMAN]


def _robot_messages(log: EpisodeLog) -> set[object]:
    """The numbers of the robots' messages."""
    return {event.data.get("message") for event in _sent(log)}


def _accepted(log: EpisodeLog) -> set[object]:
    return {event.data.get("message") for event in log.events if event.kind == "accepted"}


def _outcome(log: EpisodeLog, kind: str) -> int:
    """How many of the robots' messages ended with an event of this kind."""
    return len({event.data.get("message") for event in log.events if event.kind == kind} & _robot_messages(log))


def _claims(log: EpisodeLog) -> list[Event]:
    """The messages that claim where a thing is; claims about bodies do not count."""
    return [event for event in _sent(log) if "off" in event.data and event.data.get("object") not in log.paths]


def _true_claims(log: EpisodeLog) -> set[object]:
    return {event.data.get("message") for event in _claims(log) if not claims.is_false(event.data)}


_message = functools.partial(Metric, section="messages", needs_robot=True)

METRICS = (
    _message("adoption", "adoption", adoption, unit=SHARE, better=HIGHER, rank=40, main=True),
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
