"""Checks on numbers that callers pass in, and how messages show them."""

import math
from collections.abc import Iterable
from typing import Any

from msgspec import UNSET

from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.types import Pose, Vec2, Vec3


def is_finite(value: object) -> bool:
    """Whether ``value`` is a number that is not infinite, not NaN and not too large for a float."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def quoted(value: object) -> str:
    """The text that shows a given value in an error message."""
    try:
        return f"{value!r:.40}"
    except ValueError:  # an integer with more digits than Python prints
        return "a number of thousands of digits"


def format_number(value: float) -> str:
    """A number for a message: with two decimals, or with a power of ten where that would be long."""
    return f"{value:.2f}" if abs(value) < 1e6 else f"{value:.3g}"


def number(name: str, value: object, unit: str, low: float = -math.inf, high: float = math.inf) -> float:
    """``value`` as a float.

    Raises:
        HthorError: when it is not a finite number from ``low`` to ``high``; the message has its ``name`` and ``unit``.
    """
    plain = _plain(value)
    if not is_finite(plain):
        raise HthorError(f"{name} must be a finite number of {unit}, got {quoted(value)}")
    if not low <= plain <= high:
        limits = f"at least {low:g}" if high == math.inf else f"at most {high:g}" if low == -math.inf else ""
        raise HthorError(f"{name} must be {limits or f'from {low:g} to {high:g}'} {unit}, got {quoted(value)}")
    return float(plain)


def whole_number(name: str, value: object, low: int, high: int) -> int:
    """``value`` as an int.

    Raises:
        HthorError: when it is not a whole number from ``low`` to ``high``.
    """
    plain = _plain(value)
    if isinstance(plain, bool) or not isinstance(plain, int) or not low <= plain <= high:
        raise HthorError(f"{name} must be a whole number from {low} to {high}, got {quoted(value)}")
    return plain


def truth(name: str, value: object) -> bool:
    """``value`` as a bool.

    Raises:
        HthorError: when it is none, also for 0 and 1.
    """
    plain = _plain(value)
    if not isinstance(plain, bool):
        raise HthorError(f"{name} must be True or False, got {quoted(value)}")
    return plain


def point2(name: str, value: object) -> Vec2:
    """``value`` as a point (x, y) [m]; raises as `number` does."""
    x, y = _vector(name, value, 2, "metres")
    return (x, y)


def point3(name: str, value: object, unit: str = "metres") -> Vec3:
    """``value`` as a point (x, y, z) [m], or a vector of another ``unit``; raises as `number` does."""
    x, y, z = _vector(name, value, 3, unit)
    return (x, y, z)


def pose(value: Pose) -> Pose:
    """The same pose with its headings in (-pi, pi]; raises as `number` does if a number is not finite."""
    x, y = number("x", value.x, "metres"), number("y", value.y, "metres")
    yaw, pitch = number("yaw", value.yaw, "radians"), number("pitch", value.pitch, "radians")
    head = UNSET if value.head is UNSET else plane.wrap(number("head", value.head, "radians"))
    return Pose(x=x, y=y, yaw=plane.wrap(yaw), pitch=pitch, head=head)


def _plain(value: object) -> Any:
    """A number of NumPy as Python's own; anything else as it is."""
    return value.item() if hasattr(value, "item") and getattr(value, "ndim", 1) == 0 else value


def _vector(name: str, value: object, size: int, unit: str) -> tuple[float, ...]:
    parts = list(value) if isinstance(value, Iterable) and not isinstance(value, (str, bytes, dict)) else []
    if len(parts) != size:
        raise HthorError(f"{name} must be {size} numbers of {unit}, got {quoted(value)}")
    return tuple(number(f"{name}[{axis}]", part, unit) for axis, part in enumerate(parts))
