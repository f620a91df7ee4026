"""The one place that imports MuJoCo and dm_control, without waking OpenGL; knows nothing of houses.

Both packages look for a display when they are imported and complain when there is none. Here they are told not to
look: a trial needs no picture, and `rendering` makes its own context when someone asks for one.
"""

from __future__ import annotations

import os

_VARIABLE = "MUJOCO_GL"
_before = os.environ.get(_VARIABLE)
os.environ[_VARIABLE] = "disable"
try:
    import mujoco
    from dm_control import composer, mjcf
    from dm_control.composer import Arena, Entity, Environment
finally:
    if _before is None:
        del os.environ[_VARIABLE]
    else:
        os.environ[_VARIABLE] = _before

__all__ = ["Arena", "Entity", "Environment", "composer", "mjcf", "mujoco"]
