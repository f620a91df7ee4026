"""What is seen through windows: a sky with clouds and a line of trees, painted by numbers."""

from typing import Any

import numpy as np

from hthor import seeds

_SIDE = 256
_ZENITH, _HORIZON = np.array((0.36, 0.58, 0.86)), np.array((0.86, 0.93, 0.98))
_LEAVES, _GRASS = np.array((0.38, 0.52, 0.30)), np.array((0.52, 0.64, 0.36))


def sky() -> Any:
    """Six square pictures one below the other, (6 S, S, 3) uint8: right, left, up, down, front, back."""
    axis = (np.arange(_SIDE) + 0.5) / _SIDE * 2.0 - 1.0
    s, t = np.meshgrid(axis, axis)
    one = np.ones_like(s)
    directions = ((one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one))
    faces = [_colour(*direction) for direction in directions]
    return np.concatenate(faces).astype(np.uint8)


def _colour(x: Any, y: Any, z: Any) -> Any:
    """Colour by direction; y is up."""
    length = np.sqrt(x * x + y * y + z * z)
    rise, angle = y / length, np.arctan2(z, x)
    share = np.clip(rise / 0.7, 0.0, 1.0)[..., None] ** 0.6
    colour = _HORIZON * (1.0 - share) + _ZENITH * share
    clouds = _waves(3.0 * x / (np.abs(y) + 0.35), 3.0 * z / (np.abs(y) + 0.35))
    veil = (np.clip(clouds - 0.15, 0.0, 0.8) * np.clip(rise * 5.0, 0.0, 1.0))[..., None]
    colour = colour * (1.0 - 0.8 * veil) + 0.8 * veil
    crown = 0.055 + 0.03 * np.sin(7 * angle + 1) + 0.02 * np.sin(17 * angle) + 0.012 * np.sin(43 * angle + 2)
    trees = np.clip((crown - rise) * 90.0, 0.0, 1.0)[..., None]
    leaves = _LEAVES * (1.0 + 0.12 * np.sin(60 * angle) * np.sin(130 * rise + 9 * angle))[..., None]
    colour = colour * (1.0 - trees) + leaves * trees
    ground = np.clip(-rise * 60.0, 0.0, 1.0)[..., None]
    return np.clip(colour * (1.0 - ground) + _GRASS * ground, 0.0, 1.0) * 255.0


def _waves(u: Any, v: Any) -> Any:
    """Smooth humps without a grid, from a few sines of seeded directions."""
    total = np.zeros_like(u)
    for octave in range(5):
        turn, shift = (2.0 * np.pi * seeds.draw(0, "sky", name, octave) for name in ("turn", "shift"))
        scale = 1.7**octave
        total += np.sin(scale * (u * np.cos(turn) + v * np.sin(turn)) + shift) / (1.0 + octave)
    return total / 2.0
