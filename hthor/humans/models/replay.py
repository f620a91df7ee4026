"""Repeats what a logged participant did: the same paths, looks, hand actions and answers; decides nothing.

    hthor eval --agent my_robot.py --suite paper --humans replay:runs/oracle-paper-seed0

It is defined for the trials of that log only: the same suite, seed and participants. The robot may differ. Then simple
rules apply, which no real person would follow:

- A message that is shown at the tick of a logged answer gets that answer; if none is shown, the answer lapses. The
  content of messages changes nothing. What the participant asked or told others is said at the same tick.
- Panel and map are shown and hidden at the logged ticks, if there is something to show or hide.
- If a robot blocks the path, the replay stands and tries again every half second, and never goes around it. Afterwards
  it catches up as fast as stick and body allow. Hand actions happen at their places, so they come later too.
- If anything else blocks the path (a door that was shut, another person), that part of the path is skipped after three
  tries.
- If a phase of the task ends earlier or later than in the log, the replay goes on with the next phase then.
- After the end of the log it stands still. The rating is the logged rating.
"""

from __future__ import annotations

import math

import msgspec

from hthor import rules
from hthor.geometry.plane import turn, wrap
from hthor.humans.models import _logged_trials
from hthor.humans.models._logged_trials import LoggedModel, LoggedTrial
from hthor.types import (
    Action,
    Briefing,
    Display,
    Motion,
    Move,
    Observation,
    Pose,
    Ready,
    Reply,
    Rotate,
    Send,
    Show,
    Signal,
    Wait,
)

_EVERY = rules.LOG_EVERY_TICKS
_THERE_M = 0.003
"""[m] Distance within which a logged position is reached. Our choice: poses are logged to a millimetre."""
_THERE_RAD = 0.003
"""[rad] Angle within which a logged direction is reached. Our choice: angles are logged to a milliradian."""
_PAUSE_S = 0.5
"""[s] Time between two tries while a robot blocks the path. Our choice."""
_TRIES = 3
"""[count] Tries after which a blocked part of the path is skipped. Our choice."""
_LAPSE_TICKS = 10
"""[ticks] Greatest delay of an answer that is due while the hands are busy. Our choice: one second."""

ingredients = _logged_trials.ingredients


class Model(LoggedModel):
    """A logged participant."""

    name = "replay"
    _again: Reenactment | None = None

    def begin(self, briefing: Briefing) -> None:
        """Look up the task in the log; errors as in `LoggedModel.begin`."""
        self._again = None
        super().begin(briefing)

    def act(self, observation: Observation) -> Action:
        """What the logged participant did at this point."""
        if self._again is None:
            self._again = Reenactment(self.find(observation.pose), self._briefing)
        again = self._again
        observation = again.on_logged_time(observation)
        say = again.say(observation)
        signals: tuple[Signal, ...] = (*again.signals(observation), *again.ready(observation))
        return Action(motion=again.motion(observation) if observation.idle else Wait(), say=say, signals=signals)


class Reenactment:
    """Repeats one logged trial. ``clock`` is the logged tick reached so far; it is never ahead of the trial."""

    def __init__(self, trial: LoggedTrial, briefing: Briefing) -> None:
        self.trial, self.body, self.clock = trial, briefing.body, 0
        self._tick_s = briefing.tick_s
        handling = math.ceil(self.body.handling / self._tick_s - 1e-6)
        self._poses, self._moving = _extrapolated(trial.poses(), trial.ticks), trial.moving()
        self._hand_actions = [(tick - handling, motion) for tick, motion in trial.hand_actions()]
        self._handling = handling
        self._utterances, self._others = list(trial.utterances()), ("", *briefing.teammates)
        self._tries = 0
        self._display_changes, self._seen = list(trial.display_changes()), set[str]()
        self._phase, self._later = briefing.phases[0].name if briefing.phases else "", 0

    def signals(self, now: Observation) -> tuple[Show, ...]:
        """What is shown and hidden on the display now; only what has been on it."""
        display, due = now.display, []
        while self._display_changes and self._display_changes[0][0] <= now.tick:
            due.append(self._display_changes.pop(0)[1])
        if display is not None:
            self._seen |= {what for what in ("panel", "map") if _on(display, what) is not None}
        return tuple(show for show in due if show.what in self._seen)

    def on_logged_time(self, now: Observation) -> Observation:
        """The observation with the tick that it would have in the log.

        A phase may begin earlier or later than in the log. The replay then goes on with what was done in this phase.
        """
        if now.phase != self._phase:
            self._phase, self.clock = now.phase, self.trial.phase_began(now.phase)
            self._later = now.tick - self.clock
            self._hand_actions = [one for one in self._hand_actions if one[0] >= self.clock]
        return msgspec.structs.replace(now, tick=now.tick - self._later) if self._later else now

    def ready(self, now: Observation) -> tuple[Ready, ...]:
        """The signal that the participant is ready for the next phase, once they were."""
        return (Ready(),) if now.phase and any(tick <= now.tick for tick in self.trial.said_ready()) else ()

    def say(self, now: Observation) -> Reply | Send | None:
        """What the participant said, when it is due: an answer if a message is shown, words if somebody is there."""
        while self._utterances and now.tick - self._utterances[0][0] > _LAPSE_TICKS:
            self._utterances.pop(0)
        if not self._utterances or now.tick < self._utterances[0][0]:
            return None
        _, said = self._utterances.pop(0)
        if isinstance(said, bool):
            return Reply(message=now.inbox[-1].id, accept=said) if now.inbox else None
        if said.answers is None:
            return said if said.to in self._others else None
        asked = [message for message in now.inbox if message.question]
        return msgspec.structs.replace(said, to="", answers=asked[-1].id) if asked else None

    def motion(self, now: Observation) -> Motion:
        """The next motion; waits where the logged participant waited."""
        if self._is_stuck(now):
            return Wait(seconds=_PAUSE_S)
        self._arrive(now)
        if self._hand_actions and self._hand_actions[0][0] <= self.clock:
            _, action = self._hand_actions.pop(0)
            self.clock += self._handling
            return action
        return self._step(now) if self.clock < self._end else Wait(seconds=self._tick_s)

    @property
    def _end(self) -> int:
        return min(self.trial.ticks, (len(self._poses) - 1) * _EVERY)

    def _next(self) -> int:
        """Number of the logged pose that comes after the clock."""
        return min(self.clock // _EVERY + 1, len(self._poses) - 1)

    def _arrive(self, now: Observation) -> None:
        """Advance the clock to the logged pose that was reached, at most to the current tick."""
        while self.clock < min(now.tick, self._end):
            after = self._next()
            if not self._is_there(now.pose, self._poses[after]):
                if now.tick < after * _EVERY:  # on time, between two poses
                    self.clock = now.tick
                return
            due = self._hand_actions[0][0] if self._hand_actions else self._end
            if self.clock <= due < min(now.tick, after * _EVERY):
                self.clock = due
                return
            self.clock = min(now.tick, after * _EVERY)
            self._tries = 0

    def _step(self, now: Observation) -> Motion:
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
        """Whether a robot blocks the path; other obstacles are skipped after some tries."""
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


def _on(display: Display, what: str) -> object:
    """The contents of a part of the display; None while it is hidden."""
    return display.message if what == "panel" else display.map


def _extrapolated(poses: list[Pose], ticks: int) -> list[Pose]:
    """The poses, and one more by the last velocity if the trial ends after the last pose."""
    if (len(poses) - 1) * _EVERY >= ticks or len(poses) < 2:
        return poses
    a, b = poses[-2:]
    yaw, pitch = wrap(b.yaw - a.yaw), b.pitch - a.pitch
    return [*poses, Pose(x=2.0 * b.x - a.x, y=2.0 * b.y - a.y, yaw=b.yaw + yaw, pitch=b.pitch + pitch)]
