"""The only room with the physics engine: a house, its bodies and objects, what they can do and see."""

from __future__ import annotations

from hthor.world.world import World

__all__ = ["World"]
