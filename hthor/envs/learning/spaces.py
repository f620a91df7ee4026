"""The spaces of a robot that learns, and what it observes in them."""

from typing import Any, Literal

import numpy as np
from gymnasium import spaces

from hthor.agents.skills.learner import LearnerView
from hthor.agents.skills.learner.actions import action_names
from hthor.agents.skills.learner.state import state_size
from hthor.errors import UnknownName
from hthor.types import BodySpec, cameras
from hthor.types.cameras import OWN

Sight = Literal["state", "rgbd"]
"""What is observed: the state alone, or the state and pictures."""
SIGHTS = ("state", "rgbd")
SIDE = 64
"""Width and height of the pictures [pixels]."""


def camera_name(sight: str) -> str:
    """The robots' camera for what is observed; raises UnknownName when that is none of `SIGHTS`."""
    if sight not in SIGHTS:
        raise UnknownName("observation", sight, SIGHTS)
    return cameras.canonical_name(f"{SIDE}x{SIDE}") if sight == "rgbd" else OWN


def observation_space(jobs: int, sight: str) -> spaces.Space[Any]:
    """The space of `LearnerView.state`, or of a dict of it as "state" and of `LearnerView.rgbd` as "rgbd"."""
    state = spaces.Box(-1.0, 1.0, (state_size(jobs),), np.float32)
    if sight == "state":
        return state
    return spaces.Dict({"rgbd": spaces.Box(0, 255, (SIDE, SIDE, 4), np.uint8), "state": state})


def action_space(body: BodySpec, jobs: int, talks: bool = True) -> spaces.Discrete:
    """The numbers of `hthor.agents.skills.learner.actions.action_names`."""
    return spaces.Discrete(len(action_names(body, jobs, talks)))


def observe(view: LearnerView, sight: str) -> Any:
    """What a robot observes now, in the space of `observation_space`."""
    state = view.state()
    return state if sight == "state" else {"rgbd": view.rgbd(), "state": state}
