"""How good a robot's messages were as a channel: pure functions of a trial's log; knows nothing of success."""

from __future__ import annotations

from hthor import rules
from hthor.comms import claims
from hthor.episode import EpisodeLog
from hthor.types import HUMAN, Event


def sent(log: EpisodeLog) -> list[Event]:
    """The messages of robots."""
    return [event for event in log.events if event.kind == "sent" and event.seat != HUMAN]


def precision(log: EpisodeLog) -> float | None:
    """Share of the claims that were true when they were made; None where nothing was claimed."""
    claimed = [event for event in sent(log) if "off" in event.data]
    if not claimed:
        return None
    return sum(not claims.is_false(event.data) for event in claimed) / len(claimed)


def first_useful_s(log: EpisodeLog) -> float | None:
    """Seconds until a robot sent the first message that was true and that the person confirmed; None without one."""
    confirmed = {event.data.get("message") for event in log.events if event.kind == "confirmed"}
    useful = [
        event.tick
        for event in sent(log)
        if event.data.get("message") in confirmed and "off" in event.data and not claims.is_false(event.data)
    ]
    return min(useful) * rules.TICK_S if useful else None


def interruptions_per_min(log: EpisodeLog) -> float | None:
    """How often a minute a robot's message came up before the person's eyes; None for a trial of no length."""
    robots = {event.data.get("message") for event in sent(log)}
    shown = sum(event.kind == "shown" and event.data.get("message") in robots for event in log.events)
    return shown / (log.ticks * rules.TICK_S / 60.0) if log.ticks else None
