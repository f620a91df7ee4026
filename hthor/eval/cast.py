"""Who plays in a trial: worlds, people and robots' minds made from their names; knows nothing of logs or scores."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hthor import plugins
from hthor.detectors import OWN
from hthor.errors import AgentError, HthorError, UnknownName
from hthor.types import AgentRef, Mind, RobotSeat, TrialSpec

if TYPE_CHECKING:
    from hthor.eval.record import Record
    from hthor.eval.session import Session
    from hthor.looks.pack import Pack
    from hthor.world import World


class Character(Struct, frozen=True, kw_only=True):
    """A robot's mind before the curtain: who it is, and the file it comes from when it is not one of ours.

    ``path`` is ``file.py`` or ``file.py:Class``, empty for a built-in agent. It stays out of ``ref``, which is part of
    every trial's key, so that a run reads the same wherever the file lies. ``bodies`` names the robots that it is made
    for (empty: any); ``absent`` means that there is no robot in the world at all.
    """

    ref: AgentRef
    path: str = ""
    bodies: tuple[str, ...] = ()
    absent: bool = False

    def seats(self, robot: str, detector: str = OWN, robot_sha256: str = "") -> tuple[RobotSeat, ...]:
        """The robots of a trial with this mind in the body ``robot``, with this detector.

        Raises:
            UnknownName: when it is not made for that body.
        """
        if self.absent:
            return ()
        if self.bodies and robot not in self.bodies:
            raise UnknownName(f"robot for the agent {self.ref.name}", robot, self.bodies, "Choose one with --robot.")
        seat = RobotSeat(seat="robot", robot=robot, agent=self.ref, detector=detector, robot_sha256=robot_sha256)
        return (seat,)


class Shape(Struct, frozen=True, kw_only=True):
    """A robot's body: its name, and for a user's own the hash and the path of its file."""

    name: str
    sha256: str = ""
    path: str = ""


def embody(robot: str) -> Shape:
    """Find out what a robot's body is.

    Args:
        robot: the name of a robot that ships with hthor, or the path of a Python file, ``my_robot.py``.

    Raises:
        UnknownName: when it is neither.
        HthorError: when the file does not load or does not define a robot.
    """
    known = plugins.names("robot")
    if robot in known:
        return Shape(name=robot)
    if not robot.endswith(".py"):
        hint = "Choose one with --robot, or give the path of a Python file, such as my_robot.py."
        raise UnknownName("robot", robot, known, hint)
    from hthor.world import bodies

    return Shape(name=bodies.robot(robot).name, sha256=plugins.sha256(robot), path=str(Path(robot).resolve()))


def introduce(agent: str) -> Character:
    """Find out who an agent is.

    Args:
        agent: a built-in agent's name, or the path of a Python file, ``my_agent.py`` or ``my_agent.py:MyClass``.

    Raises:
        UnknownName: when it is neither.
        AgentError: when the file does not load.
    """
    known = plugins.names("agent")
    if agent in known:
        return _own(agent)
    if agent.endswith(".py") or ".py:" in agent:
        return _guest(agent)
    raise UnknownName("agent", agent, known, "Or give the path of a Python file, such as my_agent.py.")


def _own(name: str) -> Character:
    made: Any = plugins.load("agent", name)
    file = Path(plugins.__file__).with_name("agents") / f"{name}.py"
    ref = AgentRef(
        name=name,
        source=f"hthor.agents.{name}",
        sha256=hashlib.sha256(file.read_bytes()).hexdigest(),
        privileges=tuple(getattr(made, "privileges", ())),
    )
    return Character(ref=ref, bodies=tuple(getattr(made, "robots", ())), absent=bool(getattr(made, "absent", False)))


def _guest(path: str) -> Character:
    from hthor.guest import load_info

    info = load_info(path)
    file, colon, class_name = path.rpartition(":") if ".py:" in path else (path, "", "")
    ref = AgentRef(
        name=_tidy(info.name),
        source=Path(file).name + colon + class_name,
        sha256=info.sha256,
        privileges=tuple(info.privileges),
    )
    return Character(
        ref=ref,
        path=str(Path(file).resolve()) + colon + class_name,
        bodies=tuple(info.robots),
        absent=info.absent,
    )


def _tidy(name: str) -> str:
    """A name that can be part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_+-]+", "-", name).strip("-")[:60] or "agent"


def furnish(assets: str) -> Pack | None:
    """The furniture pack of this name, None for our own furniture.

    Raises:
        UnknownName: when there is none.
    """
    if not assets:
        return None
    from hthor.looks import pack

    return pack.load(assets)


class Stage:
    """Makes worlds and companies, and keeps worlds for the next trial in the same house.

    Args:
        path: the agent's ``file.py`` or ``file.py:Class``, for an agent that is not one of ours.
        robot: the robot's file, for a robot that is not one of ours.
        assets: name of the furniture pack that pictures show; empty for our own furniture.
    """

    def __init__(self, path: str = "", robot: str = "", assets: str = "") -> None:
        self._path, self._robot, self._assets = path, robot, assets
        self._worlds: dict[object, World] = {}

    def enter(self, session: Session) -> Company:
        """The person and the robots of a session, new to one another."""
        return Company(session.trials[0], self._mind)

    def world(self, trial: TrialSpec) -> World:
        """The world of a trial; the one of an earlier trial where house, robots, detectors and objects are the same."""
        task = trial.task
        bodies = tuple(seat.robot for seat in trial.robots)
        objects = tuple((placed.id, placed.kind) for placed in task.objects)
        detectors = tuple(seat.detector for seat in trial.robots)
        key = (task.house, task.house_sha256, bodies, detectors, objects)
        if key not in self._worlds:
            from hthor import houses
            from hthor.world import World

            specs = tuple(self._body(seat) for seat in trial.robots)
            pack = furnish(self._assets)
            if pack is not None and pack.sha256 != trial.assets_sha256:
                raise HthorError(
                    f"the pack '{self._assets}' was built anew while its run was going on; begin a new run."
                )
            self._worlds[key] = World(
                houses.load(task.house),
                robots=specs,
                objects=objects,
                detectors=detectors,
                profile="fast" if pack is None else "nice",
                assets=pack or "",
            )
        return self._worlds[key]

    def _body(self, seat: RobotSeat) -> Any:
        if seat.robot_sha256 and plugins.sha256(self._robot) != seat.robot_sha256:
            raise HthorError(
                f"{self._robot} was changed while its run was going on. Change it back and repeat the command to "
                "finish this run, or evaluate the new version in a run of its own."
            )
        return plugins.load("robot", self._robot if seat.robot_sha256 else seat.robot)

    def _mind(self, seat: RobotSeat) -> Mind:
        if not self._path:
            mind: Mind = plugins.load("agent", seat.agent.name)()
            return mind
        from hthor.guest import Guest

        guest = Guest(self._path)
        if guest.load().sha256 != seat.agent.sha256:
            guest.close()
            raise AgentError(
                f"{self._path} was changed while its run was going on. Change it back and repeat the command to finish "
                "this run, or evaluate the new version in a run of its own."
            )
        return guest


class Company:
    """One session's person and minds. Use as a context manager: guests are processes and must be let go."""

    def __init__(self, first: TrialSpec, make: Callable[[RobotSeat], Mind]) -> None:
        from hthor.humans.person import Person

        model: Any = plugins.load("human model", first.human)
        self.human = model(Person(seed=first.seed, participant=first.participant))
        self._seats = first.robots
        self._make = make
        self._minds: dict[str, Mind] = {}

    def __enter__(self) -> Company:
        return self

    def __exit__(self, *_: object) -> None:
        for seat in tuple(self._minds):
            self.dismiss(seat)

    def robots(self) -> Mapping[str, Mind]:
        """A mind for each robot's seat: the one of the trial before, unless it was dismissed."""
        for robot in self._seats:
            if robot.seat not in self._minds:
                self._minds[robot.seat] = self._make(robot)
        return dict(self._minds)

    def dismiss(self, seat: str) -> None:
        """Let a mind go; the next trial gets a fresh one."""
        mind: Any = self._minds.pop(seat)
        if hasattr(mind, "close"):
            mind.close()


def player(path: str = "", robot: str = "", assets: str = "") -> Callable[[Session], Iterator[Record]]:
    """What a worker does with each session: play its trials in order. Called in the worker; imports what is heavy."""
    from hthor.episode import play
    from hthor.eval import record

    stage = Stage(path, robot, assets)

    def perform(session: Session) -> Iterator[Record]:
        with stage.enter(session) as company:
            for trial in session.trials:
                log = play(trial, stage.world(trial), company.human, company.robots())
                for fault in log.faults:
                    company.dismiss(fault.seat)
                yield record.of(trial, log)

    return perform
