"""What people's displays showed and what everybody held in a trial, as it follows from the trial's events."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from hthor.comms.display import DisplayState
from hthor.types.events import Accepted, Answered, Declined, Dropped, Event, Held, Lowered, Picked, Placed, Released
from hthor.watch.recording import Screen

_ANSWERS = {Accepted: "confirmed", Declined: "declined", Answered: "answered"}
_LINGERS = 15
"""[ticks] So long the page shows what was answered to a message that is gone. Our choice."""


def screens(events: Sequence[Event], seat: str) -> tuple[Screen, ...]:
    """What the display of the person in a seat showed, from tick 0 on."""
    state, found = DisplayState(seat), [Screen(tick=0, panel=None, answer="", map=None)]
    answered: tuple[int, str, int] | None = None  # a message, what was answered to it, and until when that is shown
    for event in events:
        if answered is not None and event.tick >= answered[2]:
            _add(found, _screen(state, answered[2], None))
            answered = None
        state.update(event)
        if event.seat == seat and isinstance(event, Accepted | Declined | Answered):
            answered = event.message, _ANSWERS[type(event)], event.tick + _LINGERS
        _add(found, _screen(state, event.tick, answered))
    if answered is not None:
        _add(found, _screen(state, answered[2], None))
    return tuple(found)


def hands(events: Iterable[Event], seat: str) -> tuple[tuple[int, str], ...]:
    """What a seat had in hand, each with the tick from which on it had; empty for nothing."""
    found = [(0, "")]
    for event in events:
        if event.seat != seat:
            continue
        if isinstance(event, Picked | Held):
            found.append((event.tick, event.object))
        elif isinstance(event, Placed | Dropped | Released | Lowered):
            found.append((event.tick, ""))
    return tuple(found)


def _screen(state: DisplayState, tick: int, answered: tuple[int, str, int] | None) -> Screen:
    shown = state.message.message if state.message is not None and state.on["panel"] else None
    answer = ""
    if shown is None and answered is not None:
        shown, answer, _ = answered
    confirmed = tuple(one.message for one in state.confirmed) if state.on["map"] else None
    return Screen(tick=tick, panel=shown, answer=answer, map=confirmed)


def _add(found: list[Screen], screen: Screen) -> None:
    """Add a screen if it shows something else; of one tick only the last counts."""
    if found[-1].tick == screen.tick:
        found.pop()
    if not found or (found[-1].panel, found[-1].answer, found[-1].map) != (screen.panel, screen.answer, screen.map):
        found.append(screen)
