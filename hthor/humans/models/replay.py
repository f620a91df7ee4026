"""A person who does again what somebody did in a log: the same ways, looks, deeds and answers; decides nothing.

    hthor eval --agent my_robot.py --suite paper --humans replay:runs/oracle-paper-seed0

It is defined for the trials of that log: the same suite, seed and participants; anything else is an error that says
so. The robot may be another one. What then happens is simple, and no person would do it:

- Messages are answered at the ticks at which the logged person answered: whatever is shown then is confirmed or
  declined as it was then. If nothing is shown then, the answer lapses. Nothing that a message says changes the way.
- When a robot blocks the way the person stands and tries again every half second, never goes round, and does what was
  missed as fast as the stick and the body allow. Deeds are done at their places, so they come later too.
- When anything else blocks it (a door that somebody shut), that part of the way is passed over after three tries.
- When the log is at its end, so is the person: they stand still. The rating is the logged one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hthor import rules
from hthor.errors import HthorError
from hthor.geometry.plane import turn, wrap
from hthor.humans.models import _logged_trials
from hthor.humans.models._logged_trials import Past
from hthor.humans.population.participant import Person
from hthor.types import Action, Briefing, Motion, Move, Observation, Pose, Reply, Rotate, Wait

_EVERY = rules.LOG_EVERY_TICKS
_THERE_M, _THERE_RAD = 0.003, 0.003
_PAUSE_S, _TRIES = 0.5, 3
_LAPSE_TICKS = 10
"""An answer that is due while the hands are busy may come so much later."""


class Model:
    """A logged person.

    Args:
        person: which participant of the log.
        state: how many trials were done.
        source: the run folder or log.
    """

    def __init__(self, person: Person, state: Mapping[str, Any] | None = None, source: str = "") -> None:
        if not source:
            raise HthorError("replay needs the run to replay: --humans replay:RUN, a run folder or its trials.jsonl.")
        self.person, self.source = person, source
        self.trials = int(state["trials"]) if state else 0
        logged = _logged_trials.read(source)
        if person.participant not in logged:
            raise HthorError(
                f"{source} has no participant {person.participant}; it holds {', '.join(map(str, sorted(logged)))}. "
                "Evaluate with that run's suite, seed and number of participants."
            )
        self._logged = logged[person.participant]
        self._again: Reenactment | None = None

    def begin(self, briefing: Briefing) -> None:
        """Look up the trial in the log.

        Raises:
            HthorError: when this person did no such task.
        """
        self._brief, self._again = briefing, None
        self._fitting = [one for one in self._logged if one.is_of(briefing)]
        if not self._fitting:
            raise self._unknown()

    def act(self, observation: Observation) -> Action:
        again = self._again or self._find(observation)
        say = again.say(observation)
        return Action(motion=again.motion(observation) if observation.idle else Wait(), say=say)

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002  the log has the answer
        self.trials += 1
        return self._again.past.trust if self._again is not None and self._brief.teammates else None

    def state(self) -> dict[str, Any]:
        return {"trials": self.trials}

    def _find(self, observation: Observation) -> Reenactment:
        here = [one for one in self._fitting if one.begins_at(observation.pose)]
        if not here:
            raise self._unknown()
        same = [one for one in here if one.spec.index == self.trials]
        self._again = Reenactment((same or here)[0], self._brief)
        return self._again

    def _unknown(self) -> HthorError:
        told = ", ".join(f"{one.spec.index}: {one.spec.task.id}" for one in self._logged)
        return HthorError(
            f"{self.source}: participant {self.person.participant} did no such task as '{self._brief.instruction}' "
            f"from this place; their trials are {told}. A replay plays the trials of its log only: evaluate with that "
            "run's suite, seed and number of participants."
        )


def ingredients(source: str = "") -> dict[str, Any]:
    """What decides how these people behave: the log's bytes."""
    return {"log_sha256": _logged_trials.sha256(source)} if source else {}


class Reenactment:
    """Doing one logged trial again. ``clock`` is the logged tick that was reached; it never runs ahead of time."""

    def __init__(self, one: Past, briefing: Briefing) -> None:
        self.past, self.body, self.clock = one, briefing.body, 0
        self._tick_s = briefing.tick_s
        handling = math.ceil(self.body.handling / self._tick_s - 1e-6)
        self._poses, self._moving = _and_on(one.poses(), one.ticks), one.moving()
        self._deeds = [(tick - handling, motion) for tick, motion in one.deeds()]
        self._handling = handling
        self._answers = list(one.answers())
        self._tries = 0

    def say(self, now: Observation) -> Reply | None:
        """The logged answer when it is due and anything is shown."""
        while self._answers and now.tick - self._answers[0][0] > _LAPSE_TICKS:
            self._answers.pop(0)
        if not self._answers or now.tick < self._answers[0][0]:
            return None
        _, accept = self._answers.pop(0)
        return Reply(message=now.inbox[-1].id, accept=accept) if now.inbox else None

    def motion(self, now: Observation) -> Motion:
        """The next motion; waits where the logged person waited."""
        if self._is_stuck(now):
            return Wait(seconds=_PAUSE_S)
        self._arrive(now)
        if self._deeds and self._deeds[0][0] <= self.clock:
            _, deed = self._deeds.pop(0)
            self.clock += self._handling
            return deed
        return self._on_the_way(now) if self.clock < self._end else Wait(seconds=self._tick_s)

    @property
    def _end(self) -> int:
        return min(self.past.ticks, (len(self._poses) - 1) * _EVERY)

    def _next(self) -> int:
        """Number of the logged pose that comes after the clock."""
        return min(self.clock // _EVERY + 1, len(self._poses) - 1)

    def _arrive(self, now: Observation) -> None:
        """Let the clock run on to what was reached, at most to now."""
        while self.clock < min(now.tick, self._end):
            after = self._next()
            if not self._is_there(now.pose, self._poses[after]):
                if now.tick < after * _EVERY:  # on time, between two poses
                    self.clock = now.tick
                return
            due = self._deeds[0][0] if self._deeds else self._end
            if self.clock <= due < min(now.tick, after * _EVERY):
                self.clock = due
                return
            self.clock = min(now.tick, after * _EVERY)
            self._tries = 0

    def _on_the_way(self, now: Observation) -> Motion:
        """One tick towards the next logged pose."""
        after = self._next()
        goal, left = self._poses[after], after * _EVERY - now.tick
        apart = math.dist((goal.x, goal.y), (now.pose.x, now.pose.y))
        yaw, pitch = wrap(goal.yaw - now.pose.yaw), goal.pitch - now.pose.pitch
        moves = [self._moving(now.tick + k) for k in range(max(1, left))]
        turns = max(abs(yaw), abs(pitch)) > _THERE_RAD
        if apart > _THERE_M and (moves[0] is not False or left <= 1 or not any(moves) or not turns):
            share = 1.0 / max(1, sum(move is not False for move in moves)) if left > 1 else 1.0
            return self._towards(now.pose, goal, apart, share)
        if turns:
            return self._turn(yaw, pitch, max(1, moves.count(False)) if left > 1 else 1)
        return Wait(seconds=self._tick_s)

    def _towards(self, pose: Pose, goal: Pose, apart: float, share: float) -> Move:
        far = min(apart * share, self.body.speed * self._tick_s)
        x, y = turn((goal.x - pose.x, goal.y - pose.y), -pose.yaw)
        return Move(forward=x / apart * far, left=y / apart * far)

    def _turn(self, yaw: float, pitch: float, ticks: int) -> Rotate:
        most = self.body.turn_rate * self._tick_s
        share = min(1.0 / ticks, most / max(abs(yaw), abs(pitch)))
        return Rotate(yaw=yaw * share, pitch=pitch * share)

    def _is_there(self, pose: Pose, goal: Pose) -> bool:
        near = math.dist((pose.x, pose.y), (goal.x, goal.y)) <= _THERE_M
        return near and max(abs(wrap(goal.yaw - pose.yaw)), abs(goal.pitch - pose.pitch)) <= _THERE_RAD

    def _is_stuck(self, now: Observation) -> bool:
        """Whether a robot stands in the way; what nobody will clear away is given up after some tries."""
        outcome = now.outcome
        if outcome is None or outcome.ok or outcome.motion != "move":
            return False
        if outcome.by.startswith("robot"):
            return True
        self._tries += 1
        if self._tries >= _TRIES:
            self._tries = 0
            self.clock = min(now.tick, self._next() * _EVERY)
        return False


def _and_on(poses: list[Pose], ticks: int) -> list[Pose]:
    """The poses, and one more for the ticks after the last of them, in which what went on is taken to go on."""
    if (len(poses) - 1) * _EVERY >= ticks or len(poses) < 2:
        return poses
    a, b = poses[-2:]
    yaw, pitch = wrap(b.yaw - a.yaw), b.pitch - a.pitch
    return [*poses, Pose(x=2.0 * b.x - a.x, y=2.0 * b.y - a.y, yaw=b.yaw + yaw, pitch=b.pitch + pitch)]
