"""What keeps a guest from all that is not its business.

Three levels, each with what the one before has: L1, a process with limits; L2, with Landlock and seccomp; L3, in
namespaces of its own. See `Isolation` for what a result says of it.
"""

from __future__ import annotations

from hthor.guest.confinement.isolation import AUTO, LEVELS, SERVED, Isolation, IsolationError, check_level, suffices
from hthor.guest.confinement.policy import Policy

__all__ = ["AUTO", "LEVELS", "SERVED", "Isolation", "IsolationError", "Policy", "check_level", "suffices"]
