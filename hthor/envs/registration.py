"""Gymnasium's names of the environments."""

import importlib.util
import sys

from hthor.errors import MissingExtra

IDS = {
    "hthor/Assist-v0": "hthor.envs.learning.assist:AssistEnv",
    "hthor/ObjectNav-v0": "hthor.envs.learning.object_nav:ObjectNavEnv",
}
"""The environments' ids and their classes."""


def register() -> None:
    """Make ``gymnasium.make`` know the environments; ``import hthor.envs`` after ``import gymnasium`` does it too.

    Raises:
        MissingExtra: when Gymnasium is not installed.
    """
    if importlib.util.find_spec("gymnasium") is None:
        raise MissingExtra("an environment of Gymnasium", "learn")
    from gymnasium.envs.registration import register as register_one
    from gymnasium.envs.registration import registry

    for id, entry_point in IDS.items():
        if id not in registry:
            register_one(id=id, entry_point=entry_point)


def register_if_used() -> None:
    """`register`, if Gymnasium was imported already."""
    if "gymnasium" in sys.modules:
        register()
