"""What the all-knowing person needs for tasks in which a body has to go to a landmark and stop there."""

from __future__ import annotations

import msgspec
import numpy as np
from numpy.typing import NDArray

from hthor import rules
from hthor.episode.standstill import Standstill
from hthor.tasks.arrangement.reachability import ReachableFloor
from hthor.tasks.kind import TaskKind
from hthor.types import HUMAN, WALKERS, HouseSpec, Job, Snapshot, TaskSpec, Vec2

BESIDE_M = 0.8
"""How near [m] the person goes to a landmark's edge."""


def in_the_persons_place(task: TaskSpec) -> TaskSpec:
    """The task with a person who walks; where a robot has to, the person begins at its start."""
    if task.goal.relation != "go" or WALKERS[task.goal.target] == HUMAN:
        return task
    goal = msgspec.structs.replace(task.goal, target="person_1")
    return msgspec.structs.replace(task, goal=goal, human_start=task.robot_starts[0])


def spots_at_end(house: HouseSpec, ground: ReachableFloor, here: Vec2, job: Job) -> NDArray[np.float64]:
    """(N, 2) [m] Spots beside a thing of the destination's kind, in its room, that can be reached from ``here``."""
    spots = [np.zeros((0, 2))]
    for thing in house.things:
        room = next((room for room in house.rooms if room.id == thing.room), None)
        if thing.kind in job.destinations and room is not None:
            mask = ground.beside(thing, BESIDE_M) & ground.space.room_mask(room) & ground.space.component(*here)
            spots.append(ground.space.centres(mask))
    return np.concatenate(spots)


class MetTest:
    """Whether a task's goal is met, tick by tick: at once, or after the person has stood still for long enough."""

    def __init__(self, kind: TaskKind, task: TaskSpec, house: HouseSpec) -> None:
        self.kind, self.task, self.house = kind, task, house
        seat = kind.stopper(task.goal)
        self.stand = Standstill(seat, round(kind.stop_s / rules.TICK_S)) if seat else None

    def __call__(self, snapshot: Snapshot) -> bool:
        """Whether it is met now; call at every tick."""
        met = self.kind.met(self.task, snapshot, self.house)
        return met and (self.stand is None or self.stand.lasts(snapshot))
