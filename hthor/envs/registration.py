"""Gymnasium's names of the environments."""

import importlib.util

IDS = {
    "hthor/Assist-v0": "hthor.envs.learning.assist:AssistEnv",
    "hthor/ObjectNav-v0": "hthor.envs.learning.object_nav:ObjectNavEnv",
}
"""The environments' ids and their classes."""


def register() -> None:
    """Make ``gymnasium.make`` know the environments, where Gymnasium is installed."""
    if importlib.util.find_spec("gymnasium") is None:
        return
    from gymnasium.envs.registration import register as register_one
    from gymnasium.envs.registration import registry

    for id, entry_point in IDS.items():
        if id not in registry:
            register_one(id=id, entry_point=entry_point)
