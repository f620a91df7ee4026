"""A submitted agent, in a process of its own; knows nothing of worlds, tasks or scores.

The agent's file is never imported here: what it is called, which privileges it asks for and every action come over
two pipes as typed, bounded messages. The process is a clean start of the interpreter with a small environment; it
dies with its parent. That keeps truth out of an agent's reach and faults out of the evaluation, but it is no sandbox
against malice: whoever runs unknown code should do so inside a container.
"""

from __future__ import annotations

from hthor.guest.host import Guest, GuestFault, GuestInfo, load_info

__all__ = ["Guest", "GuestFault", "GuestInfo", "load_info"]
