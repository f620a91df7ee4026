"""Packs columns of small whole numbers into text: booleans as bits, numbers in a few bytes each."""

import base64
import binascii

import numpy as np

_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"
LABELS_MAX = len(_DIGITS)


def pack_bits(values: np.ndarray) -> str:
    """Pack a column of booleans: eight per byte, the first in the highest bit; base64."""
    return _text(np.packbits(values.astype(bool)).tobytes())


def unpack_bits(text: str, count: int) -> np.ndarray:
    """The column that `pack_bits` packed, (count,) bool.

    Raises:
        ValueError: if the text does not have ``count`` values, or its unused bits are not zero.
    """
    held = np.unpackbits(np.frombuffer(_data(text, -(-count // 8)), dtype=np.uint8))
    if held[count:].any():
        raise ValueError("has bits set after the last trial")
    return held[:count].astype(bool)


def pack_numbers(values: np.ndarray, size: int) -> str:
    """Pack a column of whole numbers: ``size`` bytes each, the lowest byte first; base64.

    Raises:
        ValueError: if a number does not fit into ``size`` bytes.
    """
    whole = values.astype(np.int64)
    if (whole < 0).any() or (whole >= 1 << (8 * size)).any():
        raise ValueError(f"{int(whole.max())} does not fit into {size} bytes")
    return _text(whole.astype("<u8")[:, None].view(np.uint8).reshape(-1, 8)[:, :size].tobytes())


def unpack_numbers(text: str, count: int, size: int) -> np.ndarray:
    """The column that `pack_numbers` packed, (count,) int64.

    Raises:
        ValueError: if the text does not have ``count`` values.
    """
    held = np.frombuffer(_data(text, count * size), dtype=np.uint8).reshape(count, size).astype(np.int64)
    whole: np.ndarray = (held << (8 * np.arange(size))).sum(axis=1)
    return whole


def pack_pieces(parts: list[bytes]) -> str:
    """Join pieces of equal length, one after the other; base64."""
    return _text(b"".join(parts))


def unpack_pieces(text: str, count: int, size: int) -> list[bytes]:
    """The pieces that `pack_pieces` joined.

    Raises:
        ValueError: if the text does not have ``count`` pieces.
    """
    held = _data(text, count * size)
    return [held[start : start + size] for start in range(0, len(held), size)]


def pack_labels(values: list[int]) -> str:
    """Pack a column of numbers below `LABELS_MAX`, one character each."""
    return "".join(_DIGITS[value] for value in values)


def unpack_labels(text: str, count: int, most: int) -> np.ndarray:
    """The column that `pack_labels` packed, (count,) int64.

    Raises:
        ValueError: if the text does not have ``count`` values, or a value is not below ``most``.
    """
    if len(text) != count:
        raise ValueError(f"has {len(text)} characters for {count} trials")
    held = [_DIGITS.find(one) for one in text]
    if held and not 0 <= min(held) <= max(held) < most:
        raise ValueError(f"refers to label number {most} or above, which does not exist")
    return np.array(held, dtype=np.int64)


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def _data(text: str, size: int) -> bytes:
    try:
        data = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise ValueError(f"is not base64: {error}") from None
    if len(data) != size:
        raise ValueError(f"holds {len(data)} bytes where {size} belong")
    if _text(data) != text:
        raise ValueError("is not canonical base64")
    return data
