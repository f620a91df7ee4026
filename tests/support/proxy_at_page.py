"""A simulated person at a page: what they decided in batch is sent through the socket by a scripted client."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping
from typing import Any

import msgspec
from live_client import ScriptedPerson
from msgspec import Struct

from hthor import rules
from hthor.episode import Episode, EpisodeLog, Frames, TrialWorld, begin, take_answers
from hthor.episode.clocks import make_clock
from hthor.episode.play import ask, finish
from hthor.guest import GuestPool
from hthor.humans.model import HumanModel
from hthor.live import wire
from hthor.live.seat import LiveSeat
from hthor.trials import TrialRunner, form_team, make_sessions, make_sources
from hthor.types import HUMAN, SUBTICKS, Action, Drive, Mind, Move, Pose, Rotate, TrialSpec, Wait

STEP_S = rules.TICK_S / SUBTICKS


class Spied:
    """A human model whose actions are noted."""

    def __init__(self, model: Any) -> None:
        self._model = model
        self.actions: list[tuple[int, Action]] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    def act(self, observation: Any) -> Action:
        action: Action = self._model.act(observation)
        self.actions.append((observation.tick, action))
        return action


class Course(Struct):
    """Where somebody was and looked in every tick of a trial, and what they did with hands and words, by tick."""

    poses: list[Pose]
    acts: list[tuple[int, dict[str, Any]]]

    def at(self, tick: int, share: float) -> Pose:
        """Where they were between a tick and the next."""
        before, after = (self.poses[min(one, len(self.poses) - 1)] for one in (tick, tick + 1))
        turn = math.remainder(after.gaze - before.gaze, math.tau)
        return Pose(
            x=before.x + share * (after.x - before.x),
            y=before.y + share * (after.y - before.y),
            yaw=before.gaze + share * turn,
            pitch=after.pitch,
        )


def _act(action: Action) -> dict[str, Any]:
    """The part of an action that is an act of a page."""
    moves = isinstance(action.motion, Move | Rotate | Wait | Drive)
    parts = {"motion": None if moves else action.motion, "say": action.say, "signals": action.signals}
    return {name: msgspec.to_builtins(part) for name, part in parts.items() if part}


class Follower(ScriptedPerson):
    """Does in every frame what a course says; the server waits for it, so that no time is lost."""

    def __init__(self, address: str, token: str, trial: int, course: Course) -> None:
        super().__init__(address, token, steers=False)
        self._trial, self._course = trial, course
        self._left = list(course.acts)

    def see(self, head: wire.FrameHead) -> None:
        """Steer to where the course is after the next step, and act in the tick before an action is due."""
        began = self.last("began")
        if began is None or began["trial"] != self._trial:  # a frame of the trial before
            return
        while self._left and self._left[0][0] <= head.tick + 1:
            self.act(**self._left.pop(0)[1])
        goal = self._course.at(head.tick, (head.step + 1) / SUBTICKS)
        dx, dy = (goal.x - head.x) / STEP_S, (goal.y - head.y) / STEP_S
        cos, sin = math.cos(goal.yaw), math.sin(goal.yaw)
        drive = Drive(forward=cos * dx + sin * dy, left=cos * dy - sin * dx, yaw=goal.yaw, pitch=goal.pitch)
        self.socket.send(wire.encode_steering(wire.Steering(head.tick * SUBTICKS + head.step + 1, drive)))


class Turns:
    """The time of a session that waits in every step for the answer of the page."""

    def __init__(self, seat: LiveSeat) -> None:
        self._steps, self._steered = 0, 0
        self._news = threading.Condition()
        self._take, seat.steer = seat.steer, self._steer  # type: ignore[method-assign]

    def restart(self) -> None:
        self._steps = self._steered = 0

    def now(self) -> float:
        return self._steps * STEP_S

    def sleep(self, _: float) -> None:
        self._steps += 1
        with self._news:
            assert self._news.wait_for(lambda: self._steered > self._steps, 60.0)

    def _steer(self, steering: wire.Steering) -> None:
        self._take(steering)
        with self._news:
            self._steered = steering.number
            self._news.notify_all()


def in_batch(agent: str, session: int, trials: int, suite: str = "smoke") -> list[tuple[EpisodeLog, Course]]:
    """The first trials of a session of a suite by its simulated person, and what they did."""
    team = form_team(["scout"], [agent])
    courses: list[Course] = []

    def loop(
        trial: TrialSpec, world: TrialWorld, humans: Mapping[str, HumanModel], robots: Mapping[str, Mind]
    ) -> EpisodeLog:
        """As `hthor.episode.play`, and notes what the person does."""
        spied = Spied(humans[HUMAN])
        people, episode, clock = {HUMAN: spied}, Episode(trial, world, (HUMAN, *robots)), make_clock(trial)
        episode.reset()
        frames, poses = Frames(episode, people), []
        begin(episode, people, robots, clock)
        while not episode.done:
            poses.append(world.pose(HUMAN))
            ask(episode, people, robots, clock, frames)
            take_answers(episode, clock)
            frames.play()
            episode.advance()
        poses.append(world.pose(HUMAN))
        courses.append(Course(poses, [(tick, act) for tick, action in spied.actions if (act := _act(action))]))
        return finish(episode, people)

    runner = TrialRunner(make_sources(team), GuestPool(), loop=loop)
    (chosen,) = (one for one in make_sessions(suite, agent=team, humans="proxy") if one.number == session)
    with runner.enter(chosen) as participants:
        logs = [runner.run(participants, trial).log for trial in chosen.trials[:trials]]
    return list(zip(logs, courses, strict=True))


def attend(person: ScriptedPerson, trial: int, rating: int = 4) -> None:
    """Begin and rate a trial."""
    person.wait_for("trial", trial=trial)
    person.send({"type": "begin", "trial": trial})
    person.wait_for("ended", 3600.0, trial=trial)
    person.send({"type": "rate", "trial": trial, "value": rating})
