"""What became of the robots' messages, and how good they were as a channel."""

from __future__ import annotations

from hthor import rules
from hthor.comms import claims
from hthor.episode import EpisodeLog
from hthor.eval.metrics.metric import HIGHER, LOWER, SECONDS, SHARE, SHARES, Metric, Trial
from hthor.types import HUMAN, Event

_OUTCOMES = ("confirmed", "declined", "covered")


def adoption(trial: Trial) -> int:
    """1 when the human accepted at least one robot message, else 0 (P)."""
    return int(bool(_accepted(trial.log) & _robot_messages(trial.log)))


def sent(trial: Trial) -> int:
    """Messages of all robots."""
    return len(_sent(trial.log))


def accepted(trial: Trial) -> int:
    """Messages that the human accepted."""
    return _outcome(trial.log, "confirmed")


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
    """Seconds until a robot sent the first true claim that the human accepted; only trials with one."""
    accepted = _true_claims(trial.log) & _accepted(trial.log)
    ticks = [event.tick for event in _sent(trial.log) if event.data.get("message") in accepted]
    return min(ticks) * rules.TICK_S if ticks else None


def interruptions(trial: Trial) -> float | None:
    """Robots' messages that came up before the human's eyes, a minute."""
    robots = _robot_messages(trial.log)
    shown = sum(event.kind == "shown" and event.data.get("message") in robots for event in trial.log.events)
    return shown / (trial.log.ticks * rules.TICK_S / 60.0) if trial.log.ticks else None


def useful(trial: Trial) -> int:
    """Accepted messages that were true when they were sent and new to the human, whom they could still help."""
    new = {
        event.data.get("message") for event in trial.log.journal if event.kind == "offer" and event.data.get("useful")
    }
    return len(_true_claims(trial.log) & _accepted(trial.log) & new)


def usefulness(trial: Trial) -> float | None:
    """Share of the accepted messages that were `useful`; only trials with an accepted one."""
    accepted = len(_accepted(trial.log) & _robot_messages(trial.log))
    return useful(trial) / accepted if accepted else None


def _sent(log: EpisodeLog) -> list[Event]:
    """The messages of robots."""
    return [event for event in log.events if event.kind == "sent" and event.seat != HUMAN]


def _robot_messages(log: EpisodeLog) -> set[object]:
    """The numbers of the robots' messages."""
    return {event.data.get("message") for event in _sent(log)}


def _accepted(log: EpisodeLog) -> set[object]:
    return {event.data.get("message") for event in log.events if event.kind == "confirmed"}


def _outcome(log: EpisodeLog, kind: str) -> int:
    """How many of the robots' messages ended with an event of this kind."""
    return len({event.data.get("message") for event in log.events if event.kind == kind} & _robot_messages(log))


def _claims(log: EpisodeLog) -> list[Event]:
    """The messages that claim where a thing is; where bodies are does not count."""
    return [event for event in _sent(log) if "off" in event.data and event.data.get("object") not in log.paths]


def _true_claims(log: EpisodeLog) -> set[object]:
    return {event.data.get("message") for event in _claims(log) if not claims.is_false(event.data)}


METRICS = (
    Metric(
        name="adoption",
        title="adoption",
        formula=adoption,
        unit=SHARE,
        better=HIGHER,
        rank=40,
        main=True,
        section="messages",
        needs_robot=True,
        bounds=SHARES,
    ),
    *(
        Metric(
            name=name,
            title=title,
            formula=formula,
            rank=rank,
            decimals=2,
            section="messages",
            part_of=part_of,
            needs_robot=True,
        )
        for rank, name, title, formula, part_of in (
            (210, "sent", "messages sent, a trial", sent, ""),
            (220, "accepted", "accepted", accepted, "sent"),
            (230, "declined", "declined", declined, "sent"),
            (240, "covered", "covered by a newer one", covered, "sent"),
            (250, "unanswered", "unanswered", unanswered, "sent"),
        )
    ),
    Metric(
        name="false_claims",
        title="messages that were false, a trial",
        formula=false_claims,
        decimals=2,
        better=LOWER,
        rank=260,
        section="messages",
        needs_robot=True,
    ),
    Metric(
        name="precision",
        title="true among the claims",
        formula=precision,
        unit=SHARE,
        better=HIGHER,
        rank=270,
        section="messages",
        needs_robot=True,
        bounds=SHARES,
    ),
    Metric(
        name="first_useful_s",
        title="first useful message after",
        short="first useful message",
        formula=first_useful,
        unit=SECONDS,
        better=LOWER,
        rank=280,
        section="messages",
        needs_robot=True,
        timed=True,
    ),
    Metric(
        name="interruptions_per_min",
        title="messages shown, a minute",
        short="interruptions a minute",
        formula=interruptions,
        decimals=2,
        rank=290,
        section="messages",
        needs_robot=True,
    ),
    Metric(
        name="useful",
        title="accepted messages that were true and new, a trial",
        formula=useful,
        decimals=2,
        better=HIGHER,
        rank=300,
        section="messages",
        needs_robot=True,
    ),
    Metric(
        name="usefulness",
        title="true and new among the accepted",
        formula=usefulness,
        unit=SHARE,
        better=HIGHER,
        rank=310,
        section="messages",
        needs_robot=True,
        bounds=SHARES,
    ),
)
