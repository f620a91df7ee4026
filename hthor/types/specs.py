"""Bodies, tasks and trials as data."""

from __future__ import annotations

from typing import Literal

import msgspec
from msgspec import Struct

from hthor.types.house import Pose, Vec2, Vec3

Relation = Literal["find", "on", "in", "at"]
"""How an object has to lie to what a job names: anywhere, once found; on or in a thing; or at a place."""
RELATIONS: tuple[Relation, ...] = ("find", "on", "in", "at")


class BodySpec(Struct, frozen=True, kw_only=True):
    """What a body can do, of a robot or of the person's avatar.

    ``eye`` [m] is the camera's height; ``fov`` [rad] its horizontal and vertical field of view; ``sight_range`` [m]
    bounds what its detector reports, ``scan_range`` [m] its range scan. ``reach`` [m] is horizontal, from the body's
    axis; ``reach_low`` and ``reach_high`` [m] bound the height of a grasp; ``strength`` [kg] what it can lift.
    ``handling`` [s] is how long pick, place, open and close take. ``pitch_limit`` [rad] bounds the camera either way.
    ``detector`` is how its detector errs unless a trial says otherwise, as `hthor.types.detector_specs.parse` reads it.
    """

    name: str
    title: str
    radius: float
    height: float
    eye: float
    fov: Vec2
    speed: float
    turn_rate: float
    sight_range: float
    scan_range: float
    scan_beams: int
    pitch_limit: float
    capabilities: frozenset[Literal["navigate", "pick", "open"]]
    reach: float = 0.0
    reach_low: float = 0.0
    reach_high: float = 0.0
    strength: float = 0.0
    handling: float = 1.0
    detector: str = "ideal"


class RobotSpec(BodySpec, frozen=True, kw_only=True):
    """A robot's body, one file each in ``hthor/world/robots``."""


class Placement(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Where an object starts: ``position`` [m] of its centre, and what it rests ``on`` or lies ``in``.

    ``near`` is the id of the thing or object that a scene prior wanted it near to, empty for one that is about
    ``support``.
    """

    id: str
    kind: str
    position: Vec3
    yaw: float = 0.0
    support: str = ""
    relation: Literal["on", "in"] = "on"
    near: str = ""

    def __post_init__(self) -> None:
        # Defaults are omitted by identity, which neither floats nor words keep on their way to another process.
        for name, default in _DEFAULTS:
            if getattr(self, name) == default:
                msgspec.structs.force_setattr(self, name, default)


_DEFAULTS = tuple(
    (field.name, field.default) for field in msgspec.structs.fields(Placement) if field.name in ("yaw", "relation")
)


class Job(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One thing to be done with one object, ``target``: find it, or bring it on, in or to where it belongs.

    ``destinations`` are the kinds or the ids of things, or the ids of rooms, any of which will do. ``place`` [m] is
    where exactly, where that matters. ``hands`` says how many bodies it takes to carry the object.
    """

    target: str
    relation: Relation
    destinations: tuple[str, ...] = ()
    place: Vec3 | None = None
    hands: int = 1


class Goal(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What ends a task well: find or place ``target`` (an object's id); ``destination`` is a thing's *kind*.

    Where there is more to do than one thing, ``jobs`` lists all of it, and the other fields tell the first of them.
    """

    target: str
    relation: Relation
    destination: str = ""
    jobs: tuple[Job, ...] = ()

    @property
    def todo(self) -> tuple[Job, ...]:
        """All there is to do, in every kind of task."""
        if self.jobs:
            return self.jobs
        destinations = (self.destination,) if self.destination else ()
        return (Job(target=self.target, relation=self.relation, destinations=destinations),)


class TaskSpec(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One task, as frozen data; ``t_star`` [s] is a good time by the shortest path, see `hthor.tasks.kind`.

    ``difficulty`` is easy, medium or hard, by the task alone; ``split`` says whether its house is one of the ten scenes
    (seen) or not (new). Both are empty in suites that do not tell.
    """

    id: str
    kind: str
    house: str
    house_sha256: str
    human_start: Pose
    robot_starts: tuple[Pose, ...]
    objects: tuple[Placement, ...]
    goal: Goal
    instruction: str
    time_limit: float
    t_star: float
    difficulty: Literal["", "easy", "medium", "hard"] = ""
    split: Literal["", "seen", "new"] = ""


class AgentRef(Struct, frozen=True, kw_only=True):
    """Which mind a robot has: a name, where it was loaded from, and the hash of its code."""

    name: str
    source: str
    sha256: str
    privileges: tuple[str, ...] = ()


class RobotSeat(Struct, frozen=True, kw_only=True):
    """One robot of a trial: its body and its mind. ``detector`` as `hthor.types.detector_specs.parse` reads it.

    ``camera`` is there only where it is not the body's own, as `hthor.types.cameras.parse` reads it.
    ``robot_sha256`` is the hash of the body's code: of the file of a user's own, of the syntax of one that ships
    with hthor.
    """

    seat: str
    robot: str
    agent: AgentRef
    detector: str = "own"
    robot_sha256: str = ""
    camera: str | msgspec.UnsetType = msgspec.UNSET


class TrialSpec(Struct, frozen=True, kw_only=True):
    """Everything that decides a trial's course; its content hash is the trial's key.

    ``assets_sha256`` is the hash of what the robots' pictures show and of what draws it, empty where no mind is known
    to take pictures;
    ``kind_sha256`` that of a user's own file of the task's kind, empty for a kind that ships with hthor. ``realtime``
    is there only where robots' thinking took time of the trial, ``step_limit_s`` only where submitted agents had
    another deadline for each action than usual [s].
    """

    task: TaskSpec
    robots: tuple[RobotSeat, ...]
    human: str
    human_sha256: str
    participant: int
    index: int
    seed: int
    suite_sha256: str
    rules_sha256: str
    code_sha256: str
    assets_sha256: str = ""
    kind_sha256: str = ""
    realtime: bool | msgspec.UnsetType = msgspec.UNSET
    step_limit_s: float | msgspec.UnsetType = msgspec.UNSET
