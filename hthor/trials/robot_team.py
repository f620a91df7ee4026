"""The robots of a run: bodies and agents, resolved from the user's options."""

import inspect
import re
from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import code_identity, jsonio, plugins
from hthor.errors import AgentError, HthorError, UnknownName
from hthor.guest.agent.manifest import Manifest, hash_file
from hthor.guest.host.info import GuestConfig
from hthor.types import AgentRef, RobotSeat, cameras
from hthor.types.detector_specs import OWN

ALIASES = {"tall": "tender", "small": "puck"}
"""Other names for robots, from the figure of the HumanTHOR paper."""
NO_ROBOT_AGENT, NO_ROBOT = "none", "no robot"
"""The agent that stands for having no robot, and its name in tables and sentences."""
_EXAMPLE = "--robots tall:oracle,small:frontier"


class AgentInfo(Struct, frozen=True, kw_only=True):
    """An agent before it runs: its identity, and where it comes from when it is not built in.

    Attributes:
        ref: its identity, part of every trial's key; it has no path, so that a run is the same wherever the file is.
        path: the agent as `hthor.guest.agent.reference` reads it, empty for a built-in agent.
        robots: the robots that it is made for; empty for any.
        absent: whether it means that there is no robot in the world at all.
        gpus: how much of a GPU it needs; for engines and isolation.
        manifest: its files, None for a built-in agent.
    """

    ref: AgentRef
    path: str = ""
    robots: tuple[str, ...] = ()
    absent: bool = False
    gpus: float = 0.0
    manifest: Manifest | None = None


class RobotInfo(Struct, frozen=True, kw_only=True):
    """A robot's body: its name, the hash of its code, and the path of its file when it is the user's own."""

    name: str
    sha256: str = ""
    path: str = ""


class RobotTeam(Struct, frozen=True, kw_only=True):
    """The robots of a trial with their agents, in the order of their seats; all have the same detector and camera.

    An agent that needs no robot is listed too, but has no seat.
    """

    robots: tuple[tuple[RobotInfo, AgentInfo], ...]
    detector: str = OWN
    camera: str = cameras.OWN

    @property
    def listed(self) -> tuple[RobotSeat, ...]:
        """Every agent of the team; ``seat``, ``robot`` and ``detector`` are empty where there is no robot."""
        seats: list[RobotSeat] = []
        present = 0
        for robot, agent in self.robots:
            if agent.absent:
                seats.append(RobotSeat(seat="", robot="", agent=agent.ref, detector=""))
                continue
            present += 1
            seats.append(
                RobotSeat(
                    seat="robot" if present == 1 else f"robot{present}",
                    robot=robot.name,
                    agent=agent.ref,
                    detector=self.detector,
                    camera=msgspec.UNSET if self.camera == cameras.OWN else self.camera,
                    robot_sha256=robot.sha256,
                )
            )
        return tuple(seats)

    @property
    def seats(self) -> tuple[RobotSeat, ...]:
        """The robots that are in the world."""
        return tuple(robot for robot in self.listed if robot.seat)

    @property
    def agent_paths(self) -> dict[str, str]:
        """The paths of the submitted agents, by seat."""
        return {seat: agent.path for seat, (_, agent) in self._by_seat if agent.path}

    @property
    def manifests(self) -> dict[str, Manifest]:
        """The files of the submitted agents, by seat."""
        return {seat: agent.manifest for seat, (_, agent) in self._by_seat if agent.manifest}

    @property
    def agents(self) -> tuple[Manifest, ...]:
        """The files of each submitted agent once, in the order of the team."""
        manifests = (agent.manifest for _, agent in self.robots if agent.manifest is not None)
        return tuple({manifest.sha256: manifest for manifest in manifests}.values())

    @property
    def robot_paths(self) -> dict[str, str]:
        """The files of the user's own bodies, by seat."""
        return {seat: robot.path for seat, (robot, _) in self._by_seat if robot.path}

    @property
    def gpus(self) -> float:
        """How much of a GPU a trial needs."""
        return sum(agent.gpus for _, (_, agent) in self._by_seat)

    @property
    def _by_seat(self) -> list[tuple[str, tuple[RobotInfo, AgentInfo]]]:
        return [(robot.seat, pair) for robot, pair in zip(self.listed, self.robots, strict=True) if robot.seat]


def step_limit_of(team: RobotTeam, seconds: float | None) -> float | msgspec.UnsetType:
    """The deadline of each action [s] as a trial states it: unset for the default or without submitted agents."""
    return float(seconds) if seconds is not None and team.agent_paths else msgspec.UNSET


def team_pictures_sha256(team: RobotTeam, pack: str = "") -> str:
    """Hash of the robots' pictures (of the drawing code and of a furniture pack); empty where they affect no trial.

    They can affect every submitted agent, and every agent where a camera or a furniture pack was chosen.
    """
    matters = team.seats and (team.agent_paths or team.camera != cameras.OWN or pack)
    return code_identity.pictures_sha256(pack) if matters else ""


def form_team(
    robots: Sequence[str | RobotInfo],
    agents: Sequence[str | AgentInfo],
    detector: str = OWN,
    camera: str = cameras.OWN,
    guests: GuestConfig | None = None,
) -> RobotTeam:
    """A team in which the first robot has the first agent, the second robot the second agent, and so on.

    Raises:
        UnknownName: when a robot or an agent is unknown, or an agent is not made for its robot.
    """
    pairs = []
    for robot, agent in zip(robots, agents, strict=True):
        agent_info = load_agent_info(agent, guests) if isinstance(agent, str) else agent
        robot_info = load_robot_info(robot) if isinstance(robot, str) else robot
        if agent_info.robots and robot_info.name not in agent_info.robots and not agent_info.absent:
            hint = "Choose one with --robot or --robots."
            raise UnknownName(f"robot for the agent {agent_info.ref.name}", robot_info.name, agent_info.robots, hint)
        pairs.append((robot_info, agent_info))
    if all(agent.absent for _, agent in pairs):
        pairs = pairs[:1]
    return RobotTeam(robots=tuple(pairs), detector=detector, camera=camera)


def parse_teams(
    robots: str,
    agents: Sequence[str],
    detector: str = OWN,
    camera: str = cameras.OWN,
    *,
    guests: GuestConfig | None = None,
) -> list[RobotTeam]:
    """The teams that ``--robots`` stands for: one or, if a robot comes without an agent, one for each agent.

    Args:
        robots: ROBOT:AGENT or ROBOT, separated by commas: "tall:oracle,small:my_agent.py:Careful". A comma within an
            agent is written as a backslash and a comma.
        agents: the agents for robots that are given without an agent.
        guests: as in `load_agent_info`.

    Raises:
        HthorError: when ``robots`` cannot be parsed, or a name in it is unknown.
    """
    pairs = split_robots(robots)
    without = [robot for robot, agent in pairs if not agent]
    if without and not agents:
        raise HthorError(
            f"--robots: '{without[0]}' has no agent. Write {without[0]}:AGENT, or name an agent with --agent."
        )
    if agents and not without:
        raise HthorError(
            "--robots names an agent for every robot, so --agent has no robot left; leave one of them out."
        )
    robot_infos = [load_robot_info(robot) for robot, _ in pairs]
    used = dict.fromkeys([*(agent for _, agent in pairs if agent), *agents])
    agent_infos = {agent: load_agent_info(agent, guests) for agent in used}
    return [
        form_team(robot_infos, [agent_infos[own or agent] for _, own in pairs], detector, camera)
        for agent in agents or [""]
    ]


def split_robots(robots: str) -> list[tuple[str, str]]:
    """The robots and agents that ``--robots`` names; the agent is empty where it has none.

    Raises:
        HthorError: when ``robots`` cannot be parsed.
    """
    words = [word.replace("\\,", ",").strip() for word in re.split(r"(?<!\\),", robots)]
    return [_robot_and_agent(word, robots) for word in words]


def _robot_and_agent(word: str, robots: str) -> tuple[str, str]:
    robot, colon, agent = word.partition(":")
    if not robot or bool(colon) != bool(agent):
        raise HthorError(f"--robots '{robots}': '{word}' is not ROBOT:AGENT; expected something like {_EXAMPLE}.")
    return robot, agent


def load_robot_info(robot: str) -> RobotInfo:
    """Look up a robot's body.

    Args:
        robot: the name of a robot that ships with hthor, one of `ALIASES`, or the path of a Python file,
            ``my_robot.py``.

    Raises:
        UnknownName: when ``robot`` is none of these.
        HthorError: when the file does not load or does not define a robot.
    """
    known = plugins.names("robot")
    name = ALIASES.get(robot, robot)
    if name in known:
        return RobotInfo(name=name, sha256=code_identity.robot_sha256(name))
    if not robot.endswith(".py"):
        hint = "Choose one of them, or give the path of a Python file, such as my_robot.py."
        raise UnknownName("robot", robot, (*known, *ALIASES), hint)
    from hthor.world.model.bodies import bodies

    return RobotInfo(name=bodies.load_robot(robot).name, sha256=plugins.sha256(robot), path=str(Path(robot).resolve()))


def load_agent_info(agent: str, guests: GuestConfig | None = None) -> AgentInfo:
    """Look up an agent; a submitted one is started once, in a process of its own, to ask what it declares.

    Args:
        agent: a built-in agent's name, or a submitted agent in one of the forms of `hthor.guest.agent.reference`.
        guests: how a submitted agent is isolated, and which arguments and files it gets.

    Raises:
        UnknownName: when ``agent`` is neither.
        AgentError: when the agent does not load.
    """
    name = plugins.plugin_name("agent", agent)
    if name not in plugins.names("agent"):
        return _submitted_agent(agent, guests)
    if guests is not None and guests.inputs.args and inspect.signature(plugins.load("agent", name)).parameters:
        return _submitted_agent(f"{name}:", guests)
    return _built_in_agent(name)


def display_name(name: str, robots: Sequence[RobotSeat]) -> str:
    """The name of a run in tables and sentences: its own name, or "no robot" for an unnamed run without a robot."""
    robotless = not any(robot.seat for robot in robots)
    return NO_ROBOT if robotless and name in (NO_ROBOT_AGENT, *(robot.agent.name for robot in robots)) else name


def _built_in_agent(name: str) -> AgentInfo:
    agent = plugins.load("agent", name)
    return AgentInfo(
        ref=AgentRef(
            name=name,
            source=plugins.module_name("agent", name),
            sha256=_built_in_sha256(name, getattr(agent, "ingredients", ())),
            privileges=tuple(getattr(agent, "privileges", ())),
        ),
        robots=tuple(getattr(agent, "robots", ())),
        absent=bool(getattr(agent, "absent", False)),
        gpus=float(getattr(agent, "gpus", 0.0)),
    )


def _built_in_sha256(name: str, ingredients: Sequence[str]) -> str:
    """The identity of a built-in agent: of its code, and of the files beside it that it is made of, such as weights.

    Raises:
        AgentError: when a file is missing.
    """
    code = code_identity.agent_sha256(name)
    if not ingredients:
        return code
    folder = plugins.file("agent", name).parent
    try:
        return jsonio.sha256([code, {one: hash_file(folder / one)[0] for one in sorted(ingredients)}])
    except OSError as error:
        reason = f"{error.filename} of the built-in agent '{name}' cannot be read: {error.strerror}"
        raise AgentError(f"{reason}. Install hthor again.") from None


def _submitted_agent(text: str, config: GuestConfig | None) -> AgentInfo:
    from hthor.guest import Guest
    from hthor.guest.host import snapshot

    with Guest(text, config=config) as guest:
        info = guest.load()
        args = guest.inputs.args.items()
        if guest.reference.built_in and not guest.inputs.arguments(guest.reference):
            raise AgentError(f"agent '{text}' names no checkpoint. Write {text}CHECKPOINT, or {text[:-1]} for its own.")
        words = (f"{key}-{Path(value).name if Path(value).is_absolute() else value}" for key, value in args)
        name = re.sub(r"[^A-Za-z0-9_+-]+", "-", "-".join([info.name, *words])).strip("-")[:60] or "agent"
        manifest = snapshot.take_manifest(guest, name)
        ref = AgentRef(name=name, source=info.source, sha256=manifest.sha256, privileges=tuple(info.privileges))
        return AgentInfo(
            ref=ref,
            path=guest.reference.text,
            robots=tuple(info.robots),
            absent=info.absent,
            gpus=info.gpus,
            manifest=manifest,
        )
