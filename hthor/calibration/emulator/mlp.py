"""Small networks that predict several yes-or-no outcomes at once."""

import warnings
from contextlib import AbstractContextManager
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.errors import MissingExtra

Array = np.ndarray[Any, Any]

HIDDEN = (48, 48)
"""Units of the hidden layers."""
EPOCHS = 20
"""Passes over the trials; a fixed number, as held-out trials of the same people would not show overfitting."""
ALPHA = 0.3
"""L2 penalty, for about 25 outcomes at once."""
_BATCHES = 64
"""Steps of a pass over the trials, unless a batch would be outside these limits:"""
_LEAST_BATCH, _MOST_BATCH = 32, 512
_STEP = 2e-3
_CHUNK = 16384
MEMBERS = 6
"""Networks in an ensemble."""
PILOTS = 2
"""Networks that show which parameters matter."""
_LEAST_SCALE = 0.05
_PILOT_TRIALS = 3000
_LEAST_SLOPE = 1e-3


class Network(Struct, frozen=True, kw_only=True, eq=False):
    """Layers of rectified units, and a logistic one at the end; float32."""

    weights: tuple[Array, ...]
    biases: tuple[Array, ...]

    def __call__(self, inputs: Array, first: int | None = None) -> Array:
        """(N, K) float64 probabilities of K outcomes, or of the ``first`` of them, for inputs (N, F)."""
        rows = inputs.astype(np.float32)
        return np.concatenate([self._run(rows[at : at + _CHUNK], first) for at in range(0, max(1, len(rows)), _CHUNK)])

    def _run(self, layer: Array, first: int | None) -> Array:
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            layer = layer @ weight
            layer += bias
            np.maximum(layer, 0.0, out=layer)
        logits = layer @ self.weights[-1][:, :first] + self.biases[-1][:first]
        chance: Array = (1.0 / (1.0 + np.exp(-np.clip(logits, -30.0, 30.0)))).astype(np.float64)
        return chance


def fit_network(inputs: Array, outcomes: Array, seed: int, scale: Array | None = None, epochs: int = EPOCHS) -> Network:
    """A network fitted to inputs (N, F) and outcomes (N, K) of 0 and 1, K at least 2.

    Args:
        seed: seed of the first weights and of the order of trials; it gives the same network on machines of one kind.
        scale: (F,) factor of each input; an input with a small factor is hard to use, so the fit leaves it out.

    Raises:
        MissingExtra: without scikit-learn.
    """
    try:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.neural_network import MLPClassifier
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    weights = np.ones(inputs.shape[1]) if scale is None else scale
    model = MLPClassifier(
        hidden_layer_sizes=HIDDEN,
        alpha=ALPHA,
        batch_size=min(len(inputs), max(_LEAST_BATCH, min(_MOST_BATCH, len(inputs) // _BATCHES))),
        learning_rate_init=_STEP,
        max_iter=epochs,
        tol=0.0,
        random_state=seed % 2**32,
    )
    with warnings.catch_warnings(), single_thread():
        warnings.simplefilter("ignore", ConvergenceWarning)
        model.fit((inputs * weights).astype(np.float32), outcomes.astype(np.int64))
    first, *others = (weight.astype(np.float32) for weight in model.coefs_)
    biases = tuple(bias.astype(np.float32) for bias in model.intercepts_)
    return Network(weights=(first * weights[:, None].astype(np.float32), *others), biases=biases)


def sensitivity(networks: list[Network], inputs: Array, step: float = 0.1) -> Array:
    """(F,) how much the networks' answers change with each input: root mean square slope."""

    def answer(at: Array) -> Array:
        total: Array = np.mean([network(at) for network in networks], axis=0)
        return total

    base = answer(inputs)
    slopes = []
    for place in range(inputs.shape[1]):
        moved = inputs.copy()
        moved[:, place] += step
        slopes.append(np.sqrt(np.mean(((answer(moved) - base) / step) ** 2)))
    return np.array(slopes)


def single_thread() -> AbstractContextManager[Any]:
    """A context in which numerical libraries use one thread.

    Raises:
        MissingExtra: without the extra `calibration`.
    """
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    limits: AbstractContextManager[Any] = threadpool_limits(1)
    return limits


def fit_ensemble(
    inputs: Array,
    outcomes: Array,
    point: Array,
    width: int,
    seed: int,
    name: str,
    members: int = MEMBERS,
    epochs: int = EPOCHS,
) -> tuple[Network, ...]:
    """An ensemble for inputs (N, F) and outcomes (N, K) of 0 and 1; ``point`` (N,) has each trial's point number.

    The first ``width`` inputs are parameters, which are weighted by how much they matter.
    """
    scale = _input_scale(inputs, outcomes, width, seed, name, epochs)
    fold = assign_folds(point, seed, members)
    return tuple(
        fit_network(inputs[fold != out], outcomes[fold != out], seeds.derive(seed, "network", name, out), scale, epochs)
        for out in range(members)
    )


def assign_folds(point: Array, seed: int, members: int) -> Array:
    """(N,) the member not trained on each trial, if any: the same for all trials of a point, evenly over members."""
    numbers, of_trial = np.unique(point, return_inverse=True)
    order = np.argsort(np.random.Generator(np.random.Philox(seeds.derive(seed, "folds"))).random(len(numbers)))
    folds: Array = (order % max(members, MEMBERS))[of_trial]
    return folds


def _input_scale(inputs: Array, outcomes: Array, width: int, seed: int, name: str, epochs: int) -> Array:
    """Factors of the inputs, by their effect on the predictions of pilots: parameters without effect get the least."""
    first = np.ones(inputs.shape[1])
    first[:width] = 0.5
    pilots = [fit_network(inputs, outcomes, seeds.derive(seed, "pilot", name, k), first, epochs) for k in range(PILOTS)]
    every = max(1, len(inputs) // _PILOT_TRIALS)
    with single_thread():
        slopes = sensitivity(pilots, inputs[::every])[:width]
    scale = np.ones(inputs.shape[1])
    scale[:width] = np.maximum(slopes / max(float(slopes.max()), _LEAST_SLOPE), _LEAST_SCALE)
    return scale
