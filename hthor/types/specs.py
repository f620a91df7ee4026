"""Bodies, tasks and trials as data."""

from typing import Final, Literal

import msgspec
from msgspec import Struct

from hthor.types.house import HUMAN, Pose, Vec2, Vec3

Relation = Literal["find", "on", "in", "at", "back", "go"]
"""What a job demands of an object: to be found anywhere, to lie on or in a thing, to be at a place, or to be back where
it was in an earlier phase of the task, which nobody is told; of a body: to go to a thing and stop there. A `Goal` never
has "back"; only briefings do."""
LOCKSTEP: Final = "lockstep"
RELATIONS: tuple[Relation, ...] = ("find", "on", "in", "at", "back", "go")
WALKERS = {"person_1": HUMAN, "robot_1": "robot"}
"""The targets of jobs with the relation "go", and the seats of these bodies: the first person, the first robot."""
Clock = Literal["lockstep", "charged", "concurrent"]
"""Decision clocks: the world waits for agents; it charges their time to the trial; or it goes on while they decide."""


class BodySpec(Struct, frozen=True, kw_only=True):
    """The abilities of a body: a robot's, or that of the person's avatar.

    Attributes:
        name: for a robot, the name of its file. title: the name in texts for people.
        radius: [m] of the disc that it occupies on the floor. height: [m].
        eye: [m] height of the camera. fov: [rad] horizontal and vertical field of view.
        speed: [m/s] of walking. turn_rate: [rad/s] of turning and of tilting the camera.
        sight_range: [m] of its detector. scan_range: [m] of its range scan. scan_beams: how many beams the scan has.
        pitch_limit: [rad] by which the camera can tilt up or down.
        capabilities: "navigate", "pick" (also place and drop), "open" (also close).
        reach: [m] horizontal, from the body's axis. reach_low, reach_high: [m] heights between which it grasps.
        strength: [kg] that it can lift. handling: [s] that one pick, place, drop, open or close takes.
        detector: its detector unless a trial names another, see `hthor.types.detector_specs.parse`.
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
    """The body of a robot; each robot has a file in ``hthor/world/robots``, see docs/robots.md."""


class Placement(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Where an object starts.

    ``position`` [m], house frame, is its centre, ``yaw`` [rad] its heading. It rests on or in (``relation``) the thing
    ``support``. ``near`` is the id of the thing that a scene prior placed it near to, empty if the prior was about
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
        # msgspec omits a default only if it is the same object, which floats and words from another process are not.
        for name, default in _DEFAULTS:
            if getattr(self, name) == default:
                msgspec.structs.force_setattr(self, name, default)


_DEFAULTS = tuple(
    (field.name, field.default) for field in msgspec.structs.fields(Placement) if field.name in ("yaw", "relation")
)


class Job(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One job with one object, ``target``: to find it, or to bring it on, in or to a destination.

    With the relation "go" the target is one of `WALKERS`, a body that has to go to a thing of the destination's kind.

    ``destinations`` are kinds or ids of things, or ids of rooms; one of them is enough. ``place`` [m], house frame, is
    the exact place if that matters. ``hands`` is the number of bodies that are needed to carry the object.
    """

    target: str
    relation: Relation
    destinations: tuple[str, ...] = ()
    place: Vec3 | None = None
    hands: int = 1


class Goal(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The goal of a task: to find or place ``target`` (an object's id). ``destination`` is a *kind* of thing.

    With several jobs, ``jobs`` lists them all and the other fields describe the first. ``route`` [m], house frame, is
    the way that the instruction describes, for the relation "go"; nobody in the trial is given it.
    """

    target: str
    relation: Relation
    destination: str = ""
    jobs: tuple[Job, ...] = ()
    route: tuple[Vec2, ...] = ()

    @property
    def todo(self) -> tuple[Job, ...]:
        """All jobs, for every task kind."""
        if self.jobs:
            return self.jobs
        destinations = (self.destination,) if self.destination else ()
        return (Job(target=self.target, relation=self.relation, destinations=destinations),)


class Phase(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A part of a trial before the task itself, with an arrangement of its own, such as a tour of the tidy house.

    It ends when every seat has signalled `Ready`, and at its time limit. Time limit, T* and metrics of the task count
    from the end of its last phase.

    Attributes:
        name: unique within the task, such as "tour"; `Observation.phase` has it.
        instruction: what people and robots are told to do in this phase.
        time_limit: [s]. objects: the arrangement when it begins; an object that it leaves out is not in the house yet.
        restarts: how the next phase begins. If true, as a trial does: all objects in place, bodies at their starts with
            empty hands, things closed. If not, bodies and doors stay as they are, and of the objects only those are
            moved whose places differ between the two arrangements, even out of somebody's hands.
    """

    name: str
    instruction: str
    time_limit: float
    objects: tuple[Placement, ...]
    restarts: bool = True


class TaskSpec(Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One task, as frozen data; ``t_star`` [s] is the reference time, see `hthor.tasks.kind`.

    A trial begins with the task's ``phases``, if it has any; all other fields describe what comes after them.

    The first person begins at ``human_start``, the others at ``other_human_starts``; those who have no place there
    begin at the free places nearest to the first. ``difficulty`` is easy, medium or hard, and depends on the task
    alone; ``split`` is "seen" if its house is one of the ten scenes, else "new". Both are empty in suites that do not
    state them.
    """

    id: str
    kind: str
    house: str
    house_sha256: str
    human_start: Pose
    robot_starts: tuple[Pose, ...]
    other_human_starts: tuple[Pose, ...] = ()
    objects: tuple[Placement, ...]
    goal: Goal
    instruction: str
    time_limit: float
    t_star: float
    difficulty: Literal["", "easy", "medium", "hard"] = ""
    split: Literal["", "seen", "new"] = ""
    phases: tuple[Phase, ...] = ()

    @property
    def longest(self) -> float:
        """The longest time [s] that a trial of the task can take, with all its phases."""
        return self.time_limit + sum(phase.time_limit for phase in self.phases)


class AgentRef(Struct, frozen=True, kw_only=True):
    """A robot's agent: its name, the source it was loaded from, the hash of its code, and its privileges."""

    name: str
    source: str
    sha256: str
    privileges: tuple[str, ...] = ()


class RobotSeat(Struct, frozen=True, kw_only=True):
    """One robot of a trial: its body and its agent. `hthor.types.detector_specs.parse` reads ``detector``.

    ``camera`` is set only if it is not the body's own; `hthor.types.cameras.parse` reads it. ``robot_sha256`` is the
    hash of the body's code: of the whole file for a user's own robot, of the syntax tree for one that ships with hthor.
    """

    seat: str
    robot: str
    agent: AgentRef
    detector: str = "own"
    robot_sha256: str = ""
    camera: str | msgspec.UnsetType = msgspec.UNSET


class HumanSeat(Struct, frozen=True, kw_only=True):
    """One person of a trial.

    Attributes:
        seat: the body: "human", "human2" ...
        model: the name of the human population that this person belongs to, as tables have it.
        sha256: hash of everything that decides how these people behave, except hthor's own code.
        participant: the person's number in the study. With N people, session i is played by participants N*i to
            N*i + N - 1, in the order of their seats; so with one person it is the session's number.
    """

    seat: str
    model: str
    sha256: str
    participant: int


class TrialSpec(Struct, frozen=True, kw_only=True):
    """Everything that determines a trial; its content hash is the trial's key.

    Attributes:
        humans: the people, in the order of their seats.
        session: the number of the session that the trial belongs to, counted from 0; the tasks and the world's
            random numbers depend on it. ``index``: the trial's place in its session, from 0.
        attempt: set only for a repetition: how often the trial was voided before.
        assets_sha256: hash of the looks in robots' pictures and of the code that draws them, empty if no agent is known
            to take pictures.
        kind_sha256: hash of the task kind's file if it is a user's own, empty for a kind that ships with hthor.
        clock: when the answers of robots' agents take effect, see `hthor.episode.clocks`; set only if not in lock-step.
        step_limit_s: [s] set only if submitted agents had an unusual deadline for each action.
    """

    task: TaskSpec
    robots: tuple[RobotSeat, ...]
    humans: tuple[HumanSeat, ...]
    session: int
    index: int
    seed: int
    suite_sha256: str
    rules_sha256: str
    code_sha256: str
    assets_sha256: str = ""
    kind_sha256: str = ""
    clock: Clock | msgspec.UnsetType = msgspec.UNSET
    step_limit_s: float | msgspec.UnsetType = msgspec.UNSET
    attempt: int | msgspec.UnsetType = msgspec.UNSET
