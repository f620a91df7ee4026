"""Confines a process at one of three levels. Begin with `enforcement`.

L1 is a process with limits, L2 adds Landlock and seccomp, and L3 adds namespaces. Results describe it by `Isolation`.
"""

from hthor.guest.confinement.isolation import (
    AUTO,
    LEVELS,
    SERVED,
    Isolation,
    IsolationError,
    Policy,
    check_level,
    suffices,
)

__all__ = ["AUTO", "LEVELS", "SERVED", "Isolation", "IsolationError", "Policy", "check_level", "suffices"]
