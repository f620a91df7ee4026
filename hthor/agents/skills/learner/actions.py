"""The numbered actions of a robot that learns, and which of them make sense now.

An action is one motion, which runs until the body is free again, or one message. Illegal actions do no harm: the rules
of the simulator refuse them, which costs one tick and has a reason.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import catalog, rules
from hthor.agents.skills.learner.known_things import KnownThings, target_id
from hthor.agents.skills.message_timing import sighting_text
from hthor.types import (
    Action,
    BodySpec,
    Close,
    Drop,
    Job,
    Motion,
    Move,
    Observation,
    Open,
    Pick,
    Place,
    Rotate,
    Send,
    Vec3,
    Wait,
)

WAIT_S = 1.0
"""[s] How long the action "wait" lasts."""
FORWARD_M, BACK_M = rules.MOVE_MAX_M, 0.25
"""[m] How far "forward" and "back" go."""
TURN_RAD, TILT_RAD = math.radians(30.0), math.radians(15.0)
"""[rad] By how much the body turns and the camera tilts."""
WALKING: dict[str, Motion] = {
    "wait": Wait(seconds=WAIT_S),
    "forward": Move(forward=FORWARD_M),
    "back": Move(forward=-BACK_M),
    "turn left": Rotate(yaw=TURN_RAD),
    "turn right": Rotate(yaw=-TURN_RAD),
    "look up": Rotate(pitch=TILT_RAD),
    "look down": Rotate(pitch=-TILT_RAD),
}
"""The actions that every robot has; "wait" is always number 0."""
PATIENCE_S = 10.0
"""[s] So long "tell" makes no sense after a message that nobody has answered, as a new message covers the last one."""
_OPEN_TICKS = round(PATIENCE_S / rules.TICK_S)
_EPS = 1e-9


class Choice(Struct, frozen=True, kw_only=True):
    """What a number stands for; ``refused`` says why it stands for nothing and the body waits for a tick instead."""

    action: Action
    refused: str = ""


def action_names(body: BodySpec, jobs: int, talks: bool = True) -> tuple[str, ...]:
    """The names of a body's actions in the order of their numbers.

    After those of `WALKING` come, for each of the task's jobs counted from 1, "tell N": a message to all people about
    the object in view; for a body with an arm "take N": pick up the object, then "put": place what it holds where that
    belongs, and "drop"; for a body that can open things, "open" and "close": the nearest such thing in view.
    """
    numbers = range(1, jobs + 1)
    tell = [f"tell {number}" for number in numbers if talks]
    hands = [*(f"take {number}" for number in numbers), "put", "drop"] if "pick" in body.capabilities else []
    return (*WALKING, *tell, *hands, *(("open", "close") if "open" in body.capabilities else ()))


class RobotActions:
    """A robot's actions in one trial, in which it knows ``things`` and has ``jobs``."""

    def __init__(self, names: tuple[str, ...], body: BodySpec, jobs: tuple[Job, ...], things: KnownThings) -> None:
        self.names, self._body, self._jobs, self._things = names, body, jobs, things
        self._hands: dict[str, Callable[[Observation], tuple[Motion, bool]]] = {
            "put": self._put,
            "drop": lambda seen: (Drop(), bool(seen.holding)),
            "open": lambda seen: self._door(seen, Open, "closed"),
            "close": lambda seen: self._door(seen, Close, "open"),
        }

    def mask(self, seen: Observation) -> NDArray[np.int8]:
        """(number of actions,) int8: 1 for what is legal now; while the body is busy, only "wait" is, which goes on."""
        if not seen.idle:
            return np.array([number == 0 for number in range(len(self.names))], np.int8)
        return np.array([self._is_legal(name, seen) for name in self.names], np.int8)

    def choose(self, number: Any, seen: Observation) -> Choice:
        """What a number stands for; anything that is no number of an action stands for nothing."""
        place = _whole(number)
        if place is None or not 0 <= place < len(self.names):
            given = number.item() if isinstance(number, np.generic) else number
            return _nothing(f"an action is a whole number from 0 to {len(self.names) - 1}, got {given!r:.40}")
        name = self.names[place]
        if name in WALKING:
            return Choice(action=Action(motion=WALKING[name]))
        if name in self._hands:
            return Choice(action=Action(motion=self._hands[name](seen)[0]))
        verb, _, count = name.partition(" ")
        if int(count) > len(self._jobs):
            return _nothing(f"the task has no job {count}")
        job = self._jobs[int(count) - 1]
        return self._tell(job, seen) if verb == "tell" else Choice(action=Action(motion=Pick(object=target_id(job))))

    def _is_legal(self, name: str, seen: Observation) -> bool:
        if name in ("look up", "look down"):
            tilt = TILT_RAD if name == "look up" else -TILT_RAD
            return abs(seen.pose.pitch + tilt) <= self._body.pitch_limit + _EPS
        if name in WALKING:
            return True
        if name in self._hands:
            return self._hands[name](seen)[1]
        verb, _, count = name.partition(" ")
        if int(count) > len(self._jobs):
            return False
        job = self._jobs[int(count) - 1]
        if verb == "take":
            return self._can_take(job, seen)
        return self._things.topic(job, here(seen)) is not None and not _waits_for_answer(seen)

    def _tell(self, job: Job, seen: Observation) -> Choice:
        topic = self._things.topic(job, here(seen))
        if topic is None:
            return _nothing(f"{job.target} is not in view, so there is nothing to tell")
        kinds = {one.id: one.kind for one in self._things.last.values() if one.family == "furniture"}
        text = sighting_text(topic, kinds)
        return Choice(action=Action(motion=Wait(), say=Send(text=text, object=topic.id, position=topic.position)))

    def _can_take(self, job: Job, seen: Observation) -> bool:
        """Whether the hand is free, and the object in view, in nobody's hands, in reach, in front and light enough."""
        body, id = self._body, target_id(job)
        if seen.holding or id not in self._things.view:
            return False
        found = self._things.last[id]
        light = found.family == "object" and catalog.kind(found.kind).mass <= body.strength
        free = not found.held_by and not found.bearers
        return light and free and _in_reach(body, seen, found.position)

    def _put(self, seen: Observation) -> tuple[Motion, bool]:
        """Place what is held where it belongs, if that is known and in view close by; else on what is not there."""
        job = next((job for job in self._jobs if target_id(job) == seen.holding), None)
        found = None if job is None else self._things.destination(job, here(seen))
        if found is None or not seen.holding:
            return Place(on=found.id if found is not None else ""), False
        close = math.hypot(found.position[0] - seen.pose.x, found.position[1] - seen.pose.y)
        half = math.hypot(*found.size[:2]) / 2
        legal = found.id in self._things.view and close <= self._body.reach + half and found.state != "closed"
        return Place(on=found.id), legal

    def _door(self, seen: Observation, motion: type[Open] | type[Close], state: str) -> tuple[Motion, bool]:
        """Open or close the nearest thing in view that is in this state."""
        found = self._things.openable(state, here(seen))
        if found is None:
            return motion(thing=""), False
        close = math.hypot(found.position[0] - seen.pose.x, found.position[1] - seen.pose.y)
        return motion(thing=found.id), close <= self._body.reach + math.hypot(*found.size[:2]) / 2


def _waits_for_answer(seen: Observation) -> bool:
    """Whether the robot's last message is new and open; another one would cover it."""
    receipt = seen.receipt
    return receipt is not None and receipt.status in ("sent", "shown") and seen.tick < receipt.tick + _OPEN_TICKS


def here(seen: Observation) -> Vec3:
    """Where the body is [m], on the floor."""
    return (seen.pose.x, seen.pose.y, 0.0)


def _in_reach(body: BodySpec, seen: Observation, point: Vec3) -> bool:
    """Whether a hand reaches a point [m], by the rule of the simulator."""
    dx, dy, yaw = point[0] - seen.pose.x, point[1] - seen.pose.y, seen.pose.yaw
    in_front = dx * math.cos(yaw) + dy * math.sin(yaw) >= 0.0
    return in_front and math.hypot(dx, dy) <= body.reach and body.reach_low <= point[2] <= body.reach_high


def _whole(number: Any) -> int | None:
    """A whole number, also as a NumPy array of one element; None for anything else."""
    if isinstance(number, np.ndarray) and number.size == 1:
        number = number.reshape(-1)[0]
    return int(number) if isinstance(number, (int, np.integer)) and not isinstance(number, bool) else None


def _nothing(reason: str) -> Choice:
    return Choice(action=Action(), refused=reason)
