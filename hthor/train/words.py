"""Word vectors of all classes: GloVe, 50 numbers a word (Pennington et al. 2014), in the public domain.

`scripts/word_vectors.py` makes the table.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

TABLE = Path(__file__).with_name("words.npz")


def word_vectors(classes: Sequence[str]) -> NDArray[np.float32]:
    """(classes, 50) vectors of length 1; for a name of several words, the direction of their mean.

    Raises:
        KeyError: when the table lacks a word.
    """
    with np.load(io.BytesIO(TABLE.read_bytes())) as held:
        vector = dict(zip(held["words"].tolist(), held["vectors"], strict=True))
    mean = np.stack([np.mean([vector[word] for word in name.split("_")], axis=0) for name in classes])
    return np.asarray(mean / np.linalg.norm(mean, axis=1, keepdims=True), np.float32)
