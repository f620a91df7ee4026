"""Tasks: kinds, suites and their making; knows nothing of worlds, agents or people."""

from __future__ import annotations

from hthor.tasks.library import Suite, suite, suites

__all__ = ["Suite", "suite", "suites"]
