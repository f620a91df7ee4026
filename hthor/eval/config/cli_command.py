"""The command that runs or resumes a run, as a user would type it."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import msgspec

from hthor import plugins
from hthor.eval.config.run_config import PROCEDURAL, RunConfig
from hthor.eval.config.shards import whole_folder
from hthor.eval.config.study_design import BETWEEN
from hthor.guest import Manifest
from hthor.trials.robot_team import NO_ROBOT_AGENT
from hthor.types import AgentRef, RobotSeat, cameras
from hthor.types.detector_specs import OWN

BUILT_IN_AGENTS = f"{plugins.package('agent')}."
"""How the source of a built-in agent begins."""


def resume_command(folder: Path, config: RunConfig, out: Path | None = None) -> str:
    """The shell command that finishes a run or a shard; it writes to ``out``, by default the run's folder."""
    out = out or folder
    words = ["hthor", "eval", *_condition_options(config), "--humans", config.humans.source]
    generated = (folder / "suite.json").exists()
    if config.kind is not None and (config.kind.sha256 or generated):
        words += ["--kind", f"{config.kind.name}.py" if config.kind.sha256 else config.kind.name]
        words += [] if generated else ["--suite", config.suite.name]
    else:
        words += ["--suite", config.suite.name, *(("--kind", config.kind.name) if config.kind else ())]
    words += [] if config.assets.name == PROCEDURAL else ["--assets", config.assets.name]
    detector = next((robot.detector for robot in config.seats), OWN)
    words += [] if detector == OWN else ["--detector", detector]
    words += _camera_options(config)
    words += ["--name", _title(config)] if config.title else []
    words += ["--clock", config.clock] if config.clock else []
    words += [word for name in config.houses or () for word in ("--house", name)]
    words += ["--difficulty", config.difficulty] if config.difficulty else []
    words += ["--limit", str(config.limit)] if config.limit else []
    words += ["--step-limit", f"{config.step_limit_s:g}"] if config.step_limit_s else []
    for one in config.agents[:1]:  # all agents of a command get the same arguments and files
        words += [word for key, value in one.args.items() for word in ("--agent-args", f"{key}={value}")]
        beyond = dict.fromkeys(file.path.split("/")[1] for file in one.files if file.path.startswith("../"))
        words += [word for name in beyond if name not in _listed_files(one) for word in ("--readable", name)]
    people = config.design.participants if config.design else config.participants
    words += ["--seed", str(config.seed), "--participants", str(people)]
    words += ["--shard", config.shard.words] if config.shard else []
    if config.design:  # all conditions have a folder each in one
        whole = whole_folder(out) if config.shard else out
        return shlex.join([*words, *(("--out", str(whole.parent)) if whole.name == config.team_name else ())])
    return shlex.join([*words, "--out", str(whole_folder(out) if config.shard else out)])


def _condition_options(config: RunConfig) -> list[str]:
    """The options that name the run's robots, or all conditions of its between-subjects study."""
    if not config.design:
        return _robot_options(config.robots)
    words = [word for agent in config.design.conditions for word in ("--agent", agent)]
    robot = _robot_options(config.seats[:1])[2:] if config.seats else []
    return [*words, *robot, "--design", BETWEEN, "--no-control"]


def _title(config: RunConfig) -> str:
    """The name that the user gave; the runs of a study add their agents to it."""
    title = config.title or ""
    return title.removesuffix(f"-{config.team_name}") if config.design else title


def _listed_files(agent: Manifest) -> set[str]:
    """Files outside an agent's folder that need no --readable, as arguments or the words of a command name them."""
    words = shlex.split(agent.source[len("cmd:") :]) if agent.source.startswith("cmd:") else []
    head, _, own = agent.source.partition(":")
    words += [own] if plugins.is_built_in("agent", head) else []
    return {*(value.removeprefix("../") for value in agent.args.values()), *words}


def _camera_options(config: RunConfig) -> list[str]:
    """The options that name the robots' camera."""
    camera = next((robot.camera for robot in config.seats if robot.camera), cameras.OWN)
    name, _, size = camera.partition(":")
    words = [] if name == cameras.OWN else ["--camera", name]
    return [*words, "--camera-size", size] if size else words


def relative_path(path: Path) -> Path:
    """A folder as a user would type it: relative when it is below the current folder, otherwise unchanged."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_absolute() and path.is_relative_to(here) else path


def baseline_command(config: RunConfig) -> str:
    """The command that runs the same people with the same tasks, but without a robot; or the whole study again."""
    if config.design:
        return resume_command(Path(), config)
    absent = RobotSeat(
        seat="", robot="", agent=AgentRef(name=NO_ROBOT_AGENT, source=f"{BUILT_IN_AGENTS}{NO_ROBOT_AGENT}", sha256="")
    )
    return resume_command(Path(), msgspec.structs.replace(config, robots=(absent,), clock=msgspec.UNSET)).removesuffix(
        " --out ."
    )


def _robot_options(robots: Sequence[RobotSeat]) -> list[str]:
    """The options that name these robots."""
    agents = [
        robot.agent.name if robot.agent.source.startswith(BUILT_IN_AGENTS) else robot.agent.source for robot in robots
    ]
    names = [
        robot.robot if not robot.robot or plugins.is_built_in("robot", robot.robot) else f"{robot.robot}.py"
        for robot in robots
    ]
    if len(robots) == 1:
        return ["--agent", agents[0], *(("--robot", names[0]) if names[0] else ())]
    # an agent that needs no robot may have been named with any robot
    pairs = (f"{name or 'scout'}:{agent}" for name, agent in zip(names, agents, strict=True))
    return ["--robots", ",".join(pairs)]
