"""How good a robot's messages were as a channel: pure functions of a trial's log."""

from __future__ import annotations

from hthor import rules
from hthor.comms import claims
from hthor.episode import EpisodeLog
from hthor.types import HUMAN, Event


def sent(log: EpisodeLog) -> list[Event]:
    """The messages of robots."""
    return [event for event in log.events if event.kind == "sent" and event.seat != HUMAN]


def claimed(log: EpisodeLog) -> list[Event]:
    """The messages that claim where a thing is; where robots and the person are themselves counts for nothing."""
    return [event for event in sent(log) if "off" in event.data and event.data.get("object") not in log.paths]


def precision(log: EpisodeLog) -> float | None:
    """Share of the claims that were true when they were made; None where nothing was claimed."""
    made = claimed(log)
    if not made:
        return None
    return sum(not claims.is_false(event.data) for event in made) / len(made)


def useful(log: EpisodeLog) -> int:
    """How many confirmed messages were true and told the person what they did not know, as their journal has it."""
    new = {event.data.get("message") for event in log.journal if event.kind == "offer" and event.data.get("useful")}
    return len(_taken(log) & new)


def usefulness(log: EpisodeLog) -> float | None:
    """Share of the confirmed messages that were `useful`; None where none was confirmed."""
    robots = {event.data.get("message") for event in sent(log)}
    taken = len(_confirmed(log) & robots)
    return useful(log) / taken if taken else None


def _taken(log: EpisodeLog) -> set[object]:
    """The true claims that the person confirmed, by number."""
    true = {event.data.get("message") for event in claimed(log) if not claims.is_false(event.data)}
    return true & _confirmed(log)


def _confirmed(log: EpisodeLog) -> set[object]:
    return {event.data.get("message") for event in log.events if event.kind == "confirmed"}


def first_useful_s(log: EpisodeLog) -> float | None:
    """Seconds until a robot sent the first message that was true and that the person confirmed; None without one."""
    taken = _taken(log)
    when = [event.tick for event in sent(log) if event.data.get("message") in taken]
    return min(when) * rules.TICK_S if when else None


def interruptions_per_min(log: EpisodeLog) -> float | None:
    """How often a minute a robot's message came up before the person's eyes; None for a trial of no length."""
    robots = {event.data.get("message") for event in sent(log)}
    shown = sum(event.kind == "shown" and event.data.get("message") in robots for event in log.events)
    return shown / (log.ticks * rules.TICK_S / 60.0) if log.ticks else None
