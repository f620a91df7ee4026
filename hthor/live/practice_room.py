"""The room in which people practise before a session, and the trial that takes place in it.

The room is a house of its own, of one room, which is found only by its path: it is none of the benchmark's houses.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from pathlib import Path

import msgspec

from hthor.houses import HouseLibrary
from hthor.live.wire import PRACTICE
from hthor.tasks.arrangement.placement import place_on, supports_of
from hthor.types import AgentRef, Goal, HouseSpec, Placement, Pose, RobotSeat, TaskSpec, TrialSpec

FILE = Path(__file__).with_name("practice_room.json")
FRIDGE, TABLE, COUNTER = "fridge", "dining_table", "counter_top"
APPLE, MUG = "apple", "mug"
TIME_LIMIT_S = 3600.0
"""[s] So long that it ends no practice in which somebody is still there. Our choice."""
_HUMAN_START = Pose(x=1.5, y=0.9, yaw=1.2)
_ROBOT_START = Pose(x=2.7, y=2.0, yaw=-0.35, pitch=-0.1)
"""In front of the table, with the apple in its picture."""
_SCOUT = RobotSeat(seat="robot", robot="scout", agent=AgentRef(name="", source="", sha256=""))
_GUIDE = AgentRef(name="guide", source="hthor.live.practice", sha256="", privileges=("house_map",))


def practice_trial(first: TrialSpec, people: Collection[str]) -> TrialSpec:
    """The practice of a session.

    Args:
        first: the session's first trial, whose first robot's body the guide has; the scout's without robots.
        people: the seats of those who practise. A simulated person in an earlier seat stands still.
    """
    last = max(place for place, human in enumerate(first.humans) if human.seat in people)
    robot = next((seat for seat in first.robots if seat.robot), _SCOUT)
    return msgspec.structs.replace(
        first,
        task=_task(HouseLibrary().load(FILE)),
        robots=(msgspec.structs.replace(robot, agent=_GUIDE),),
        humans=first.humans[: last + 1],
        index=PRACTICE,
        clock=msgspec.UNSET,  # the guide is asked in lock-step, as its answers take no time
        step_limit_s=msgspec.UNSET,
        attempt=msgspec.UNSET,
    )


def _task(room: HouseSpec) -> TaskSpec:
    """A task that nothing solves: its destination is not in the room."""
    return TaskSpec(
        id="practice",
        kind="mobile_manipulation",
        house=str(FILE),
        house_sha256=room.sha256,
        human_start=_HUMAN_START,
        robot_starts=(_ROBOT_START,),
        objects=(_on(room, TABLE, APPLE, 0.55, -0.4), _on(room, COUNTER, MUG, 0.4, 0.2)),
        goal=Goal(target=APPLE, relation="on", destination="bed"),
        instruction="Try each control once.",
        time_limit=TIME_LIMIT_S,
        t_star=1.0,
    )


def _on(room: HouseSpec, support: str, kind: str, u: float, v: float) -> Placement:
    """An object on top of a thing, at shares ``u`` and ``v`` in [-1, 1] of it."""
    thing = next(one for one in room.things if one.id == support)
    top = next(rest for rest in supports_of(thing) if not rest.surface.inside)
    return place_on(kind, top, u, v, math.radians(30.0))
