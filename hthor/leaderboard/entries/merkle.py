"""One hash of many rows, of which no row can be exchanged, moved or taken away."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

_LEAF, _NODE = b"\x00", b"\x01"  # so that no inner node can pass for a row


def root(rows: Sequence[bytes]) -> str:
    """The root of the rows' Merkle tree, 64 hexadecimal digits; an odd one out moves up as it is."""
    level = [hashlib.sha256(_LEAF + row).digest() for row in rows]
    if not level:
        return hashlib.sha256().hexdigest()
    while len(level) > 1:
        pairs = [
            hashlib.sha256(_NODE + one + other).digest() for one, other in zip(level[::2], level[1::2], strict=False)
        ]
        level = pairs + level[2 * len(pairs) :]
    return level[0].hex()
