"""Sums on one thread, so that their last bits do not depend on the number of cores."""

from contextlib import AbstractContextManager
from typing import Any

from hthor.errors import MissingExtra


def single_thread() -> AbstractContextManager[Any]:
    """A context in which numerical libraries use one thread.

    Raises:
        MissingExtra: without scikit-learn, whose dependency does it.
    """
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    limits: AbstractContextManager[Any] = threadpool_limits(1)
    return limits
