"""A submitted agent, in a process of its own.

The agent is never imported here: what it is called, which privileges it asks for and every action come over a wire as
typed, bounded messages: docs/wire.md. The process is a clean start with a small environment; it dies with its parent.
How strongly it is held is a level, from a mere process to namespaces of its own: docs/isolation.md.
"""

from __future__ import annotations

from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.agent.reference import AgentReference, is_served
from hthor.guest.confinement import SERVED, Isolation, IsolationError, suffices
from hthor.guest.host.channel import GuestFault
from hthor.guest.host.config import GuestConfig
from hthor.guest.host.guest import Guest, in_force, load_info
from hthor.guest.host.guest_pool import GuestPool
from hthor.guest.host.info import GuestInfo
from hthor.guest.host.websocket_client import Unreachable

CODE_PART = "tools"

__all__ = [
    "SERVED",
    "AgentInputs",
    "AgentReference",
    "File",
    "Guest",
    "GuestConfig",
    "GuestFault",
    "GuestInfo",
    "GuestPool",
    "Isolation",
    "IsolationError",
    "Manifest",
    "Unreachable",
    "in_force",
    "is_served",
    "load_info",
    "suffices",
]
