"""Checks of houses by the physics engine: drops, penetration, soundness."""
