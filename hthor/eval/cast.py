"""Who plays in a trial: worlds, people and robots' minds made from their names; knows nothing of logs or scores."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hthor import plugins
from hthor.errors import AgentError, UnknownName
from hthor.types import AgentRef, Mind, RobotSeat, TrialSpec

if TYPE_CHECKING:
    from hthor.eval.record import Record
    from hthor.eval.session import Session
    from hthor.world import World

DEFAULT_CLASS = "Agent"


class Character(Struct, frozen=True, kw_only=True):
    """A robot's mind before the curtain: who it is, and the file it comes from when it is not one of ours.

    ``absent`` means that there is no robot in the world at all. The path stays out of ``ref``, which is part of every
    trial's key, so that a run reads the same wherever the agent's file lies.
    """

    ref: AgentRef
    absent: bool = False
    path: str = ""
    class_name: str = DEFAULT_CLASS

    def seats(self, robot: str) -> tuple[RobotSeat, ...]:
        """The robots of a trial with this mind in the body ``robot``."""
        return () if self.absent else (RobotSeat(seat="robot", robot=robot, agent=self.ref),)


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
    path, _, class_name = agent.partition(":")
    if not path.endswith(".py"):
        raise UnknownName("agent", agent, known, "Or give the path of a Python file, such as my_agent.py.")
    return _guest(Path(path), class_name or DEFAULT_CLASS)


def _own(name: str) -> Character:
    made: Any = plugins.load("agent", name)
    source = plugins.__file__ and Path(plugins.__file__).with_name("agents") / f"{name}.py"
    ref = AgentRef(
        name=name,
        source=f"hthor.agents.{name}",
        sha256=hashlib.sha256(source.read_bytes()).hexdigest(),
        privileges=tuple(getattr(made, "privileges", ())),
    )
    return Character(ref=ref, absent=bool(getattr(made, "absent", False)))


def _guest(path: Path, class_name: str) -> Character:
    from hthor.guest import Guest

    if not path.is_file():
        raise AgentError(f"agent file '{path}' does not exist. 'hthor agent new {path}' writes one to start from.")
    plain = class_name == DEFAULT_CLASS
    guest = Guest(str(path) if plain else f"{path}:{class_name}")
    try:
        ref = AgentRef(
            name=path.stem if plain else f"{path.stem}.{class_name}",
            source=path.name if plain else f"{path.name}:{class_name}",
            sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
            privileges=tuple(guest.privileges),
        )
    finally:
        guest.close()
    return Character(ref=ref, path=str(path.resolve()), class_name=class_name)


class Stage:
    """Makes worlds and companies, and keeps worlds for the next trial in the same house.

    Args:
        path: the agent's file, for an agent that is not one of ours.
        class_name: the class in it.
    """

    def __init__(self, path: str = "", class_name: str = DEFAULT_CLASS) -> None:
        self._path, self._class_name = path, class_name
        self._worlds: dict[object, World] = {}

    def enter(self, session: Session) -> Company:
        """The person and the robots of a session, new to one another."""
        return Company(session.trials[0], self._mind)

    def world(self, trial: TrialSpec) -> World:
        """The world of a trial; the one of an earlier trial where house, robots and objects are the same."""
        task = trial.task
        bodies = tuple(seat.robot for seat in trial.robots)
        objects = tuple((placed.id, placed.kind) for placed in task.objects)
        key = (task.house, task.house_sha256, bodies, objects)
        if key not in self._worlds:
            from hthor import houses
            from hthor.world import World

            specs = tuple(plugins.load("robot", name) for name in bodies)
            self._worlds[key] = World(houses.load(task.house), robots=specs, objects=objects)
        return self._worlds[key]

    def _mind(self, seat: RobotSeat) -> Mind:
        if not self._path:
            mind: Mind = plugins.load("agent", seat.agent.name)()
            return mind
        from hthor.guest import Guest

        return Guest(self._path if self._class_name == DEFAULT_CLASS else f"{self._path}:{self._class_name}")


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


def player(path: str = "", class_name: str = DEFAULT_CLASS) -> Callable[[Session], Iterator[Record]]:
    """What a worker does with each session: play its trials in order. Called in the worker, imports everything heavy."""
    from hthor.episode import play
    from hthor.eval import record

    stage = Stage(path, class_name)

    def perform(session: Session) -> Iterator[Record]:
        with stage.enter(session) as company:
            for trial in session.trials:
                log = play(trial, stage.world(trial), company.human, company.robots())
                for fault in log.faults:
                    company.dismiss(fault.seat)
                yield record.of(trial, log)

    return perform
