"""Tasks in a house: kinds of task, suites of tasks, and how both are made.

Begin with `kind` (the contract of a kind of task) and `suites.library` (how a suite is read).
"""

from hthor.tasks.suite import Suite
from hthor.tasks.suites.library import load_suite, suite_names

CODE_ROOT = "makers"

__all__ = ["Suite", "load_suite", "suite_names"]
