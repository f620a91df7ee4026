"""A trial in real time: six steps a tick, each a sixtieth of a second, with people at their pages."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, cast

import msgspec

from hthor.episode import Concurrent, Episode, EpisodeLog, Frames, TrialWorld, begin, take_answers
from hthor.episode.clocks import make_clock
from hthor.episode.play import ask, finish, record_beliefs
from hthor.humans.model import HumanModel
from hthor.live import wire
from hthor.live.control import Pacer, SessionControl, SessionStopped
from hthor.live.desk import Desk
from hthor.live.practice import OVER
from hthor.live.preparation import prepare
from hthor.live.scenery import Scenery
from hthor.live.seat import AWAY_S, LiveSeat
from hthor.live.unfinished import UnfinishedTrial
from hthor.types import SUBTICKS, BodySpec, Mind, TrialSpec

if TYPE_CHECKING:
    from hthor.live.gltf.house_file import HouseFile
    from hthor.live.practice import Practice
    from hthor.world import World

ABSENT_S = 2.0
"""[s] When somebody's page has been gone for so long, the trial is paused. Our choice."""
_KEPT_EVERY_TICKS = 10
"""How often the trial is kept for the case that the session is killed. Our choice."""
_TURN_S = 0.05
"""[s] How often a trial that waits looks whether it may go on. Our choice."""


class RealTimeLoop:
    """Drives trials in real time; the loop of a `hthor.trials.TrialRunner`.

    Args:
        seats: the people at pages, by seat. desk: shows the trials to the experimenter.
        trials: how many trials the session has.
        publish: makes the file of a house known to the pages, and returns its address; without it pages draw nothing.
        unfinished: keeps the trial that is going on, once a second.
        now, sleep: the time [s] and how to wait.
    """

    def __init__(
        self,
        seats: Mapping[str, LiveSeat],
        control: SessionControl,
        desk: Desk,
        *,
        trials: int = 1,
        publish: Callable[[HouseFile], str] | None = None,
        unfinished: UnfinishedTrial | None = None,
        now: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._seats, self._control, self.trials = dict(seats), control, trials
        self._now, self._sleep, self._publish, self._desk = now, sleep, publish, desk
        self._unfinished = unfinished
        self._drawn: Scenery | None = None  # of the last world

    def __call__(
        self,
        trial: TrialSpec,
        world: TrialWorld,
        humans: Mapping[str, HumanModel],
        robots: Mapping[str, Mind],
        practice: Practice | None = None,
    ) -> EpisodeLog:
        """Run one trial from its announcement to the ratings.

        Args:
            practice: what the trial is, if it is one: it ends when this is over, and nothing of it is kept.
        """
        episode = Episode(trial, world, (*humans, *robots))
        clock = Concurrent(pace=lambda _: None) if trial.clock == "concurrent" else make_clock(trial)
        episode.reset()
        frames = Frames(episode, humans)
        try:
            begin(episode, humans, robots, clock)
            scenery = self._scenery(world)
            file = self._publish(scenery.file) if scenery is not None and self._publish is not None else ""
            self._desk.open(episode, file, scenery.own if scenery is not None else None)
            self._announce(episode, scenery, file, practice)
            self._show_bodies(episode, scenery)
            pacer = Pacer(self._now, self._sleep)
            while not episode.done:
                if self._unfinished is not None and practice is None and episode.tick % _KEPT_EVERY_TICKS == 0:
                    self._unfinished.keep(episode, humans)
                if (held := self._hold(episode, practice)) is not None:
                    pacer.restart()
                    self._desk.watch(episode, pacer, held)
                    continue
                ask(episode, humans, robots, clock, frames)
                take_answers(episode, clock)
                for _ in range(SUBTICKS):
                    frames.step()
                    self._show_bodies(episode, scenery)
                    pacer.wait()
                record_beliefs(episode.advance(), humans)
                self._desk.watch(episode, pacer)
        finally:
            clock.close()
        for seat in self._seats.values():
            seat.note(episode.tick, "real time", **pacer.figures())
            if seat.vr_share > 0.0:
                seat.note(episode.tick, "in VR", share=round(seat.vr_share, 3))
        rate = bool(robots) and not episode.voided and practice is None
        self._show_end(episode, rate=rate)
        return finish(episode, humans) if practice is None else episode.log()

    def _announce(self, episode: Episode, scenery: Scenery | None, file: str, practice: Practice | None) -> None:
        """Show everybody the task, and wait until all are ready."""
        trial = episode.trial
        ahead = wire.TrialAhead(
            trial=trial.index,
            trials=self.trials,
            house=episode.world.house.id,
            instruction=trial.task.instruction,
            time_limit=trial.task.time_limit,
            bodies=tuple(_body(seat, episode.world.bodies[seat]) for seat in episode.seats),
            practice=practice is not None,
            phases=bool(trial.task.phases),
        )
        for name, seat in self._seats.items():
            own = scenery.own[name] if scenery is not None else ()
            seat.open(msgspec.structs.replace(ahead, file=file, own=own))
        if practice is not None:
            practice.show()
            episode.attach(practice.watch)
        while not self._desk.gather():
            self._desk.watch(episode)
            if self._control.draining:
                raise SessionStopped
            self._control.wait(_TURN_S)
        for seat in self._seats.values():
            seat.start(trial.index)

    def _scenery(self, world: TrialWorld) -> Scenery | None:
        """What pages draw of a world, as it is now."""
        if self._publish is None:
            return None
        if self._drawn is None or self._drawn.world is not world:
            self._drawn = prepare(lambda: Scenery(cast("World", world)))
        self._drawn.restart()
        return self._drawn

    def _hold(self, episode: Episode, practice: Practice | None) -> str | None:
        """Why time stands still, as when the experimenter has paused the trial, or somebody's page is gone; or None."""
        control = self._control
        away = {name: seat.absent_s() for name, seat in self._seats.items()}
        if control.stopped or (control.draining and (practice is not None or max(away.values()) > ABSENT_S)):
            raise SessionStopped
        gone = [name for name, seconds in away.items() if seconds > AWAY_S and practice is None]
        ends = OVER if practice is not None and practice.over else control.void
        if ends or gone:
            if episode.paused:
                episode.resume()
            episode.void(ends or f"{', '.join(gone)} did not come back")
            control.void = ""
            return episode.voided
        lost = [name for name, seconds in away.items() if seconds > (0.0 if episode.paused else ABSENT_S)]
        reason = control.paused or "; ".join(self._seats[name].absence for name in lost)
        if bool(reason) != episode.paused:
            if reason:
                episode.pause(reason)
            else:
                episode.resume()
            for seat in self._seats.values():
                seat.show(wire.Paused(reason=reason))
        if not reason:
            return None
        control.wait(_TURN_S)
        return reason

    def _show_bodies(self, episode: Episode, scenery: Scenery | None) -> None:
        moved = scenery.moved() if scenery is not None else {}
        self._desk.show_frame(episode.tick, episode.step, moved)
        for name, seat in self._seats.items():
            seat.show_frame(episode.tick, episode.step, episode.world.pose(name), moved)

    def show_played(self) -> None:
        """Show the experimenter which trials are in the log."""
        self._desk.show_played()

    def _show_end(self, episode: Episode, *, rate: bool) -> None:
        self._desk.end(met=episode.met, voided=episode.voided)
        for seat in self._seats.values():
            seat.show(
                wire.Ended(trial=episode.trial.index, met=episode.met, voided=episode.voided, rate=rate),
                instead_of=(wire.Panel, wire.Map, wire.Paused),
            )


def _body(seat: str, body: BodySpec) -> wire.Body:
    return wire.Body(
        seat=seat,
        name=body.name,
        radius=body.radius,
        height=body.height,
        eye=body.eye,
        reach=body.reach,
        speed=body.speed,
        turn_rate=body.turn_rate,
    )
