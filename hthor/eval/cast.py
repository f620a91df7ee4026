"""Who plays in a trial: worlds, people and robots' minds made from their names; knows nothing of logs or scores."""

from __future__ import annotations

import hashlib
import re
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

    def seats(self, robot: str) -> tuple[RobotSeat, ...]:
        """The robots of a trial with this mind in the body ``robot``.

        Raises:
            UnknownName: when it is not made for that body.
        """
        if self.absent:
            return ()
        if self.bodies and robot not in self.bodies:
            raise UnknownName(f"robot for the agent {self.ref.name}", robot, self.bodies, "Choose one with --robot.")
        return (RobotSeat(seat="robot", robot=robot, agent=self.ref),)


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


class Stage:
    """Makes worlds and companies, and keeps worlds for the next trial in the same house.

    Args:
        path: the agent's ``file.py`` or ``file.py:Class``, for an agent that is not one of ours.
    """

    def __init__(self, path: str = "") -> None:
        self._path = path
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


def player(path: str = "") -> Callable[[Session], Iterator[Record]]:
    """What a worker does with each session: play its trials in order. Called in the worker; imports what is heavy."""
    from hthor.episode import play
    from hthor.eval import record

    stage = Stage(path)

    def perform(session: Session) -> Iterator[Record]:
        with stage.enter(session) as company:
            for trial in session.trials:
                log = play(trial, stage.world(trial), company.human, company.robots())
                for fault in log.faults:
                    company.dismiss(fault.seat)
                yield record.of(trial, log)

    return perform
