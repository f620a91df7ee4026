"""The experimenter's desk: what they see of a session, and what they do to it.

Two threads meet here, as in `hthor.live.seat`: the trial's thread shows the desk what happens, and the server's thread
gives the desk what the experimenter's page sends. Everything that a page shows follows from the trial that is going on
and from the run's log, so a page that is opened later shows the same.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from hthor.errors import HthorError
from hthor.live import desk_wire, wire
from hthor.live.desk_wire import (
    Eye,
    FromDesk,
    Gathering,
    Happened,
    Line,
    Person,
    Plan,
    PlayedTrial,
    SessionOver,
    ToDesk,
    TrialOver,
    Watch,
    Ways,
)
from hthor.live.event_sentences import TOO_MANY
from hthor.live.wire import FrameHead
from hthor.types import SUBTICKS

if TYPE_CHECKING:
    from hthor.episode import Episode
    from hthor.live.control import Pacer, SessionControl
    from hthor.live.seat import LiveSeat
    from hthor.types import BodySpec, Vec2
    from hthor.types.events import Event

_EVERY_TICKS = 2
"""[ticks] How often the desk is shown where everybody is."""


class Book(Protocol):
    """The run's log, for the desk; `hthor.live.run_book.RunBook` implements it."""

    def played(self) -> tuple[PlayedTrial, ...]:
        """The trials that are over, with their corrections."""

    def repeat(self, trial: str, reason: str) -> None:
        """Void a trial that is over, and have it repeated; HthorError when that cannot be."""

    def correct(self, trial: str, seat: str, adopted: bool | None, reason: str) -> None:
        """Correct whether the person in a seat adopted a suggestion; HthorError when that cannot be."""


class DeskPage(Protocol):
    """The connection to an experimenter's page."""

    def send(self, message: ToDesk) -> None:
        """Send a message; returns at once, from any thread."""

    def show(self, head: FrameHead, moved: Mapping[int, bytes]) -> None:
        """Send a frame; returns at once, from any thread. A newer one replaces one that waits, and keeps what moved."""


@dataclass
class _Shown:
    """What the desk shows of one trial.

    Attributes:
        places: where everything that moves is, by its number. moved: what of it the pages that look have not got yet.
    """

    plan: Plan | None = None
    gathering: Gathering | None = None
    events: list[Line] = field(default_factory=list)
    ways: dict[str, list[Vec2]] = field(default_factory=dict)
    watch: Watch | None = None
    end: TrialOver | None = None
    over: SessionOver | None = None
    places: dict[int, bytes] = field(default_factory=dict)
    moved: dict[int, bytes] = field(default_factory=dict)

    def messages(self) -> list[ToDesk]:
        """What a page that joins has missed."""
        if self.plan is None:
            return []
        so_far = (
            self.plan,
            self.gathering,
            Happened(events=tuple(self.events)),
            Ways(ways=self.ways),
            self.watch,
            self.end,
            self.over,
        )
        return [message for message in so_far if message is not None]


class Desk:
    """The desk of one session; any number of pages may show it."""

    def __init__(self, control: SessionControl, seats: Mapping[str, LiveSeat], book: Book) -> None:
        self._control, self._seats, self._book = control, dict(seats), book
        self._lock = threading.Lock()
        self._pages: list[DeskPage] = []
        self._lookers: list[DeskPage] = []  # pages that draw what seats see
        self._shown = _Shown()
        self._asked = wire.HeadsetAsked(on=False)

    @property
    def events(self) -> tuple[Line, ...]:
        """What has happened in the trial so far, as pages show it."""
        with self._lock:
            return tuple(self._shown.events)

    # ----------------------------------------------------------------------------------------- from the server's thread

    def join(self, page: DeskPage) -> None:
        """Show a page everything."""
        played = self._played()  # reads the log, for which the trial must not wait
        with self._lock:
            self._pages.append(page)
            for message in (*self._shown.messages(), played, self._asked):
                page.send(message)

    def leave(self, page: DeskPage) -> None:
        """The page is gone."""
        with self._lock:
            for pages in (self._pages, self._lookers):
                if page in pages:  # else it could not join, or does not look
                    pages.remove(page)

    def do(self, page: DeskPage, command: FromDesk) -> None:
        """Do what the experimenter asks for on a page.

        Raises:
            HthorError: when that cannot be done.
        """
        match command:
            case desk_wire.Pause():
                self._control.paused = command.reason.strip() or "the experimenter paused the trial"
            case desk_wire.GoOn():
                self._control.paused = ""
            case desk_wire.Start():
                self._start()
            case desk_wire.Look():
                self._look(page, command.on)
            case desk_wire.Repeat():
                self._book.repeat(command.trial, command.reason)
                self.show_played()
            case desk_wire.Void():
                self._void(command.reason.strip())
            case desk_wire.AskForHeadset():
                self._ask_for_headset(command.on)
            case desk_wire.Adoption():
                self._book.correct(command.trial, command.seat, command.adopted, command.reason)
                self.show_played()

    # ------------------------------------------------------------------------------------------ from the trial's thread

    def open(self, episode: Episode, file: str = "", own: Mapping[str, tuple[int, ...]] | None = None) -> None:
        """Show the trial that comes next, and from now on what happens in it.

        Args:
            file: the address of the house's file. own: the numbers in it of each seat's body and head.
        """
        trial, house, own = episode.trial, episode.world.house, own or {}
        rooms = tuple(desk_wire.RoomPlan(name=room.name, polygon=room.polygon) for room in house.rooms)
        bodies = {seat: episode.world.bodies[seat] for seat in episode.seats}
        with self._lock:
            self._shown = _Shown()
            self._control.started = False
            self._shown.plan = Plan(
                trial=trial.index,
                attempt=trial.attempt if isinstance(trial.attempt, int) else 0,
                task=trial.task.id,
                instruction=trial.task.instruction,
                time_limit=trial.task.time_limit,
                seats=tuple(episode.seats),
                rooms=rooms,
                starts=self._control.experimenter_starts and trial.index != wire.PRACTICE,
                file=file,
                eyes=tuple(
                    Eye(seat=seat, height=bodies[seat].eye, own=own[seat], fov=self._fov(seat, bodies[seat]))
                    for seat in own
                ),
            )
            self._tell(self._shown.plan)
        episode.attach(self._note)
        self.show_played()

    def gather(self) -> bool:
        """Show who is ready for the trial that comes next; returns whether it may begin."""
        ready = tuple(name for name, seat in self._seats.items() if seat.is_ready)
        missing = tuple(name for name in self._seats if name not in ready)
        with self._lock:
            waits = self._shown.plan is not None and self._shown.plan.starts
            begun = not missing and (self._control.started or not waits)
            gathering = Gathering(ready=ready, missing=missing, begun=begun)
            if gathering != self._shown.gathering:
                self._shown.gathering = gathering
                self._tell(gathering)
        return begun

    def watch(self, episode: Episode, pacer: Pacer | None = None, paused: str = "") -> None:
        """Show where everybody is, and how their pages are.

        Args:
            pacer: of the trial, once it has begun. paused: why time stands still, if it does.
        """
        if episode.tick % _EVERY_TICKS and not paused:
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
                    vr=seat.vr if seat else None,
                )
            )
        with self._lock:
            for one in people:
                way = self._shown.ways.setdefault(one.seat, [])
                if way[-1:] != [(one.x, one.y)]:
                    way.append((one.x, one.y))
            self._shown.watch = Watch(
                tick=episode.tick, paused=paused, factor=pacer.factor if pacer else 1.0, people=tuple(people)
            )
            self._tell(self._shown.watch)

    def end(self, *, met: bool, voided: str) -> None:
        """Show that the trial is over."""
        with self._lock:
            self._shown.end = TrialOver(met=met, voided=voided)
            self._tell(self._shown.end)

    def show_frame(self, tick: int, step: int, moved: Mapping[int, bytes]) -> None:
        """Show pages that look what has moved since the last frame, ten times a second."""
        with self._lock:
            self._shown.places.update(moved)
            if not self._lookers:
                return
            self._shown.moved.update(moved)
            if step % SUBTICKS == 0:
                for page in self._lookers:
                    page.show(_head(tick), self._shown.moved)
                self._shown.moved = {}

    def show_played(self) -> None:
        """Show which trials are over."""
        played = self._played()
        with self._lock:
            self._tell(played)

    def show_over(self, over: SessionOver) -> None:
        """Show that the session is over, and where the people's own pages are."""
        with self._lock:
            self._shown.over = over
            self._tell(over)

    def _start(self) -> None:
        with self._lock:
            gathering = self._shown.gathering
            if gathering is None or gathering.begun or not self._control.experimenter_starts:
                raise HthorError("no trial waits for the experimenter.")
            if gathering.missing:
                raise HthorError(f"{', '.join(gathering.missing)}: not ready yet; start the trial when everybody is.")
            self._control.started = True

    def _void(self, reason: str) -> None:
        if not reason:
            raise HthorError("a trial is voided for a reason; write one.")
        with self._lock:
            gathering = self._shown.gathering
            if gathering is None or not gathering.begun or self._shown.end is not None:
                raise HthorError("no trial is going on; one that is over is voided in the list of trials.")
        self._control.void = reason

    def _ask_for_headset(self, on: bool) -> None:
        self._asked = wire.HeadsetAsked(on=on)
        for seat in self._seats.values():
            seat.show(self._asked)
        with self._lock:
            self._tell(self._asked)

    def _look(self, page: DeskPage, on: bool) -> None:
        with self._lock:
            if page in self._lookers:
                self._lookers.remove(page)
            if on and page in self._pages:
                self._lookers.append(page)
                page.show(_head(self._shown.watch.tick if self._shown.watch else 0), self._shown.places)

    def _fov(self, seat: str, body: BodySpec) -> Vec2 | None:
        return None if seat in self._seats else body.fov

    def _note(self, _: Episode, events: Sequence[Event]) -> None:
        lines = tuple(desk_wire.line(event) for event in events if not isinstance(event, TOO_MANY))
        if lines:
            with self._lock:
                self._shown.events += lines
                self._tell(Happened(events=lines))

    def _played(self) -> desk_wire.Played:
        return desk_wire.Played(trials=self._book.played())

    def _tell(self, message: ToDesk) -> None:
        for page in self._pages:
            page.send(message)


def _head(tick: int) -> FrameHead:
    """The head of a frame that is for nobody's own page."""
    return FrameHead(tick, 0, 0, 0.0, 0.0, 0.0, 0.0, 0.0)
