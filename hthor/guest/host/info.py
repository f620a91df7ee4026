"""What a submitted agent is, as a record."""

from __future__ import annotations

import hashlib
import math

import msgspec
from msgspec import Struct

from hthor.errors import AgentError
from hthor.guest.agent.manifest import File
from hthor.guest.agent.reference import AgentReference
from hthor.guest.confinement import Isolation
from hthor.guest.protocol import wire
from hthor.guest.protocol.sanitize import is_printable_name, sanitize_text


class GuestInfo(Struct, frozen=True, kw_only=True):
    """What an agent says of itself. ``robots`` names the bodies it is made for (empty: any); ``absent`` means none.

    ``persistent`` agents keep one process for all their trials. ``sha256`` is the hash of the file alone; what else
    it consists of is in its `Manifest`. Of a served agent it is the hash of what the server says of it, ``manifest``
    included. ``isolation`` is what held the agent while it was asked. ``gpus`` is how much of a GPU it asks for.
    """

    name: str
    source: str
    sha256: str
    privileges: tuple[str, ...] = ()
    robots: tuple[str, ...] = ()
    absent: bool = False
    persistent: bool = False
    doc: str = ""
    gpus: float = 0.0
    manifest: tuple[File, ...] = ()
    isolation: Isolation


def make_info(reference: AgentReference, sha256: str, ready: wire.Ready, held: Isolation) -> GuestInfo:
    """What is known of an agent that has come up.

    Raises:
        AgentError: when it says of itself what cannot be.
    """
    unknown = [name for name in ready.privileges if name not in wire.PRIVILEGES]
    if unknown:
        valid = ", ".join(wire.PRIVILEGES)
        raise AgentError(f"{reference.text}: its privileges name '{sanitize_text(unknown[0][:80])}'. Valid: {valid}.")
    if ready.wire != wire.VERSION:
        raise AgentError(f"{reference.text}: it speaks version {ready.wire} of the wire, valid is {wire.VERSION}.")
    if not math.isfinite(ready.gpus) or ready.gpus < 0:
        raise AgentError(f"{reference.text}: gpus must be a number from 0 on, got {ready.gpus}.")
    for name in (ready.name, *ready.robots):
        if not is_printable_name(name, wire.NAME_MAX):
            most = f"at most {wire.NAME_MAX} characters that can be seen"
            raise AgentError(f"{reference.text}: a name has {most}, got '{sanitize_text(name[:80])}'.")
    python = reference.form in ("file", "module")
    served = reference.form == "served"
    return GuestInfo(
        name=reference.name if python else ready.name or reference.name,
        source=reference.source,
        sha256=hashlib.sha256(msgspec.json.encode(ready)).hexdigest() if served else sha256,
        privileges=ready.privileges,
        robots=ready.robots,
        absent=ready.absent,
        persistent=ready.persistent or served,
        doc=sanitize_text(ready.doc)[: wire.TEXT_MAX],
        gpus=ready.gpus,
        manifest=ready.manifest if served else (),
        isolation=held,
    )
