"""Which robots take part: bodies and minds found by what the user typed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import code_identity, plugins
from hthor.errors import HthorError, UnknownName
from hthor.guest.agent.manifest import Manifest
from hthor.guest.host.config import GuestConfig
from hthor.types import AgentRef, RobotSeat, cameras
from hthor.types.detector_specs import OWN

ALIASES = {"tall": "tender", "small": "puck"}
"""Other words for robots: what the article's figure calls them."""
NO_ROBOT_AGENT, NO_ROBOT = "none", "no robot"
"""The agent that stands for no robot, and what tables and sentences call it."""
_EXAMPLE = "--robots tall:oracle,small:frontier"


class AgentInfo(Struct, frozen=True, kw_only=True):
    """A robot's mind before the curtain: who it is, and the file it comes from when it is not one of ours.

    ``path`` names it as `hthor.guest.agent.reference` reads it, empty for a built-in agent. It stays out of
    ``ref``, which is part of every trial's key, so that a run reads the same wherever the file lies. ``bodies``
    names the robots that it is made for (empty: any); ``absent`` means that there is no robot in the world at all;
    ``gpus`` is how much of a GPU it asks for, which engines and isolation care about. ``manifest`` lists its files,
    None for a built-in agent.
    """

    ref: AgentRef
    path: str = ""
    bodies: tuple[str, ...] = ()
    absent: bool = False
    gpus: float = 0.0
    manifest: Manifest | None = None


class RobotInfo(Struct, frozen=True, kw_only=True):
    """A robot's body: its name, the hash of its code, and the path of its file when it is a user's own."""

    name: str
    sha256: str = ""
    path: str = ""


class RobotTeam(Struct, frozen=True, kw_only=True):
    """The robots of a trial: bodies and their minds, in the order of their seats; all have this detector and camera.

    A mind that wants no robot is listed too, but has no seat.
    """

    robots: tuple[tuple[RobotInfo, AgentInfo], ...]
    detector: str = OWN
    camera: str = cameras.OWN

    @property
    def listed(self) -> tuple[RobotSeat, ...]:
        """Everyone who was asked for; with empty ``seat``, ``robot`` and ``detector`` where there is no robot."""
        found: list[RobotSeat] = []
        present = 0
        for shape, character in self.robots:
            if character.absent:
                found.append(RobotSeat(seat="", robot="", agent=character.ref, detector=""))
                continue
            present += 1
            found.append(
                RobotSeat(
                    seat="robot" if present == 1 else f"robot{present}",
                    robot=shape.name,
                    agent=character.ref,
                    detector=self.detector,
                    camera=msgspec.UNSET if self.camera == cameras.OWN else self.camera,
                    robot_sha256=shape.sha256,
                )
            )
        return tuple(found)

    @property
    def seats(self) -> tuple[RobotSeat, ...]:
        """The robots that there are."""
        return tuple(robot for robot in self.listed if robot.seat)

    @property
    def minds(self) -> dict[str, str]:
        """The files of minds that are not ours, by seat."""
        return {seat: character.path for seat, (_, character) in self._by_seat if character.path}

    @property
    def manifests(self) -> dict[str, Manifest]:
        """What minds that are not ours consist of, by seat."""
        return {seat: character.manifest for seat, (_, character) in self._by_seat if character.manifest}

    @property
    def agents(self) -> tuple[Manifest, ...]:
        """The same, each agent once, in the order in which they were asked for."""
        found = (character.manifest for _, character in self.robots if character.manifest is not None)
        return tuple({one.sha256: one for one in found}.values())

    @property
    def bodies(self) -> dict[str, str]:
        """The files of bodies that are not ours, by seat."""
        return {seat: shape.path for seat, (shape, _) in self._by_seat if shape.path}

    @property
    def gpus(self) -> float:
        """How much of a GPU a trial needs."""
        return sum(character.gpus for _, (_, character) in self._by_seat)

    @property
    def _by_seat(self) -> list[tuple[str, tuple[RobotInfo, AgentInfo]]]:
        pairs = zip(self.listed, self.robots, strict=True)
        return [(robot.seat, pair) for robot, pair in pairs if robot.seat]


def step_limit_of(crew: RobotTeam, seconds: float | None) -> float | msgspec.UnsetType:
    """The deadline of each action as a trial has it: only where an agent is submitted, and not the usual one [s]."""
    return float(seconds) if seconds is not None and crew.minds else msgspec.UNSET


def team_pictures_sha256(crew: RobotTeam, pack: str = "") -> str:
    """Hash of what robots' pictures show and of what draws it; empty where no mind is known to take any.

    Every submitted agent may, and whoever was given a camera or a furniture pack, whose own hash is ``pack``.
    """
    looks = crew.seats and (crew.minds or crew.camera != cameras.OWN or pack)
    return code_identity.pictures_sha256(pack) if looks else ""


def form_team(
    bodies: Sequence[str | RobotInfo],
    minds: Sequence[str | AgentInfo],
    detector: str = OWN,
    camera: str = cameras.OWN,
    guests: GuestConfig | None = None,
) -> RobotTeam:
    """A crew of these bodies and minds, which belong together one by one; ``guests`` as in `load_agent_info`.

    Raises:
        UnknownName: when one of them is unknown, or a mind is not made for its body.
    """
    robots = []
    for body, mind in zip(bodies, minds, strict=True):
        character = load_agent_info(mind, guests) if isinstance(mind, str) else mind
        shape = load_robot_info(body) if isinstance(body, str) else body
        if character.bodies and shape.name not in character.bodies and not character.absent:
            hint = "Choose one with --robot or --robots."
            raise UnknownName(f"robot for the agent {character.ref.name}", shape.name, character.bodies, hint)
        robots.append((shape, character))
    if all(character.absent for _, character in robots):
        robots = robots[:1]
    return RobotTeam(robots=tuple(robots), detector=detector, camera=camera)


def parse_teams(
    robots: str,
    agents: Sequence[str],
    detector: str = OWN,
    camera: str = cameras.OWN,
    *,
    guests: GuestConfig | None = None,
) -> list[RobotTeam]:
    """The crews that ``--robots`` stands for: one, or, where bodies have no mind of their own, one for each agent.

    Args:
        robots: BODY:AGENT or BODY, separated by commas: "tall:oracle,small:my_agent.py:Careful". A comma within an
            agent is written as a backslash and a comma.
        agents: who sits in the bodies that come without a mind. guests: as in `load_agent_info`.

    Raises:
        HthorError: when it cannot be read, or a name in it is unknown.
    """
    words = [word.replace("\\,", ",").strip() for word in re.split(r"(?<!\\),", robots)]
    pairs = [_body_and_agent(word, robots) for word in words]
    bare = [body for body, mind in pairs if not mind]
    if bare and not agents:
        raise HthorError(f"--robots: '{bare[0]}' has no mind. Write {bare[0]}:AGENT, or name one with --agent.")
    if agents and not bare:
        raise HthorError("--robots names a mind for every robot, so --agent has nobody to be; leave one of them out.")
    shapes = [load_robot_info(body) for body, _ in pairs]
    wanted = dict.fromkeys([*(mind for _, mind in pairs if mind), *agents])
    known = {mind: load_agent_info(mind, guests) for mind in wanted}
    casts = [[known[mind or agent] for _, mind in pairs] for agent in agents or [""]]
    return [form_team(shapes, minds, detector, camera) for minds in casts]


def _body_and_agent(word: str, given: str) -> tuple[str, str]:
    body, colon, mind = word.partition(":")
    if not body or bool(colon) != bool(mind):
        raise HthorError(f"--robots '{given}': '{word}' is not BODY:AGENT; expected something like {_EXAMPLE}.")
    return body, mind


def load_robot_info(robot: str) -> RobotInfo:
    """Find out what a robot's body is.

    Args:
        robot: the name of a robot that ships with hthor, one of `ALIASES`, or the path of a Python file,
            ``my_robot.py``.

    Raises:
        UnknownName: when it is neither.
        HthorError: when the file does not load or does not define a robot.
    """
    known = plugins.names("robot")
    name = ALIASES.get(robot, robot)
    if name in known:
        return RobotInfo(name=name, sha256=code_identity.robot_sha256(name))
    if not robot.endswith(".py"):
        hint = "Choose one with --robot, or give the path of a Python file, such as my_robot.py."
        raise UnknownName("robot", robot, (*known, *ALIASES), hint)
    from hthor.world.model.bodies import bodies

    return RobotInfo(name=bodies.load_robot(robot).name, sha256=plugins.sha256(robot), path=str(Path(robot).resolve()))


def load_agent_info(agent: str, guests: GuestConfig | None = None) -> AgentInfo:
    """Find out who an agent is.

    Args:
        agent: a built-in agent's name, or an agent of the user's in one of the forms of `hthor.guest.agent.reference`.
        guests: how a submitted agent is isolated while it is asked, and what it is given.

    Raises:
        UnknownName: when it is neither.
        AgentError: when it does not load.
    """
    name = plugins.plugin_name("agent", agent)
    return _built_in_agent(name) if name in plugins.names("agent") else _submitted_agent(agent, guests)


def display_name(name: str, robots: Sequence[RobotSeat]) -> str:
    """What tables and sentences call a run: its name, or "no robot" where it has none and nobody named it."""
    nobody = not any(robot.seat for robot in robots)
    return NO_ROBOT if nobody and name in (NO_ROBOT_AGENT, *(robot.agent.name for robot in robots)) else name


def _built_in_agent(name: str) -> AgentInfo:
    made: Any = plugins.load("agent", name)
    ref = AgentRef(
        name=name,
        source=plugins.module_name("agent", name),
        sha256=code_identity.agent_sha256(name),
        privileges=tuple(getattr(made, "privileges", ())),
    )
    return AgentInfo(
        ref=ref,
        bodies=tuple(getattr(made, "robots", ())),
        absent=bool(getattr(made, "absent", False)),
        gpus=float(getattr(made, "gpus", 0.0)),
    )


def _submitted_agent(text: str, config: GuestConfig | None) -> AgentInfo:
    from hthor.guest import Guest
    from hthor.guest.host import snapshot

    with Guest(text, config=config) as guest:
        info = guest.load()
        name = _file_safe("-".join([info.name, *(_argument_text(*pair) for pair in guest.inputs.args.items())]))
        made = snapshot.take_manifest(guest, name)
        ref = AgentRef(name=name, source=info.source, sha256=made.sha256, privileges=tuple(info.privileges))
        return AgentInfo(
            ref=ref,
            path=guest.reference.text,
            bodies=tuple(info.robots),
            absent=info.absent,
            gpus=info.gpus,
            manifest=made,
        )


def _argument_text(key: str, value: str) -> str:
    """An argument as a part of an agent's name."""
    return f"{key}-{Path(value).name if Path(value).is_absolute() else value}"


def _file_safe(name: str) -> str:
    """A name that can be part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_+-]+", "-", name).strip("-")[:60] or "agent"
