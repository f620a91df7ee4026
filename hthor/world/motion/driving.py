"""Driving: a body keeps a velocity and a direction of its head until another motion replaces them.

A tick has `hthor.types.SUBTICKS` steps, in each of which the bodies that drive go one after another in the order of the
seats, before all other motions of the tick. A step is that of a `Move`, only shorter (`hthor.world.motion.steps`). A
body that carries something jointly makes one step a tick instead, the last, as in a `Move`.

A person's head points where it was measured at once, up to straight up or down; the body turns after it at its turn
rate. A robot has no neck: its body turns to the heading and its camera tilts to the pitch, both at its turn rate. While
the hands are busy a body stands, and only its head moves.

Each contact is reported once, not in every step: the event ``in_way`` names another body, also one
that it slides past; ``blocked`` names what stops it. A contact ends when the body has gone `CLEAR_M` without sliding
along anything, or when it is steered elsewhere by more than `AWAY_RAD`, or stands. Its outcome says what stops it, and
is ok as soon as it goes on.
"""

import math
from collections.abc import Callable, Sequence
from typing import Protocol

from msgspec import UNSET

from hthor import rules
from hthor.geometry.plane import turn, wrap
from hthor.types import SUBTICKS, Drive, Outcome, Pose, Vec2
from hthor.types.events import Blocked, Event, InWay
from hthor.world import numbers
from hthor.world.motion.locomotion import Culprit, clip
from hthor.world.motion.steps import FREE, HOUSE, go, slide
from hthor.world.records import Driving
from hthor.world.state.body_state import BodyState

CLEAR_M = 0.1
"""[m] How far a body goes until a contact has ended; our choice, more than a body creeps towards a wall it leans on."""
AWAY_RAD = math.radians(30.0)
"""[rad] A body that is steered away by more than this from where it was going has a new contact; our choice, more than
a measured head sways.
"""
LOAD = "load"
"""What stops a body that holds something which its bearers cannot lift."""
_STEP_S = rules.TICK_S / SUBTICKS
_DROVE = Outcome(motion="drive", ok=True)
_BEGIN = Driving(Drive())


class JointLoads(Protocol):
    """The things that bodies carry jointly; `hthor.world.carrying.joint_carrying.JointCarrying`."""

    def pace(self, seat: BodyState) -> float | None:
        """[m/s] The speed at which a body goes with the thing that it holds by a handle; None if it holds none so."""

    def stuck(self, seat: BodyState) -> str:
        """Why a body cannot move because of the thing that it holds; empty when it can."""

    def go(self, seat: BodyState, step: Vec2, length: float, tick: int) -> tuple[str, bool]:
        """Go by ``step`` [m] with the thing, or slide.

        Returns:
            what is in the way, ``LOAD`` for what the bearers cannot lift, and whether the body had to stay.
        """


class DriveMotion:
    """The set-point of one body, and what the body is in contact with.

    Args:
        others: all other bodies. loads: what bodies carry jointly. culprit: names an obstacle.
        state: a state to go on from.
    """

    def __init__(
        self,
        seat: BodyState,
        others: Sequence[BodyState],
        loads: JointLoads,
        culprit: Culprit,
        state: Driving = _BEGIN,
    ) -> None:
        self._seat, self._others, self._loads, self._culprit = seat, others, loads, culprit
        self._met, self._towards, self._clear = set(state.met), state.towards, state.clear
        self._set(state.drive)

    def keep(self, drive: Drive) -> None:
        """Take over a set-point, whatever its numbers are."""
        self._set(drive)
        (ax, ay), (bx, by) = self._along, self._towards
        if self._met and ax * bx + ay * by < math.cos(AWAY_RAD):
            self._part()

    def state(self) -> Driving:
        return Driving(self._drive, tuple(sorted(self._met)), self._towards, self._clear)

    def step(self, tick: int, last: bool) -> tuple[Event, ...]:
        """Make one of the steps of a tick, ``last`` the last of them."""
        seat = self._seat
        busy = seat.activity is not None
        self._look(busy)
        if busy or not self._speed:
            return ()
        pace = self._loads.pace(seat) if seat.holding else None
        if pace is None:
            length = self._speed * _STEP_S
            step = (self._along[0] * length, self._along[1] * length)
            met = go(seat, self._others, *step, _STEP_S)
            stuck = met != FREE and not slide(seat, self._others, step, length, _STEP_S)
        elif last:
            length = min(self._speed, pace) * rules.TICK_S
            step = (self._along[0] * length, self._along[1] * length)
            met, stuck = self._loads.go(seat, step, length, tick)
        else:
            return ()
        if not stuck and _is_stopped(seat):
            seat.outcome = _DROVE
        if stuck or met not in (FREE, HOUSE):
            return self._touch(tick, met, stuck, step)
        if self._met and met == FREE:
            self._clear += length
            if self._clear >= CLEAR_M:
                self._part()
        return ()

    def _set(self, drive: Drive) -> None:
        given = (drive.forward, drive.left, drive.yaw, drive.pitch)
        forward, left, yaw, pitch = (float(value) if numbers.is_finite(value) else 0.0 for value in given)
        yaw, pitch = wrap(yaw), clip(pitch, math.pi / 2)
        self._drive = Drive(forward=forward, left=left, yaw=yaw, pitch=pitch)
        self._speed, self._along = 0.0, (0.0, 0.0)
        most = max(abs(forward), abs(left))
        if most and "navigate" in self._seat.spec.capabilities:
            u, v = forward / most, left / most
            share = math.hypot(u, v)
            self._speed = min(share * most, self._seat.spec.speed)
            self._along = turn((u / share, v / share), yaw)

    def _look(self, busy: bool) -> None:
        """Turn the head, and the body unless its hands are ``busy``."""
        seat, aim, pose = self._seat, self._drive, self._seat.pose
        most = seat.spec.turn_rate * _STEP_S
        if "navigate" not in seat.spec.capabilities or (pose.yaw, pose.pitch, pose.head) == (aim.yaw, aim.pitch, UNSET):
            return
        yaw = pose.yaw if busy else _turned(pose.yaw, aim.yaw, most)
        if seat.has_neck:
            pitch, head = aim.pitch, wrap(aim.yaw - yaw) or UNSET
        else:
            pitch, head = _turned(pose.pitch, clip(aim.pitch, seat.spec.pitch_limit), most), UNSET
        if (yaw, pitch, head) != (pose.yaw, pose.pitch, pose.head):  # a new record says that the body has moved
            seat.pose = Pose(x=pose.x, y=pose.y, yaw=yaw, pitch=pitch, head=head)

    def _touch(self, tick: int, met: str, stuck: bool, step: Vec2) -> tuple[Event, ...]:
        """Note what is in the way; the event of a new contact.

        The tick of ``in_way`` is the one before the step: up to that tick the other body had no effect.
        """
        seat, new = self._seat, met not in self._met
        self._clear = 0.0
        if not new and (not stuck or _is_stopped(seat)):
            return ()
        if not self._met:
            self._towards = self._along
        self._met.add(met)
        by = self._culprit(seat, step) if met == HOUSE else "" if met == LOAD else met
        if stuck:
            reason = "blocked" if met == HOUSE else self._loads.stuck(seat) if met == LOAD else f"{met} is in the way"
            seat.outcome = Outcome(motion="drive", ok=False, reason=reason, by=by)
        if not new or met == LOAD:
            return ()
        if met == HOUSE:
            return (Blocked(tick=tick, seat=seat.name, by=by),)
        return (InWay(tick=tick - 1, seat=seat.name, by=by),)

    def _part(self) -> None:
        """End the contact."""
        self._met.clear()
        self._clear = 0.0
        if _is_stopped(self._seat):
            self._seat.outcome = _DROVE


class DrivenBodies:
    """The bodies of one world that drive.

    Args:
        seats: all bodies, in order. loads, culprit: see `DriveMotion`.
        follow: called with the id of what a body holds after the body has moved.

    Attributes:
        active: the bodies that drive, in order. steps: how many steps of the tick are done.
    """

    def __init__(
        self, seats: Sequence[BodyState], loads: JointLoads, culprit: Culprit, follow: Callable[[str], None]
    ) -> None:
        self._seats, self._loads, self._culprit, self._follow = tuple(seats), loads, culprit, follow
        self.active: list[BodyState] = []
        self.steps = 0

    def reset(self) -> None:
        """Begin an episode, after the bodies were cleared."""
        self.active, self.steps = [], 0

    def start(self, seat: BodyState, drive: Drive) -> None:
        """Set a body's set-point; a motion under way ends unless it is one of the hands."""
        if seat.activity is not None and not seat.activity.of_hands:
            seat.activity = None
        if seat.drive is None:
            self.resume(seat, _BEGIN)
        assert seat.drive is not None
        seat.drive.keep(drive)

    def stop(self, seat: BodyState) -> None:
        """Let a body drive no longer."""
        seat.drive = None
        self.active = [one for one in self._seats if one.drive is not None]

    def resume(self, seat: BodyState, state: Driving) -> None:
        """Let a body drive on from a state."""
        others = [one for one in self._seats if one is not seat]
        seat.drive = DriveMotion(seat, others, self._loads, self._culprit, state)
        self.active = [one for one in self._seats if one.drive is not None]

    def step(self, tick: int) -> list[Event]:
        """Make one of the steps of ``tick`` unless all are done; its events."""
        events: list[Event] = []
        if self.steps >= SUBTICKS:
            return events
        self.steps += 1
        for seat in self.active:
            pose = seat.pose
            assert seat.drive is not None
            events += seat.drive.step(tick, self.steps == SUBTICKS)
            if seat.holding and seat.pose is not pose:
                self._follow(seat.holding)
        return events

    def finish(self, tick: int) -> list[Event]:
        """Make the steps of ``tick`` that are left; their events."""
        events: list[Event] = []
        while self.active and self.steps < SUBTICKS:
            events += self.step(tick)
        self.steps = 0
        return events


def _is_stopped(seat: BodyState) -> bool:
    """Whether the seat's outcome says that its drive is stopped."""
    return seat.outcome is not None and seat.outcome.motion == "drive" and not seat.outcome.ok


def _turned(yaw: float, aim: float, most: float) -> float:
    """``yaw`` turned towards ``aim`` by at most ``most`` [rad]."""
    off = wrap(aim - yaw)
    return aim if abs(off) <= most else wrap(yaw + math.copysign(most, off))
