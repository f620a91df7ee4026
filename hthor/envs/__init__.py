"""Trials as environments of libraries for learning and control.

`hthor.envs.composer_trial` is the dm_env one: begin with `trial_environment`. `hthor.envs.learning` has those of
Gymnasium and PettingZoo, which need the extra ``learn``: ``import hthor.envs`` makes ``gymnasium.make`` know
"hthor/Assist-v0" and "hthor/ObjectNav-v0".
"""

import importlib
from typing import TYPE_CHECKING

from hthor.envs.registration import register

if TYPE_CHECKING:
    from hthor.envs.action_arrays import action_spec, decode_action, encode_action
    from hthor.envs.composer_trial import trial_environment
    from hthor.envs.learning.assist import AssistEnv
    from hthor.envs.learning.object_nav import ObjectNavEnv
    from hthor.envs.learning.parallel import AssistParallelEnv

_MODULES = {
    "action_spec": "action_arrays",
    "decode_action": "action_arrays",
    "encode_action": "action_arrays",
    "trial_environment": "composer_trial",
    "AssistEnv": "learning.assist",
    "ObjectNavEnv": "learning.object_nav",
    "AssistParallelEnv": "learning.parallel",
}
"""The module of each name, which is imported when the name is first used."""
__all__ = [
    "AssistEnv",
    "AssistParallelEnv",
    "ObjectNavEnv",
    "action_spec",
    "decode_action",
    "encode_action",
    "trial_environment",
]


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module 'hthor.envs' has no attribute '{name}'")
    return getattr(importlib.import_module(f"hthor.envs.{_MODULES[name]}"), name)


register()
