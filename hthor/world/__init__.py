"""The simulator: a house with bodies and objects, their actions and sensors; only this package uses MuJoCo.

Begin with `world` (for scripts) or `simulation` (one tick at a time, for trials).
"""

from hthor.world.world import World

__all__ = ["World"]
