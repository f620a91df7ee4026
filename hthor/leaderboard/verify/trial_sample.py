"""Which trials are played again: a sample that nobody could know when the entry was handed in; plays nothing."""

from __future__ import annotations

import hashlib


def sample(word: str, digest: str, count: int, size: int) -> list[int]:
    """``size`` of the numbers below ``count``, or all of them when there are no more; in order.

    Args:
        word: public chance that came to be after the entry was handed in, such as a later commit's hash.
        digest: of the entry, so that the same word draws others for another entry.
    """
    key = hashlib.sha256(f"hthor draw\n{word}\n{digest}\n".encode()).digest()

    def lot(number: int) -> bytes:
        return hashlib.sha256(key + number.to_bytes(8, "little")).digest()

    return sorted(sorted(range(count), key=lot)[:size])
