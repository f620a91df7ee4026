"""What a calibration came to, as data and as tables; computes nothing."""

from __future__ import annotations

from msgspec import Struct


class Summary(Struct, frozen=True, kw_only=True):
    """To be done."""

    passed: bool = True
