"""Settings of a run that depart from the benchmark's, with which it cannot be ranked."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path

from hthor import plugins, tasks
from hthor.eval.config.run_config import PROCEDURAL, RunConfig
from hthor.eval.config.sessions import participants_needed
from hthor.tasks.suites import library
from hthor.types.detector_specs import OWN


def of(plan: RunConfig, crew: tuple[str, ...] = (), played: int | None = None) -> dict[str, str]:
    """What is set otherwise, and how.

    Args:
        crew: the bodies that the suite is made for, empty when that is not known.
        played: how many different tasks were played, where that is known.
    """
    found: dict[str, str] = {}
    if plan.participants != participants_needed(tasks_of(plan) or played or plan.trials):
        found["participants"] = str(plan.participants)
    if plan.limit:
        found["limit"] = str(plan.limit)
    if plan.houses:
        found["house"] = ", ".join(plan.houses)
    if plan.difficulty:
        found["difficulty"] = plan.difficulty
    if plan.step_limit_s:
        found["step_limit"] = f"{plan.step_limit_s:g}"
    if plan.kind is not None:
        found["kind"] = plan.kind.name
    if plan.assets.name != PROCEDURAL:
        found["assets"] = plan.assets.name
    for seat in plan.seats:
        if seat.detector != OWN:
            found["detector"] = seat.detector
        if seat.camera:
            found["camera"] = seat.camera
        if not plugins.is_built_in("robot", seat.robot):
            found["robot"] = f"{seat.robot}.py"
    bodies = tuple(seat.robot for seat in plan.seats)
    if bodies and crew and bodies != crew:
        found["robots"] = ",".join(bodies)
    return found


def refusal(folder: Path, plan: RunConfig, found: Mapping[str, str]) -> str:
    """Why such a run does not go on the board, and what would."""
    options = [f"--{name.replace('_', '-')} {value}" for name, value in found.items()]
    listed = f"{', '.join(options[:-1])} and {options[-1]}" if len(options) > 1 else options[0]
    why = "entries are compared trial by trial, so they all have the benchmark's settings"
    if "participants" in found and (size := tasks_of(plan)):
        every = f"each of the {size} tasks of '{plan.suite.name}' done once, by {participants_needed(size)} people"
        why += f", with {every}; this run has {plan.trials} trials"
    return (
        f"{folder} was played with {listed}, and cannot stand on the leaderboard: {why}. Play it again without "
        f"{'these options' if len(options) > 1 else 'this option'}, into another folder."
    )


def tasks_of(plan: RunConfig) -> int | None:
    """How many tasks the suite has; None of one that does not ship with hthor in this version."""
    if plan.suite.name not in tasks.suite_names():
        return None
    sha256, size = _size(plan.suite.name)
    return size if sha256 == plan.suite.sha256 else None


@functools.cache
def _size(name: str) -> tuple[str, int]:
    """The hash of a suite that ships, and how many tasks it has."""
    suite = library.read_suite(name)
    return suite.sha256, len(suite.tasks)
