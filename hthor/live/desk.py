"""The experimenter's desk: what they see of a session, and what they do to it.

Two threads meet here, as in `hthor.live.seat`: the trial's thread shows the desk what happens, and the server's thread
gives the desk what the experimenter's page sends. Everything that a page shows follows from the trial that is going on
and from the run's log, so a page that is opened later shows the same.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from hthor.errors import HthorError
from hthor.live import desk_wire
from hthor.live.desk_wire import FromDesk, Person, PlayedTrial, ToDesk, Watch
from hthor.types.events import Progress, Thought

if TYPE_CHECKING:
    from hthor.episode import Episode
    from hthor.live.control import Pacer, SessionControl
    from hthor.live.seat import LiveSeat
    from hthor.types.events import Event

_EVERY_TICKS = 2
"""[ticks] How often the desk is shown where everybody is."""
_UNSHOWN = (Thought, Progress)
"""Events that are too many to read."""


class Book(Protocol):
    """The run's log, for the desk; `hthor.live.run_book.RunBook` implements it."""

    def played(self) -> tuple[PlayedTrial, ...]:
        """The trials that are over, with their corrections."""

    def correct(self, trial: str, seat: str, adopted: bool | None, reason: str) -> None:
        """Correct whether the person in a seat adopted a suggestion; HthorError when that cannot be."""


class DeskPage(Protocol):
    """The connection to an experimenter's page."""

    def send(self, message: ToDesk) -> None:
        """Send a message; returns at once, from any thread."""


class Desk:
    """The desk of one session; any number of pages may show it."""

    def __init__(self, control: SessionControl, seats: Mapping[str, LiveSeat], book: Book) -> None:
        self._control, self._seats, self._book = control, dict(seats), book
        self._lock = threading.Lock()
        self._pages: list[DeskPage] = []
        self._plan: desk_wire.Plan | None = None
        self._events: list[desk_wire.Happened] = []
        self._watch: Watch | None = None

    # ----------------------------------------------------------------------------------------- from the server's thread

    def join(self, page: DeskPage) -> None:
        """Show a page everything."""
        played = self._played()  # reads the log, for which the trial must not wait
        with self._lock:
            self._pages.append(page)
            for message in (self._plan, *self._events, self._watch, played):
                if message is not None:
                    page.send(message)

    def leave(self, page: DeskPage) -> None:
        """The page is gone."""
        with self._lock:
            if page in self._pages:  # else it could not join
                self._pages.remove(page)

    def do(self, command: FromDesk) -> None:
        """Do what the experimenter asks for.

        Raises:
            HthorError: when that cannot be done.
        """
        match command:
            case desk_wire.Pause():
                self._control.paused = command.reason.strip() or "the experimenter paused the trial"
            case desk_wire.GoOn():
                self._control.paused = ""
            case desk_wire.Void():
                if not command.reason.strip():
                    raise HthorError("a trial is voided for a reason; write one.")
                self._control.void = command.reason.strip()
            case desk_wire.Adoption():
                self._book.correct(command.trial, command.seat, command.adopted, command.reason)
                self.show_played()

    # ------------------------------------------------------------------------------------------ from the trial's thread

    def open(self, episode: Episode) -> None:
        """Show the trial that comes next, and from now on what happens in it."""
        trial, house = episode.trial, episode.world.house
        rooms = tuple(desk_wire.RoomPlan(name=room.name, polygon=room.polygon) for room in house.rooms)
        with self._lock:
            self._events, self._watch = [], None
            self._plan = desk_wire.Plan(
                trial=trial.index,
                attempt=trial.attempt if isinstance(trial.attempt, int) else 0,
                task=trial.task.id,
                instruction=trial.task.instruction,
                time_limit=trial.task.time_limit,
                seats=tuple(episode.seats),
                rooms=rooms,
            )
            self._tell(self._plan)
        episode.attach(self._note)
        self.show_played()

    def watch(self, episode: Episode, pacer: Pacer) -> None:
        """Show where everybody is."""
        if episode.tick % _EVERY_TICKS and not self._control.paused:
            return
        poses = {seat: episode.world.pose(seat) for seat in episode.seats}
        people = []
        for name, pose in poses.items():
            seat = self._seats.get(name)
            people.append(
                Person(
                    seat=name,
                    x=round(pose.x, 2),
                    y=round(pose.y, 2),
                    yaw=round(pose.gaze, 2),
                    away_s=round(seat.absent_s(), 1) if seat else None,
                    round_trip_ms=round(1000.0 * seat.round_trip) if seat else None,
                    frames=round(seat.frames) if seat else None,
                )
            )
        with self._lock:
            self._watch = Watch(
                tick=episode.tick, paused=self._control.paused, factor=pacer.factor, people=tuple(people)
            )
            self._tell(self._watch)

    def show_played(self) -> None:
        """Show which trials are over."""
        played = self._played()
        with self._lock:
            self._tell(played)

    def _note(self, _: Episode, events: Sequence[Event]) -> None:
        with self._lock:
            for event in events:
                if not isinstance(event, _UNSHOWN):
                    self._events.append(desk_wire.happened(event))
                    self._tell(self._events[-1])

    def _played(self) -> desk_wire.Played:
        return desk_wire.Played(trials=self._book.played())

    def _tell(self, message: ToDesk) -> None:
        for page in self._pages:
            page.send(message)
