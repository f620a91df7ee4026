"""The simulator: a house with bodies and objects, what they can do and what they see; the only user of MuJoCo.

Begin with `world` (for scripts) or `simulation` (one tick at a time, for trials).
"""

from hthor.world.world import World

__all__ = ["World"]
