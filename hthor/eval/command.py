"""The command that plays a run, or the rest of it, as a person would type it; knows nothing of logs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hthor.detectors import OWN
from hthor.eval.setup import PROCEDURAL, Setup
from hthor.eval.shard import whole_folder
from hthor.types import RobotSeat


def of(folder: Path, plan: Setup) -> str:
    """The command that finishes a run, or a shard of one."""
    parts = [f"hthor eval{_who(plan.robots)} --humans {plan.humans.source}"]
    if plan.kind is not None and plan.kind.sha256:
        parts.append(f"--kind {plan.kind.name}.py")
        parts += [] if (folder / "suite.json").exists() else [f"--suite {plan.suite.name}"]
    else:
        parts.append(f"--suite {plan.suite.name}" + (f" --kind {plan.kind.name}" if plan.kind else ""))
    parts += [] if plan.assets.name == PROCEDURAL else [f"--assets {plan.assets.name}"]
    detector = next((robot.detector for robot in plan.seats), OWN)
    parts += [] if detector == OWN else [f"--detector {detector}"]
    parts += ["--realtime"] if getattr(plan, "realtime", False) else []
    parts.append(f"--seed {plan.seed} --participants {plan.participants}")
    parts.append(f"--shard {plan.shard.words} --out {whole_folder(folder)}" if plan.shard else f"--out {folder}")
    return " ".join(parts)


def _who(robots: Sequence[RobotSeat]) -> str:
    """The options that name these robots."""
    minds = [
        robot.agent.name if robot.agent.source.startswith("hthor.agents.") else robot.agent.source for robot in robots
    ]
    bodies = [f"{robot.robot}.py" if robot.robot_sha256 else robot.robot for robot in robots]
    if len(robots) == 1:
        return f" --agent {minds[0]}" + (f" --robot {bodies[0]}" if bodies[0] else "")
    # a mind that wants no robot may have been asked for with any body
    pairs = (f"{body or 'scout'}:{mind}" for body, mind in zip(bodies, minds, strict=True))
    return f" --robots {','.join(pairs)}"
