"""The only module that imports MuJoCo and dm_control; it does so without loading OpenGL.

On import, both packages look for a display and warn if there is none. Here they are imported with OpenGL switched off:
a trial needs no pictures, and `rendering` makes its own context for the first picture. A program can still draw with
either package itself, see `late_opengl`.
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
