"""Finds settings of a run that differ from the benchmark's; a run with such settings cannot be ranked."""

import functools
from collections.abc import Mapping
from pathlib import Path

from hthor import plugins, tasks
from hthor.eval.config.run_config import PROCEDURAL, RunConfig
from hthor.eval.config.study_design import BETWEEN
from hthor.tasks.suites import library
from hthor.trials.sessions import sessions_needed
from hthor.types.detector_specs import OWN


def overridden_settings(config: RunConfig, team: tuple[str, ...] = (), played: int | None = None) -> dict[str, str]:
    """Settings that differ from the benchmark's, with their values.

    Args:
        team: the robots that the suite is made for; empty if that is not known.
        played: how many different tasks were played, if that is known.
    """
    found: dict[str, str] = {}
    if config.humans.people:
        found["humans"] = config.humans.source
    if config.design:  # its number of people is that of all groups
        found["design"] = BETWEEN
    elif config.sessions != sessions_needed(suite_size(config) or played or config.trials):
        found["participants"] = str(config.participants)
    if config.limit:
        found["limit"] = str(config.limit)
    if config.houses:
        found["house"] = ", ".join(config.houses)
    if config.difficulty:
        found["difficulty"] = config.difficulty
    if config.step_limit_s:
        found["step_limit"] = f"{config.step_limit_s:g}"
    if config.kind is not None:
        found["kind"] = config.kind.name
    if config.assets.name != PROCEDURAL:
        found["assets"] = config.assets.name
    for seat in config.seats:
        if seat.detector != OWN:
            found["detector"] = seat.detector
        if seat.camera:
            found["camera"] = seat.camera
        if not plugins.is_built_in("robot", seat.robot):
            found["robot"] = f"{seat.robot}.py"
    bodies = tuple(seat.robot for seat in config.seats)
    if bodies and team and bodies != team:
        found["robots"] = ",".join(bodies)
    return found


def refusal(folder: Path, config: RunConfig, found: Mapping[str, str]) -> str:
    """Say why such a run is not accepted, and which run would be."""
    options = [f"--{name.replace('_', '-')} {value}" for name, value in found.items()]
    listed = f"{', '.join(options[:-1])} and {options[-1]}" if len(options) > 1 else options[0]
    why = "entries are compared trial by trial, so they all have the benchmark's settings"
    if "participants" in found and (size := suite_size(config)):
        every = f"each of the {size} tasks of '{config.suite.name}' done once, by {sessions_needed(size)} people"
        why += f", with {every}; this run has {config.trials} trials"
    return (
        f"{folder} was played with {listed}, and cannot stand on the leaderboard: {why}. Play it again without "
        f"{'these options' if len(options) > 1 else 'this option'}, into another folder."
    )


def suite_size(config: RunConfig) -> int | None:
    """How many tasks the suite has; None if the suite is not part of this version of hthor."""
    if config.suite.name not in tasks.suite_names():
        return None
    sha256, size = _size(config.suite.name)
    return size if sha256 == config.suite.sha256 else None


@functools.cache
def _size(name: str) -> tuple[str, int]:
    """The hash of a suite that is part of hthor, and how many tasks it has."""
    suite = library.read_suite(name)
    return suite.sha256, len(suite.tasks)
