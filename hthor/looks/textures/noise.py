"""Smooth random fields that repeat without a seam, and colors mixed by them."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from hthor.types import Vec2, Vec3

Maker = Callable[[], Any]
"""Makes a picture (H, W, 3) of floats, 0 to 1."""
Book = Mapping[str, tuple[Maker, float]]
"""Textures by name: their maker, and the metres that one repeat covers (0 for a picture that is stretched)."""


def dice(seed: int) -> np.random.Generator:
    """A random generator with a seed of its own."""
    return np.random.Generator(np.random.PCG64(seed))


def field(size: tuple[int, int], blur: float | Vec2, seed: int) -> Any:
    """Noise (H, W), 0 to 1, blurred by ``blur`` pixels (down, along); opposite edges fit together."""
    down, along = (blur, blur) if isinstance(blur, (int, float)) else blur
    white = np.fft.rfft2(dice(seed).standard_normal(size))
    y = np.exp(-2.0 * (np.pi * down * np.fft.fftfreq(size[0])) ** 2)
    x = np.exp(-2.0 * (np.pi * along * np.fft.rfftfreq(size[1])) ** 2)
    noise = np.fft.irfft2(white * y[:, None] * x[None, :], size)
    low, high = float(noise.min()), float(noise.max())
    return (noise - low) / (high - low)


def fractal(size: tuple[int, int], blur: float, seed: int, octaves: int = 4) -> Any:
    """Noise (H, W), 0 to 1, summed over several fields, each half as coarse and half as strong as the one before."""
    total = sum(0.5**k * (field(size, blur / 2**k, seed + k) - 0.5) for k in range(octaves))
    low, high = float(np.min(total)), float(np.max(total))
    return (total - low) / (high - low)


def mix(share: Any, first: Vec3, second: Vec3) -> Any:
    """Colors (..., 3): ``first`` where ``share`` is 0, ``second`` where it is 1."""
    part = np.clip(share, 0.0, 1.0)[..., None]
    return np.array(first) * (1.0 - part) + np.array(second) * part


def grey(values: Any) -> Any:
    """A field as a grey picture."""
    return np.repeat(np.clip(values, 0.0, 1.0)[..., None], 3, axis=-1)


def places(size: tuple[int, int]) -> tuple[Any, Any]:
    """Row and column coordinates of every pixel's middle, 0 to 1."""
    y, x = ((np.arange(n) + 0.5) / n for n in size)
    rows, columns = np.meshgrid(y, x, indexing="ij")
    return rows, columns
