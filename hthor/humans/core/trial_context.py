"""The person in one trial: their traits, their body and this moment's observation."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from typing import Any

from hthor import seeds
from hthor.geometry.plane import wrap
from hthor.humans.core.policy import Policy
from hthor.humans.population.parameters import Parameters
from hthor.navigation.path_follower import face
from hthor.types import HUMAN, Briefing, Event, Motion, Observation, Rotate, Vec2, Vec3, Wait

Deed = Generator[Motion, None, bool]
"""Something done motion by motion, that tells in the end whether it worked out."""

GAZE_PITCH = -0.25
"""Where people look while they walk [rad], a little down."""
_GLANCE_S = 0.3
_AIM_RAD = 0.05


class Subject:
    """What every part of a person shares. ``now`` is replaced before each decision.

    ``policy`` decides in the person's place, None for their own way of deciding. ``journal`` is what a headset's
    recorder would hold of this trial. ``think`` is told of beliefs and choices, None when nobody looks into the mind.
    """

    now: Observation

    def __init__(self, traits: Parameters, root: int, briefing: Briefing, policy: Policy | None = None) -> None:
        self.traits, self.root, self.task, self.body = traits, root, briefing, briefing.body
        self.tick_s = briefing.tick_s
        self.policy = policy
        self.journal: list[Event] = []
        self.think: Callable[[Event], None] | None = None

    def note(self, kind: str, **data: Any) -> Event:
        """Write something down in the journal, under the tick of now; what was written, for what follows from it."""
        self.journal.append(Event(tick=self.now.tick, seat=HUMAN, kind=kind, data=data))
        return self.journal[-1]

    @property
    def here(self) -> Vec2:
        """Where the person stands [m]."""
        return self.now.pose.x, self.now.pose.y

    def draw(self, *names: seeds.Name) -> float:
        """Uniform chance of this trial, by name."""
        return seeds.draw(self.root, *names)

    def normal(self, *names: seeds.Name) -> float:
        """Standard normal chance of this trial, by name."""
        return seeds.normal(self.root, *names)

    def rest(self, seconds: float) -> Iterator[Motion]:
        """Stand still, in short pieces, so that the eyes go on."""
        left = round(seconds / self.tick_s)
        piece = round(_GLANCE_S / self.tick_s)
        while left > 0:
            ticks = min(piece, left)
            left -= ticks
            yield Wait(seconds=ticks * self.tick_s)

    def turn(self, yaw: float, pitch: float = 0.0) -> Rotate:
        """The part of a turn that one tick allows; both angles [rad] end together."""
        most = min(self.traits.omega, self.body.turn_rate) * self.tick_s
        share = min(1.0, most / max(abs(yaw), abs(pitch), 1e-9))
        return Rotate(yaw=yaw * share, pitch=pitch * share)

    def look_at(self, point: Vec3) -> Iterator[Motion]:
        """Turn until ``point`` [m] is in the middle of the view."""
        for _ in range(100):
            aim = face(self.now.pose, point, self.body.eye, self.body.pitch_limit)
            if aim is None or max(abs(aim.yaw), abs(aim.pitch)) < _AIM_RAD:
                return
            yield self.turn(aim.yaw, aim.pitch)

    def look_round(self, angle: float, name: str, number: int) -> Iterator[Motion]:
        """Turn by ``angle`` [rad] in one go, to the side that chance names."""
        left = angle if self.draw("side", name, number) < 0.5 else -angle
        while abs(left) > _AIM_RAD:
            step = self.turn(left, GAZE_PITCH - self.now.pose.pitch if abs(left) > 0.5 else 0.0)
            left -= step.yaw
            yield step

    def bearing(self, yaw: float) -> float:
        """How far [rad] a direction lies off the heading."""
        return wrap(yaw - self.now.pose.yaw)


def run(motions: Iterator[Motion]) -> Generator[Motion, Any, bool]:
    """Motions as a deed that works out."""
    yield from motions
    return True
