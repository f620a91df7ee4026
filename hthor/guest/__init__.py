"""A submitted agent, in a process of its own; knows nothing of worlds, tasks or scores.

The agent is never imported here: what it is called, which privileges it asks for and every action come over a wire as
typed, bounded messages: docs/wire.md. The process is a clean start with a small environment; it dies with its parent.
How strongly it is held is a level, from a mere process to namespaces of its own: docs/isolation.md.
"""

from __future__ import annotations

from hthor.guest.choosing import confine_guests, in_force
from hthor.guest.confinement import SERVED, Isolation, IsolationError, suffices
from hthor.guest.faults import GuestFault
from hthor.guest.given import Given
from hthor.guest.host import Guest, load_info
from hthor.guest.info import GuestInfo
from hthor.guest.manifest import File, Manifest
from hthor.guest.reference import Reference, is_served
from hthor.guest.served import Unreachable

CODE_PART = "tools"

__all__ = [
    "SERVED",
    "File",
    "Given",
    "Guest",
    "GuestFault",
    "GuestInfo",
    "Isolation",
    "IsolationError",
    "Manifest",
    "Reference",
    "Unreachable",
    "confine_guests",
    "in_force",
    "is_served",
    "load_info",
    "suffices",
]
