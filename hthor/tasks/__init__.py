"""Tasks: kinds, suites and their making."""

from __future__ import annotations

from hthor.tasks.suites.library import Suite, suite, suites

CODE_ROOT = "makers"

__all__ = ["Suite", "suite", "suites"]
