"""A submitted agent runs in separate processes and is never imported by the evaluation. Begin with `host.guest`.

Packages are named by the process that their files run in::

    evaluation (host)                    starts a guest, asks for actions, judges answers
      |
    guard                                ends everything when the host or the supervisor has ended (L1 and L2;
      |                                  at L3 bubblewrap does that)
    supervisor                           trusted, confined; imports libraries, forks and watches trial processes
      |-- trial process (client)         confined; imports the agent's file, runs one trial, and ends
      `-- spare (client)                 forked and confined in advance, waits to become the next trial process

`host` and `supervisor` do not import each other; `supervisor` imports `client` to run it in the processes that it
forks. Below them are `protocol` (messages and pipes, docs/wire.md), `agent` (an agent's files and arguments),
`process_tools`, and `confinement` (levels of isolation, docs/isolation.md).
"""

from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.agent.reference import AgentReference, is_served, is_socket
from hthor.guest.confinement import SERVED, Isolation, IsolationError, suffices
from hthor.guest.host.channel import GuestFault, TrialStopped
from hthor.guest.host.guest import Guest, in_force, load_info
from hthor.guest.host.guest_pool import GuestPool
from hthor.guest.host.info import GuestConfig, GuestInfo
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
    "TrialStopped",
    "Unreachable",
    "in_force",
    "is_served",
    "is_socket",
    "load_info",
    "suffices",
]
