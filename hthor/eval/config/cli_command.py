"""The command that runs or resumes a run, as a user would type it."""

import shlex
from pathlib import Path
from typing import Any

import msgspec

from hthor import plugins
from hthor.eval.config import option
from hthor.eval.config.human_populations import LIVE
from hthor.eval.config.options import EvalOptions
from hthor.eval.config.run_config import PROCEDURAL, RunConfig
from hthor.eval.config.shards import whole_folder
from hthor.guest import Manifest
from hthor.trials.robot_team import NO_ROBOT_AGENT
from hthor.types import AgentRef, RobotSeat, cameras
from hthor.types.detector_specs import OWN

BUILT_IN_AGENTS = f"{plugins.package('agent')}."
"""How the source of a built-in agent begins."""
_ALWAYS = ("humans", "suite", "seed", "participants")
"""Options that a command states even where they are the default, which may be another one tomorrow."""


def resume_command(folder: Path, config: RunConfig, out: Path | None = None) -> str:
    """The shell command that finishes a run or a shard; it writes to ``out``, by default the run's folder."""
    return _command(options_of(config, folder, out or folder))


def _command(options: EvalOptions) -> str:
    command = "eval"
    if any(LIVE in word.split(",") for word in options.humans):  # people at pages, whose clock is that of the wall
        command, options = "live", msgspec.structs.replace(options, clock=EvalOptions().clock)
    return shlex.join(["hthor", command, *option.command_words(options, always=_ALWAYS)])


def options_of(config: RunConfig, folder: Path, out: Path | None) -> EvalOptions:
    """The options that give a run of this configuration, or all runs of its study.

    Args:
        folder: the run's folder, which says whether its tasks were generated for it.
        out: the folder of the run or shard to write to; None for the usual one.
    """
    kind, seats, known = config.kind, config.seats, option.fields(EvalOptions)
    own_kind = kind is not None and bool(kind.sha256)
    camera, _, size = next((robot.camera for robot in seats if robot.camera), cameras.OWN).partition(":")
    agent = next(iter(config.agents), None)  # all agents of a command get the same arguments and files
    return EvalOptions(
        **_robot_options(config),
        agent_args=tuple(f"{key}={value}" for key, value in agent.args.items()) if agent else (),
        readable=tuple(map(Path, _readable_files(agent))) if agent else (),
        humans=(config.humans.source,),
        suite="" if kind is not None and (folder / "suite.json").exists() else config.suite.name,
        kind="" if kind is None else f"{kind.name}.py" if own_kind else kind.name,
        detector=next((robot.detector for robot in seats), OWN),
        camera=camera,
        camera_size=size,
        assets="" if config.assets.name == PROCEDURAL else config.assets.name,
        seed=config.seed,
        participants=config.design.participants if config.design else config.participants,
        house=config.houses or (),
        difficulty=config.difficulty or None,  # type: ignore[arg-type]  # the run was made with one of the words
        limit=config.limit or None,
        out=_out(config, out),
        name=_title(config),
        shard=config.shard.words if config.shard else "",
        step_limit=config.step_limit_s or None,
        control=not config.design,  # no robot is one of its conditions
        design="between" if config.design else "paired",
        clock=config.mode,
        **{name: value for name, value in (config.options or {}).items() if name in known},  # type: ignore[arg-type]
    )


def _out(config: RunConfig, out: Path | None) -> Path | None:
    """The folder that the option names: that of the whole run, and of all conditions of a study."""
    if out is None:
        return None
    whole = whole_folder(out) if config.shard else out
    if not config.design:
        return whole
    return whole.parent if whole.name == config.team_name else None


def _robot_options(config: RunConfig) -> dict[str, Any]:
    """The options that name the run's robots, or all conditions of its between-subjects study."""
    robots = config.seats[:1] if config.design else config.robots
    agents = [agent_word(robot) for robot in robots]
    names = [
        robot.robot if not robot.robot or plugins.is_built_in("robot", robot.robot) else f"{robot.robot}.py"
        for robot in robots
    ]
    if config.design:
        return {"agent": config.design.conditions, "robot": next(iter(names), "")}
    if len(robots) == 1:
        return {"agent": (agents[0],), "robot": names[0]}
    # an agent that needs no robot may have been named with any robot
    return {"robots": ",".join(f"{name or 'scout'}:{agent}" for name, agent in zip(names, agents, strict=True))}


def agent_word(robot: RobotSeat) -> str:
    """The word of the command line for a robot's agent."""
    agent = robot.agent
    return agent.name if agent.source.startswith(BUILT_IN_AGENTS) else agent.source


def _title(config: RunConfig) -> str:
    """The name that the user gave; the runs of a study add their agents to it."""
    title = config.title or ""
    return title.removesuffix(f"-{config.team_name}") if config.design else title


def _readable_files(agent: Manifest) -> list[str]:
    """Files and folders outside an agent's own folder, unless an argument or the agent's own words name them."""
    beyond = dict.fromkeys(file.path.split("/")[1] for file in agent.files if file.path.startswith("../"))
    return [name for name in beyond if name not in _listed_files(agent)]


def _listed_files(agent: Manifest) -> set[str]:
    """Files outside an agent's folder that need no --readable, as arguments or the words of a command name them."""
    words = shlex.split(agent.source[len("cmd:") :]) if agent.source.startswith("cmd:") else []
    head, _, own = agent.source.partition(":")
    words += [own] if plugins.is_built_in("agent", head) else []
    return {*(value.removeprefix("../") for value in agent.args.values()), *words}


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
    alone = msgspec.structs.replace(config, robots=(absent,), clock=msgspec.UNSET)
    return _command(options_of(alone, Path(), None))
