"""Which levels of isolation this machine gives, for tests that want one."""

from __future__ import annotations

import functools

import pytest

from hthor.guest import in_force
from hthor.guest.confinement import IsolationError

BETWEEN = pytest.param("L2", marks=pytest.mark.nightly)
"""L3 is L2 in namespaces of its own; what is no matter of confinement is tried at L2 in the night only."""
EVERY, CONFINED = ("L1", BETWEEN, "L3"), (BETWEEN, "L3")


def need(level: str) -> str:
    """The same level; skips the test, with the reason, where the machine does not give it."""
    if reason := _missing(level):
        pytest.skip(reason)
    return level


@functools.cache
def _missing(level: str) -> str:
    try:
        in_force(level)
    except IsolationError as error:
        return str(error).partition(". ")[0]
    return ""
