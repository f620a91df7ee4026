"""The points of the prior's unit cube at which to simulate."""

import numpy as np

from hthor import seeds

_EDGE = 1e-4
"""Points stay this far from the cube's faces, where an unbounded prior has no finite quantile."""
_DIGITS = 9


def sobol_points(count: int, dimensions: int, seed: int, *names: str) -> np.ndarray:
    """(count, dimensions) float64, points that fill the unit cube evenly: a scrambled Sobol sequence.

    The first points are the same for every ``count``, so that more points can be added later.
    """
    from scipy.stats import qmc

    rng = np.random.Generator(np.random.Philox(seeds.derive(seed, "points", *names)))
    power = max(0, int(np.ceil(np.log2(max(count, 1)))))
    return round_points(qmc.Sobol(dimensions, scramble=True, rng=rng).random_base2(power)[:count])


def round_points(points: np.ndarray) -> np.ndarray:
    """The same points, kept away from the faces and rounded, so that a file gives exactly the same points."""
    inside: np.ndarray = np.round(np.clip(points, _EDGE, 1.0 - _EDGE), _DIGITS)
    return inside
