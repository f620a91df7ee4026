"""The display of each person: a panel with the newest message, and a map of where its sender is.

A new message opens the panel by itself and covers the one before; the answer hides the panel. Confirming a message
shows the map, on which its sender and the place that it names stay until the trial ends. Panel and map can be hidden
and shown again at any time (`hthor.types.Show`), the panel with its last message.

What a display shows follows from the trial's events alone, so a log tells it as exactly as the running trial does.
"""

from collections.abc import Iterable, Sequence
from typing import Literal

from hthor.types import Show
from hthor.types.events import Accepted, Answered, Declined, Displayed, Event, Refused, Sent, Shown

Part = Literal["panel", "map"]
Spans = dict[Part, list[tuple[int, int]]]
"""When each part was shown: the first tick of each span, and the tick at which it ended."""
PARTS: tuple[Part, ...] = ("panel", "map")


class DisplayState:
    """What one person's display shows after the events so far.

    Attributes:
        message: the message on the panel, shown or hidden; None before the first.
        confirmed: the messages behind the map, in the order of their confirmation. Of two that one sender sent about
            the same object, only the newer one is kept.
        on: whether panel and map are shown.
    """

    def __init__(self, seat: str) -> None:
        self.seat = seat
        self.message: Sent | None = None
        self.confirmed: tuple[Sent, ...] = ()
        self.on: dict[Part, bool] = {"panel": False, "map": False}
        self._sent: dict[int, Sent] = {}

    def update(self, event: Event) -> None:
        """Take the next event of the trial."""
        match event:
            case Sent():
                self._sent[event.message] = event
                if event.seat != self.seat and event.to in ("", self.seat):
                    self._open(event.message)
            case Shown() if event.seat == self.seat:
                self._open(event.message)
            case Accepted() | Declined() | Answered() if event.seat == self.seat:
                self._close(event.message)
                if isinstance(event, Accepted):
                    self._confirm(event.message)
            case Displayed() if event.seat == self.seat:
                self.on[event.what] = event.on

    def show(self, tick: int, show: Show) -> tuple[Event, ...]:
        """The event that a person's signal causes: none if nothing changes, "refused" if there is nothing to show."""
        what = show.what
        if what not in PARTS or not isinstance(show.on, bool):
            return (self._refused(tick, "a display has a panel and a map, which are on or not"),)
        newest = self.message if what == "panel" else self.confirmed[-1] if self.confirmed else None
        if newest is None:
            needed = "has come" if what == "panel" else "was confirmed"
            return (self._refused(tick, f"there is no {what} to show or hide: no message {needed} yet"),)
        if self.on[what] == show.on:
            return ()
        return (Displayed(tick=tick, seat=self.seat, what=what, on=show.on, message=newest.message),)

    def _open(self, number: int) -> None:
        """Show a message on the panel, unless it is there already."""
        if number in self._sent and (self.message is None or self.message.message != number):
            self.message, self.on["panel"] = self._sent[number], True

    def _close(self, number: int) -> None:
        if self.message is not None and self.message.message == number:
            self.on["panel"] = False

    def _confirm(self, number: int) -> None:
        new = self._sent.get(number)
        if new is not None:
            others = (one for one in self.confirmed if (one.seat, one.object) != (new.seat, new.object))
            self.confirmed, self.on["map"] = (*others, new), True

    def _refused(self, tick: int, reason: str) -> Refused:
        return Refused(tick=tick, seat=self.seat, reason=reason)


class Displays:
    """The displays of all ``people`` of a trial; ``events`` are the trial's, and may grow."""

    def __init__(self, people: Iterable[str], events: Sequence[Event]) -> None:
        self._events, self.people = events, tuple(people)
        self.reset()

    def reset(self) -> None:
        """Read the events from the first one again, because they were replaced."""
        self._read, self._states = 0, {seat: DisplayState(seat) for seat in self.people}

    def state(self, seat: str) -> DisplayState | None:
        """What the person's display shows now; None for a seat that has no display."""
        if self._read < len(self._events):
            for event in self._events[self._read :]:
                for state in self._states.values():
                    state.update(event)
            self._read = len(self._events)
        return self._states.get(seat)

    def show(self, tick: int, seat: str, show: Show) -> tuple[Event, ...]:
        """What a seat's signal causes, as `DisplayState.show`; a robot's is refused."""
        state = self.state(seat)
        if state is None:
            return (Refused(tick=tick, seat=seat, reason="only people have a panel and a map"),)
        return state.show(tick, show)


def state_at(events: Iterable[Event], seat: str, tick: int) -> DisplayState:
    """What a person's display showed at a tick of a logged trial."""
    state = DisplayState(seat)
    for event in events:
        if event.tick > tick:
            break
        state.update(event)
    return state


def shown_spans(events: Iterable[Event], seat: str, end: int) -> Spans:
    """When panel and map of a person were shown in a logged trial that ended at tick ``end``."""
    state = DisplayState(seat)
    spans: Spans = {"panel": [], "map": []}
    since: dict[Part, int | None] = {"panel": None, "map": None}
    for event in events:
        state.update(event)
        for part in PARTS:
            begun = since[part]
            if state.on[part] and begun is None:
                since[part] = event.tick
            elif not state.on[part] and begun is not None:
                spans[part].append((begun, event.tick))
                since[part] = None
    for part, begun in since.items():
        if begun is not None:
            spans[part].append((begun, end))
    return spans
