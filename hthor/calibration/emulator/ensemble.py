"""Several networks that have each been kept from a part of the points.

Their mean foretells better than one, and their disagreement tells how sure it is. Pilots first find out which
parameters matter; the others are made hard to use, so that they are not mistaken for causes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hthor import seeds
from hthor.calibration.emulator import mlp
from hthor.calibration.emulator.mlp import Network
from hthor.calibration.emulator.single_thread import alone

Array = np.ndarray[Any, Any]

MEMBERS = 6
"""Networks in a committee."""
PILOTS = 2
"""Networks that find out which parameters matter."""
_LEAST_SCALE = 0.05
_PILOT_TRIALS = 3000
_WELL_BELOW = 1e-3


def fit(
    told: Array,
    asked: Array,
    point: Array,
    width: int,
    seed: int,
    name: str,
    members: int = MEMBERS,
    epochs: int = mlp.EPOCHS,
) -> tuple[Network, ...]:
    """A committee for inputs (N, F) and outcomes (N, K) of 0 and 1.

    Args:
        point: (N,) number of each trial's point.
        width: how many of the inputs, the first ones, are parameters, which are weighed by how much they matter.
        seed, name: of the networks' chances. epochs: passes over the trials.
    """
    scale = _scale(told, asked, width, seed, name, epochs)
    fold = folds(point, seed, members)
    return tuple(
        mlp.fit(told[fold != out], asked[fold != out], seeds.derive(seed, "network", name, out), scale, epochs)
        for out in range(members)
    )


def folds(point: Array, seed: int, members: int) -> Array:
    """(N,) which member does not see a trial, if any: all trials of a point go together, and nobody misses many."""
    numbers, of_trial = np.unique(point, return_inverse=True)
    order = np.argsort(np.random.Generator(np.random.Philox(seeds.derive(seed, "folds"))).random(len(numbers)))
    found: Array = (order % max(members, MEMBERS))[of_trial]
    return found


def unseen(members: tuple[Network, ...], told: Array, point: Array, seed: int) -> tuple[Array, Array]:
    """Rows (M,) of the training that some member has not seen, and that member's answers (M, K)."""
    fold = folds(point, seed, len(members))
    rows = np.concatenate([np.flatnonzero(fold == out) for out in range(len(members))])
    with alone():
        return rows, np.concatenate([member(told[fold == out]) for out, member in enumerate(members)])


def _scale(told: Array, asked: Array, width: int, seed: int, name: str, epochs: int) -> Array:
    """Weights of the inputs, by what they do to the answers of pilots: parameters that do nothing fall silent."""
    first = np.ones(told.shape[1])
    first[:width] = 0.5
    pilots = [mlp.fit(told, asked, seeds.derive(seed, "pilot", name, k), first, epochs) for k in range(PILOTS)]
    every = max(1, len(told) // _PILOT_TRIALS)
    with alone():
        slopes = mlp.sensitivity(pilots, told[::every])[:width]
    scale = np.ones(told.shape[1])
    scale[:width] = np.maximum(slopes / max(float(slopes.max()), _WELL_BELOW), _LEAST_SCALE)
    return scale
