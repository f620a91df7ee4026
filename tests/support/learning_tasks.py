"""Short tasks for tests of environments of learners, and a policy that follows the shortest way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from hthor import tasks
from hthor.agents.skills.learner.state import WAY_M, state_fields
from hthor.tasks.suite import Suite, make_suite

HOUSE = "elder"
NEAR_M = 0.9
ALL_KNOWN = ("ideal_detector", "object_poses", "house_map")


def few(suite: str = "smoke", seconds: float = 6.0, count: int = 3) -> Suite:
    """A few tasks of a suite in one house, with a shorter time limit."""
    found = [task for task in tasks.load_suite(suite).tasks if task.house == HOUSE][:count]
    return make_suite("few", 1, tuple(msgspec.structs.replace(task, time_limit=seconds) for task in found))


def follow_the_way(state: Any, mask: Any, names: Sequence[str]) -> int:
    """Go to the object by the shortest way, look around there, tell the person, and wait."""
    if "tell 1" in names and mask[names.index("tell 1")]:
        return names.index("tell 1")
    fields = {field.name: state[field.start : field.stop] for field in state_fields(1)}
    metres, ahead, left = fields["way 1"]
    if metres * WAY_M < NEAR_M:
        return names.index("wait" if fields["receipt"].any() else "turn left")
    if ahead > np.cos(0.3):
        return names.index("forward")
    return names.index("turn left" if left > 0.0 else "turn right")
