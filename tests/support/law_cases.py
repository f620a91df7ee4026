"""With how many cases hypothesis tries a law."""

from __future__ import annotations

import os

PROFILE = os.environ.get("HYPOTHESIS_PROFILE", "hthor")
"""hthor: at each commit the same cases, so that a change breaks a test, or it does not. explore: each time others."""


def cases(all_of_them: int) -> int:
    """A third of the cases at each commit, all when others are explored, as every night."""
    return all_of_them if PROFILE == "explore" else max(all_of_them // 3, 5)
