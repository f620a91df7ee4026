"""Several networks, each trained without a part of the points.

Their mean predicts better than one, and their disagreement says how sure it is. Pilot networks first find out which
parameters matter; the others are scaled down, so that they are not mistaken for causes.
"""

from typing import Any

import numpy as np

from hthor import seeds
from hthor.calibration.emulator import mlp
from hthor.calibration.emulator.mlp import Network
from hthor.calibration.emulator.single_thread import single_thread

Array = np.ndarray[Any, Any]

MEMBERS = 6
"""Networks in an ensemble."""
PILOTS = 2
"""Networks that find out which parameters matter."""
_LEAST_SCALE = 0.05
_PILOT_TRIALS = 3000
_LEAST_SLOPE = 1e-3


def fit_ensemble(
    inputs: Array,
    outcomes: Array,
    point: Array,
    width: int,
    seed: int,
    name: str,
    members: int = MEMBERS,
    epochs: int = mlp.EPOCHS,
) -> tuple[Network, ...]:
    """An ensemble for inputs (N, F) and outcomes (N, K) of 0 and 1.

    Args:
        point: (N,) number of each trial's point.
        width: how many of the inputs, the first ones, are parameters, which are weighted by how much they matter.
        seed, name: of the networks' chances. epochs: passes over the trials.
    """
    scale = _scale(inputs, outcomes, width, seed, name, epochs)
    fold = assign_folds(point, seed, members)
    return tuple(
        mlp.fit_network(
            inputs[fold != out], outcomes[fold != out], seeds.derive(seed, "network", name, out), scale, epochs
        )
        for out in range(members)
    )


def assign_folds(point: Array, seed: int, members: int) -> Array:
    """(N,) which member is not trained on a trial, if any: all trials of a point go together, no member misses many."""
    numbers, of_trial = np.unique(point, return_inverse=True)
    order = np.argsort(np.random.Generator(np.random.Philox(seeds.derive(seed, "folds"))).random(len(numbers)))
    folds: Array = (order % max(members, MEMBERS))[of_trial]
    return folds


def _scale(inputs: Array, outcomes: Array, width: int, seed: int, name: str, epochs: int) -> Array:
    """Weights of the inputs, by what they do to the predictions of pilots: parameters that do nothing get the least."""
    first = np.ones(inputs.shape[1])
    first[:width] = 0.5
    pilots = [
        mlp.fit_network(inputs, outcomes, seeds.derive(seed, "pilot", name, k), first, epochs) for k in range(PILOTS)
    ]
    every = max(1, len(inputs) // _PILOT_TRIALS)
    with single_thread():
        slopes = mlp.sensitivity(pilots, inputs[::every])[:width]
    scale = np.ones(inputs.shape[1])
    scale[:width] = np.maximum(slopes / max(float(slopes.max()), _LEAST_SLOPE), _LEAST_SCALE)
    return scale
