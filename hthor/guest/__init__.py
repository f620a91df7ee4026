"""A submitted agent, in a process of its own; knows nothing of worlds, tasks or scores.

The agent's file is never imported here: what it is called, which privileges it asks for and every action come over
pipes as typed, bounded messages. The process is a clean start of the interpreter with a small environment; it dies
with its parent. How strongly it is held is a level, from a mere process to namespaces of its own: docs/isolation.md.
"""

from __future__ import annotations

from hthor.guest.choosing import confine_guests, in_force
from hthor.guest.confinement import Isolation, IsolationError, suffices
from hthor.guest.host import Guest, GuestFault, GuestInfo, load_info

__all__ = [
    "Guest",
    "GuestFault",
    "GuestInfo",
    "Isolation",
    "IsolationError",
    "confine_guests",
    "in_force",
    "load_info",
    "suffices",
]
