"""The command that plays a run, or the rest of it, as a person would type it."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import msgspec

from hthor import plugins
from hthor.eval.config.robot_team import NO_ROBOT_AGENT
from hthor.eval.config.run_config import PROCEDURAL, RunConfig
from hthor.eval.config.shard import whole_folder
from hthor.guest import Manifest
from hthor.types import AgentRef, RobotSeat, cameras
from hthor.types.detector_specs import OWN

BUILT_IN_AGENTS = "hthor.agents."
"""Where built-in agents come from."""


def resume_command(folder: Path, plan: RunConfig, out: Path | None = None) -> str:
    """The command that finishes a run, or a shard of one, as a shell takes it.

    Args:
        out: the folder that it names, when that is not the run's own.
    """
    out = out or folder
    words = ["hthor", "eval", *_robot_options(plan.robots), "--humans", plan.humans.source]
    if plan.kind is not None and plan.kind.sha256:
        words += ["--kind", f"{plan.kind.name}.py"]
        words += [] if (folder / "suite.json").exists() else ["--suite", plan.suite.name]
    else:
        words += ["--suite", plan.suite.name, *(("--kind", plan.kind.name) if plan.kind else ())]
    words += [] if plan.assets.name == PROCEDURAL else ["--assets", plan.assets.name]
    detector = next((robot.detector for robot in plan.seats), OWN)
    words += [] if detector == OWN else ["--detector", detector]
    words += _camera_options(plan)
    words += ["--name", plan.title] if plan.title else []
    words += ["--realtime"] if plan.realtime else []
    words += [word for name in plan.houses or () for word in ("--house", name)]
    words += ["--difficulty", plan.difficulty] if plan.difficulty else []
    words += ["--limit", str(plan.limit)] if plan.limit else []
    words += ["--step-limit", f"{plan.step_limit_s:g}"] if plan.step_limit_s else []
    for one in plan.agents[:1]:  # all agents of a command are given the same
        words += [word for key, value in one.args.items() for word in ("--agent-args", f"{key}={value}")]
        beyond = dict.fromkeys(file.path.split("/")[1] for file in one.files if file.path.startswith("../"))
        words += [word for name in beyond if name not in _listed_files(one) for word in ("--readable", name)]
    words += ["--seed", str(plan.seed), "--participants", str(plan.participants)]
    words += ["--shard", plan.shard.words] if plan.shard else []
    return shlex.join([*words, "--out", str(whole_folder(out) if plan.shard else out)])


def _listed_files(agent: Manifest) -> set[str]:
    """What lies outside an agent's folder and needs no option of its own: arguments, and the words of a command."""
    words = shlex.split(agent.source[len("cmd:") :]) if agent.source.startswith("cmd:") else []
    return {*(value.removeprefix("../") for value in agent.args.values()), *words}


def _camera_options(plan: RunConfig) -> list[str]:
    """The options that name the robots' camera."""
    named = next((robot.camera for robot in plan.seats if robot.camera), cameras.OWN)
    name, _, size = named.partition(":")
    words = [] if name == cameras.OWN else ["--camera", name]
    return [*words, "--camera-size", size] if size else words


def relative_path(path: Path) -> Path:
    """A folder as it can be typed from here: below the current folder without that, elsewhere as it was given."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_absolute() and path.is_relative_to(here) else path


def baseline_command(plan: RunConfig) -> str:
    """The command that plays the same people at the same tasks without a robot."""
    nobody = RobotSeat(
        seat="", robot="", agent=AgentRef(name=NO_ROBOT_AGENT, source=f"{BUILT_IN_AGENTS}{NO_ROBOT_AGENT}", sha256="")
    )
    return resume_command(Path(), msgspec.structs.replace(plan, robots=(nobody,), realtime=msgspec.UNSET)).removesuffix(
        " --out ."
    )


def _robot_options(robots: Sequence[RobotSeat]) -> list[str]:
    """The options that name these robots."""
    minds = [
        robot.agent.name if robot.agent.source.startswith(BUILT_IN_AGENTS) else robot.agent.source for robot in robots
    ]
    bodies = [
        robot.robot if not robot.robot or plugins.is_built_in("robot", robot.robot) else f"{robot.robot}.py"
        for robot in robots
    ]
    if len(robots) == 1:
        return ["--agent", minds[0], *(("--robot", bodies[0]) if bodies[0] else ())]
    # a mind that wants no robot may have been asked for with any body
    pairs = (f"{body or 'scout'}:{mind}" for body, mind in zip(bodies, minds, strict=True))
    return ["--robots", ",".join(pairs)]
