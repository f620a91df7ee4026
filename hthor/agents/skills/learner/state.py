"""The state of a robot that learns as one vector of numbers from -1 to 1.

It has what the robot itself knows, no more than an agent of the same privileges would. `state_fields` gives the place
of each field. Directions are in the robot's own frame, x forward and y to the left.
"""

import math
from collections.abc import Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import catalog
from hthor.agents.skills.learner.actions import here
from hthor.agents.skills.learner.known_things import KnownThings, target_id
from hthor.agents.skills.learner.walking_distance import WalkingDistance
from hthor.geometry.plane import turn
from hthor.types import Briefing, Job, Observation, Pose, Vec3

HOUSE_M, FAR_M, HIGH_M, WAY_M = 25.0, 10.0, 2.0, 20.0
"""[m] What counts as 1: of the position in the house, of horizontal offsets, of heights, and of ways."""
SECTORS = 16
"""Into so many parts of the field of view the range scan is divided, from right to left; each has its least range."""
AROUND, AROUND_M, CELL_M = 8, 1.0, 0.5
"""At so many places in a circle of this radius [m] the state has whether the robot has been there, in cells of 0.5 m.
The first is straight ahead, the others follow to the left."""
STATUSES = ("sent", "shown", "accepted", "declined", "covered", "answered")
"""The statuses of the robot's last message in the order of the field ``receipt``."""
_HEAD = {
    "time": 1,
    "pose": 5,
    "outcome": 2,
    "scan": SECTORS,
    "visited": AROUND,
    "holding": 1,
    "person": 4,
    "receipt": len(STATUSES),
}
_JOB = {"kind": len(catalog.TARGETS), "target": 5, "held": 2, "destination": 4, "way": 3}


class Field(Struct, frozen=True, kw_only=True):
    """The place of a field in the state: ``state[start:stop]``."""

    name: str
    start: int
    stop: int


def state_fields(jobs: int) -> tuple[Field, ...]:
    """The fields of the state for tasks of at most so many jobs, in order.

    - ``time``: the share of the time limit that is over.
    - ``pose``: x and y in the house frame, divided by `HOUSE_M`; cosine and sine of the heading; pitch of the camera as
      a share of the body's limit, up positive.
    - ``outcome``: whether the last motion succeeded; whether something stopped it or a rule refused it.
    - ``scan``: the least range in each of the `SECTORS`, as a share of the scan's limit.
    - ``visited``: at each of the places `AROUND` the robot, 1 if it has been there.
    - ``holding``: 1 with something in hand.
    - ``person``: of the person seen nearest: 1 if one was seen, 1 if in view now, forward and left by `FAR_M`.
    - ``receipt``: 1 at the status of the last message in `STATUSES`; all 0 before the first.
    - For each job, with its number from 1 after the name: ``kind``, 1 at the object's place in `hthor.catalog.TARGETS`;
      ``target``: 1 if its place is known, 1 if in view, forward and left by `FAR_M`, height by `HIGH_M`; ``held``: 1
      if the robot has it in hand, 1 if somebody else has; ``destination``: of the nearest known thing where it belongs,
      1 if there is one, 1 if it is in view, forward and left by `FAR_M`; ``way``: with the privileges ``house_map`` and
      ``object_poses``, the length of the shortest way to the object by `WAY_M`, and cosine and sine of where it begins.
    """
    fields, start = list[Field](), 0
    sizes = [*_HEAD.items(), *((f"{name} {job + 1}", size) for job in range(jobs) for name, size in _JOB.items())]
    for name, size in sizes:
        fields.append(Field(name=name, start=start, stop=start + size))
        start += size
    return tuple(fields)


def state_size(jobs: int) -> int:
    """How many numbers the state has."""
    return sum(_HEAD.values()) + jobs * sum(_JOB.values())


class RobotState:
    """Makes the state of one robot in one trial; ``jobs`` is the number of jobs that the vector has room for."""

    def __init__(self, briefing: Briefing, jobs: int, things: KnownThings) -> None:
        self._briefing, self._jobs, self._things = briefing, jobs, things
        known = briefing.house is not None and "object_poses" in briefing.privileges
        self._walk = WalkingDistance(briefing.house, briefing.body) if known and briefing.house is not None else None
        self._sectors = _sectors(briefing.body.scan_beams)
        self._visited: set[tuple[int, int]] = set()
        limits = sum(phase.time_limit for phase in briefing.phases) + briefing.time_limit
        self._limit_ticks = limits / briefing.tick_s

    def see(self, seen: Observation) -> None:
        """Note where the robot is."""
        self._visited.add(_cell(seen.pose.x, seen.pose.y))

    def vector(self, seen: Observation) -> NDArray[np.float32]:
        """(size,) float32, all finite and from -1 to 1."""
        numbers = np.zeros(state_size(self._jobs))
        known = [
            *self._own(seen),
            *(one for job in self._briefing.todo[: self._jobs] for one in self._of_job(job, seen)),
        ]
        numbers[: len(known)] = known
        return np.clip(np.nan_to_num(numbers, posinf=1.0, neginf=-1.0), -1.0, 1.0).astype(np.float32)

    def _own(self, seen: Observation) -> Iterator[float]:
        pose, body = seen.pose, self._briefing.body
        yield seen.tick / self._limit_ticks
        yield from (pose.x / HOUSE_M, pose.y / HOUSE_M, math.cos(pose.yaw), math.sin(pose.yaw))
        yield pose.pitch / (body.pitch_limit or 1.0)
        ended = seen.outcome
        yield from (0.0, 0.0) if ended is None else (float(ended.ok), float(not ended.ok))
        scan = seen.scan
        yield from (np.minimum.reduceat(scan.ranges, self._sectors) / scan.limit).tolist()
        yield from self._around(pose)
        yield float(bool(seen.holding))
        person = self._things.person(here(seen))
        yield from self._spot(None if person is None else person.id, pose)
        status = "" if seen.receipt is None else seen.receipt.status
        yield from (float(status == one) for one in STATUSES)

    def _around(self, pose: Pose) -> Iterator[float]:
        for number in range(AROUND):
            angle = pose.yaw + 2.0 * math.pi * number / AROUND
            spot = pose.x + AROUND_M * math.cos(angle), pose.y + AROUND_M * math.sin(angle)
            yield float(_cell(*spot) in self._visited)

    def _of_job(self, job: Job, seen: Observation) -> Iterator[float]:
        things, pose, id = self._things, seen.pose, target_id(job)
        found, position = things.last.get(id), things.position(id)
        kind = found.kind if found is not None else catalog_kind(job.target)
        yield from (float(kind == one) for one in catalog.TARGETS)
        yield from self._spot(id, pose)
        yield 0.0 if position is None else position[2] / HIGH_M
        holder = things.holder(id)
        yield from (float(seen.holding == id), float(holder not in ("", self._briefing.seat)))
        destination = things.destination(job, here(seen))
        yield from self._spot(None if destination is None else destination.id, pose)
        yield from self._way(position, pose)

    def _spot(self, id: str | None, pose: Pose) -> tuple[float, float, float, float]:
        """Whether the place of a thing is known, whether it is in view, and where it is from the robot."""
        position = None if id is None else self._things.position(id)
        if position is None:
            return (0.0, 0.0, 0.0, 0.0)
        forward, left = turn((position[0] - pose.x, position[1] - pose.y), -pose.yaw)
        return (1.0, float(id in self._things.view), forward / FAR_M, left / FAR_M)

    def _way(self, position: Vec3 | None, pose: Pose) -> tuple[float, float, float]:
        if self._walk is None or position is None:
            return (0.0, 0.0, 0.0)
        way = self._walk.way((pose.x, pose.y), position[:2])
        forward, left = turn((way.first[0] - pose.x, way.first[1] - pose.y), -pose.yaw)
        length = math.hypot(forward, left)
        aim = (forward / length, left / length) if length > 0.0 else (0.0, 0.0)
        return (way.metres / WAY_M, *aim)


def catalog_kind(id: str) -> str:
    """The kind in the id of an object, such as "apple" for "apple_2"."""
    stem = id.rstrip("0123456789").rstrip("_|")
    return stem if stem in catalog.TARGETS else id


def _sectors(beams: int) -> NDArray[np.int64]:
    """The first beam of each sector; with fewer beams than sectors, some share one."""
    sizes = [len(part) for part in np.array_split(np.arange(beams), SECTORS)]
    firsts: NDArray[np.int64] = np.minimum(np.cumsum([0, *sizes[:-1]]), beams - 1)
    return firsts


def _cell(x: float, y: float) -> tuple[int, int]:
    return math.floor(x / CELL_M), math.floor(y / CELL_M)
