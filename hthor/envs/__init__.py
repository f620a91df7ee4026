"""Trials as environments of libraries for learning and control; `hthor.envs.composer_trial` is the dm_env one.

Begin with `trial_environment`.
"""

from hthor.envs.action_arrays import action_spec, decode_action, encode_action
from hthor.envs.composer_trial import trial_environment

__all__ = ["action_spec", "decode_action", "encode_action", "trial_environment"]
