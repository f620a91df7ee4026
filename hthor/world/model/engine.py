"""The one place that imports MuJoCo and dm_control, without waking OpenGL.

Both packages look for a display when they are imported and complain when there is none. Here they are told not to
look yet: a trial needs no picture, and `rendering` makes its own context when someone asks for one. A program that
draws with either of them itself still can, see `late_opengl`.
"""

import os
import sys

from hthor.world.model import late_opengl

_VARIABLE = "MUJOCO_GL"
_before, _loaded = os.environ.get(_VARIABLE), tuple(sys.modules)
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
late_opengl.choose_later(_loaded)

__all__ = ["Arena", "Entity", "Environment", "composer", "mjcf", "mujoco"]
