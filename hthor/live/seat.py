"""A person's seat in a live session: between the page that they have open and the trial that is going on.

Two threads meet here. The server's thread gives what the page sends (`join`, `leave`, `steer`, `act`, `rate`); the
trial's thread asks for it in every step, as `hthor.humans.models.live` is a human model with a method ``frame``, and
says what there is to see.
"""

from __future__ import annotations

import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Protocol

from hthor.live import wire
from hthor.live.choices import find_choices
from hthor.live.pictures import to_jpeg
from hthor.live.wire import PRACTICE, Act, FrameHead, Steering, ToPage
from hthor.types import Action, Briefing, Controls, Drive, Observation, Pose
from hthor.types.events import Note

STALE_S = 0.25
"""[s] Somebody whose page has sent no steering for so long stands still. Our choice."""
AWAY_S = 60.0
"""[s] Somebody whose page has been gone for so long has left the trial. Our choice."""
HANGS_S = 3.0
"""[s] Somebody whose page has sent no steering for so long in a trial sees nothing of it. Our choice."""
_TURN_S = 0.25
"""[s] How often the trial, while it waits for a rating, looks whether the page is still there. Our choice."""
_OF_A_TRIAL = (wire.Steps, wire.Began, wire.Now, wire.Choices, wire.Panel, wire.Map, wire.Paused, wire.Ended)
"""What a page no longer shows when the next trial is opened."""


class Page(Protocol):
    """The connection to a page; its methods return at once and may be called from any thread."""

    def send(self, message: ToPage) -> None:
        """Send a message; none is lost as long as the page is connected."""

    def send_picture(self, message: int, jpeg: bytes) -> None:
        """Send the picture of a message."""

    def show(self, head: FrameHead, moved: Mapping[int, bytes]) -> None:
        """Send a frame, see `wire.encode_frame`; a newer one replaces one that waits, and keeps what moved in it."""


class LiveSeat:
    """One person's seat. ``now`` is the time [s] on a clock that never goes back.

    Attributes:
        round_trip: [s] of a message to the page and back. frames: [1/s] pictures that the page draws.
        vr: whether the person is in VR.
    """

    def __init__(self, seat: str, now: Callable[[], float] = time.monotonic) -> None:
        self.seat, self._now = seat, now
        self._server = secrets.token_hex(8)
        self._lock = threading.Lock()
        self._changed = threading.Condition(self._lock)
        self._page: Page | None = None
        self._left_at = now()
        self._steering = Steering(0, Drive())
        self._steered_at = -1.0
        self._off_at: float | None = None  # since when the headset has been off
        self._began_at: float | None = None  # when the trial that is going on began
        self._acts: deque[Act] = deque()
        self._acted = 0  # the number of the last act that was taken
        self._ready = False  # for the trial that was opened last
        self._skips = False  # that trial, if it is the practice
        self._rating: int | None = None  # of that trial
        self._screen: dict[type[ToPage], ToPage] = {}  # what the page shows, by kind, for a page that joins again
        self._picture: tuple[int, bytes] | None = None
        self._head: FrameHead | None = None
        self._places: dict[int, bytes] = {}  # where everything that moves is, by its number
        self._drive = Drive()
        self.round_trip = self.frames = 0.0
        self.vr = False
        self._steps = self._vr_steps = 0  # of this trial
        self._notes: list[Note] = []
        self._last: Observation | None = None
        self._trial: int | None = None
        self._body: wire.Body | None = None

    # ----------------------------------------------------------------------------------------- from the server's thread

    def join(self, page: Page) -> Page | None:
        """Take a page, and show it how things are; the page that was there before, if there was one."""
        with self._lock:
            before, self._page, self._off_at, self.vr = self._page, page, None, False
            page.send(wire.Welcome(seat=self.seat, acts=self._acted, server=self._server))
            for message in self._screen.values():
                page.send(message)
            if self._picture is not None:
                page.send_picture(*self._picture)
            if self._head is not None:
                page.show(self._head, self._places)
            self._steered_at = -1.0
            self._began_at = None if self._began_at is None else self._now()
            self._changed.notify_all()
        return before

    def leave(self, page: Page) -> None:
        """The page is gone."""
        with self._lock:
            if self._page is page:
                self._page, self._left_at = None, self._now()
                self._changed.notify_all()

    def steer(self, steering: Steering) -> None:
        """Take over the stick and the head."""
        with self._lock:
            self._steering, self._steered_at = steering, self._now()

    def act(self, act: Act) -> None:
        """Take an act, unless it was taken before; the next number is the only one that can be new."""
        with self._lock:
            if act.number == self._acted + 1:
                self._acts.append(act)
                self._acted += 1
            if self._page is not None:
                self._page.send(wire.Acknowledged(act=self._acted))

    def ping(self, ping: wire.Ping) -> None:
        """Note how the page and its connection are."""
        self.round_trip, self.frames, self.vr = ping.round_trip, ping.frames, ping.vr
        with self._lock:
            if not ping.off:
                self._off_at = None
            elif self._off_at is None:
                self._off_at = self._now()

    def begin_trial(self, trial: int) -> None:
        """The person is ready for this trial."""
        with self._lock:
            self._ready = self._ready or trial == self._trial

    def skip(self, trial: int) -> None:
        """The person does not want to practise, if this trial is the practice."""
        with self._lock:
            if trial == self._trial == PRACTICE:
                self._ready = self._skips = True

    def rate(self, trial: int, value: int) -> None:
        """Take the rating of a trial."""
        with self._lock:
            if self._rating is None and trial == self._trial:
                self._rating = value
                self._changed.notify_all()

    # ------------------------------------------------------------------------------------------ from the trial's thread

    def show(self, message: ToPage, *, instead_of: tuple[type[ToPage], ...] = ()) -> None:
        """Show something until a message of its kind replaces it; ``instead_of`` names kinds that it replaces too."""
        with self._lock:
            for kind in instead_of:
                self._screen.pop(kind, None)
            self._screen[type(message)] = message
            if self._page is not None:
                self._page.send(message)

    def show_frame(self, tick: int, step: int, pose: Pose, moved: Mapping[int, bytes]) -> None:
        """Show where the person is, and what has moved since the last frame."""
        with self._lock:
            self._places.update(moved)
            self._head = FrameHead(tick, step, self._steering.number, pose.x, pose.y, pose.yaw, pose.gaze, pose.pitch)
            if self._page is not None:
                self._page.show(self._head, moved)

    def absent_s(self) -> float:
        """[s] For how long nobody has seen the trial: no page is there, the headset is off, or the page draws nothing.

        0 while there is somebody. A page steers in every picture that it draws.
        """
        with self._lock:
            if self._page is None:
                return self._now() - self._left_at
            if self._off_at is not None:
                return self._now() - self._off_at
            if self._began_at is None:
                return 0.0
            silent = self._now() - max(self._began_at, self._steered_at)
            return silent if silent > HANGS_S else 0.0

    @property
    def absence(self) -> str:
        """Why nobody sees the trial, in words, if that is so."""
        with self._lock:
            if self._page is None:
                return f"the page of {self.seat} is gone"
            if self._off_at is not None:
                return f"the headset of {self.seat} is off"
            return f"the page of {self.seat} draws no pictures"

    def open(self, ahead: wire.TrialAhead) -> None:
        """Show the person the next trial."""
        with self._lock:
            self._trial, self._ready, self._skips, self._rating = ahead.trial, False, False, None
            self._began_at = None
            self._head, self._places = None, {}
        self._body = next(body for body in ahead.bodies if body.seat == self.seat)
        self.show(ahead, instead_of=_OF_A_TRIAL)

    def start(self, trial: int) -> None:
        """The trial that was opened last begins."""
        with self._lock:
            self._began_at = self._now()
        self.show(wire.Began(trial=trial))

    @property
    def is_ready(self) -> bool:
        """Whether the person is there and ready for the trial that was opened last."""
        with self._lock:
            return self._page is not None and self._ready

    @property
    def skips(self) -> bool:
        """Whether the person has skipped the practice that is going on."""
        with self._lock:
            return self._skips

    def ask_rating(self) -> int | None:
        """The person's trust in the robots, 1 to 7; waits for it, but not for somebody who has gone away."""
        with self._changed:
            while self._rating is None:
                if self._page is None and self._now() - self._left_at > AWAY_S:
                    return None
                self._changed.wait(_TURN_S)
            return self._rating

    def begin(self, briefing: Briefing) -> None:  # noqa: ARG002  the page has been told
        """A trial begins: what was done before it does not count."""
        with self._lock:
            self._acts.clear()
            self._notes, self._drive, self._picture = [], Drive(), None
            self._steps = self._vr_steps = 0
        self._last = None

    def frame(self, controls: Controls) -> None:
        """Do what the person does in this step, and in the first of a tick show them what has changed."""
        with self._lock:
            fresh = self._now() - self._steered_at <= STALE_S
            acts = tuple(self._acts)
            self._acts.clear()
            steering = self._steering.drive
        self._steps += 1
        self._vr_steps += self.vr
        drive = steering if fresh else Drive(yaw=self._drive.yaw, pitch=self._drive.pitch)
        if drive != self._drive or (controls.tick, controls.step) == (0, 0):
            self._drive = drive
            controls.steer(drive)
        if controls.step == 0:
            self._observe(controls.observe())
        for act in acts:
            controls.submit(Action(motion=act.motion or self._drive, say=act.say, signals=act.signals))

    def note(self, tick: int, topic: str, **values: float | str) -> None:
        """Note something about the session in the journal of this trial."""
        self._notes.append(Note(tick=tick, seat=self.seat, topic=topic, values=dict(values)))

    @property
    def vr_share(self) -> float:
        """For which part of the trial so far the person has been in VR."""
        return self._vr_steps / max(1, self._steps)

    @property
    def journal(self) -> tuple[Note, ...]:
        """The notes about this trial."""
        return tuple(self._notes)

    def _observe(self, seen: Observation) -> None:
        """Show what has changed."""
        before, self._last = self._last, seen
        hands = seen.outcome if seen.outcome is not None and seen.outcome.motion != "drive" else None
        now = wire.Now(
            tick=seen.tick, holding=seen.holding, busy=not seen.idle, room=seen.room, phase=seen.phase, outcome=hands
        )
        old = self._screen.get(wire.Now)
        if not isinstance(old, wire.Now) or _without_tick(old) != _without_tick(now):
            self.show(now)
        assert self._body is not None
        with self._lock:
            hand = self._steering.hand
        offered = find_choices(seen, self._body.eye, self._body.reach, hand)
        if offered != self._screen.get(wire.Choices):
            self.show(offered)
        message = seen.display.message if seen.display is not None else None
        shown = before.display.message if before is not None and before.display is not None else None
        if before is None or (message is None) != (shown is None) or (message and shown and message.id != shown.id):
            self._show_panel(seen)
        drawn = seen.display.map if seen.display is not None else None
        if before is None or before.display is None or drawn != before.display.map:
            self.show(wire.Map(map=drawn))

    def _show_panel(self, seen: Observation) -> None:
        message = seen.display.message if seen.display is not None else None
        if message is None:
            self.show(wire.Panel(message=None))
            return
        has_picture = message.image is not None
        self.show(
            wire.Panel(
                message=message.id,
                sender=message.sender,
                text=message.text,
                question=message.question,
                picture=has_picture,
            )
        )
        if message.image is not None:
            jpeg = to_jpeg(message.image())
            with self._lock:
                self._picture = message.id, jpeg
                if self._page is not None:
                    self._page.send_picture(message.id, jpeg)


def _without_tick(now: wire.Now) -> tuple[object, ...]:
    return now.holding, now.busy, now.room, now.phase, now.outcome
