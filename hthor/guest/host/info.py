"""Records of what the agents of a run are given, and of how an agent describes itself."""

import hashlib
import math

import msgspec
from msgspec import Struct

from hthor.errors import AgentError
from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.agent.manifest import File
from hthor.guest.agent.reference import AgentReference
from hthor.guest.confinement import AUTO, Isolation, check_level
from hthor.guest.host.connected_programs import ConnectedPrograms
from hthor.guest.protocol import versions, wire
from hthor.guest.protocol.wire import is_printable_name, sanitize_text


class GuestConfig(Struct, frozen=True, kw_only=True):
    """Settings of every guest of a run; the workers receive them with everything else that they need.

    Attributes:
        isolation: "L1", "L2", "L3", or "auto" for the strongest level that starts on this machine.
        hidden: files and folders that no agent may read, even in its own folder.
        inputs: constructor arguments, and files beyond the agent's own folder.
        programs: where programs connect to this process; None where none can, as in every worker.
    """

    isolation: str = AUTO
    hidden: tuple[str, ...] = ()
    inputs: AgentInputs = AgentInputs()
    programs: ConnectedPrograms | None = None

    def __post_init__(self) -> None:
        """Check the level.

        Raises:
            UnknownName: when there is no such level.
        """
        check_level(self.isolation)


class GuestInfo(Struct, frozen=True, kw_only=True):
    """An agent's description of itself.

    Attributes:
        sha256: hash of its file alone (its `Manifest` lists the rest); for an agent that runs elsewhere, of all that
            it says, ``manifest`` included.
        robots: the bodies that it is made for, empty for any. absent: whether there is no robot at all.
        persistent: whether one process serves all its trials. gpus: the share of a GPU that it needs.
        isolation: how it was confined when it gave this description.
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
    """The record of an agent that has started.

    Raises:
        AgentError: when its description of itself is invalid.
    """
    if problem := versions.describe_mismatch(ready.wire, served=bool(reference.url)):
        raise AgentError(f"{reference.text}: {problem}")
    unknown = [name for name in ready.privileges if name not in wire.PRIVILEGES]
    if unknown:
        valid = ", ".join(wire.PRIVILEGES)
        raise AgentError(f"{reference.text}: its privileges name '{sanitize_text(unknown[0][:80])}'. Valid: {valid}.")
    if not math.isfinite(ready.gpus) or ready.gpus < 0:
        raise AgentError(f"{reference.text}: gpus must be a number from 0 on, got {ready.gpus}.")
    for name in (ready.name, *ready.robots):
        if not is_printable_name(name, wire.NAME_MAX):
            most = f"at most {wire.NAME_MAX} characters that can be seen"
            raise AgentError(f"{reference.text}: a name has {most}, got '{sanitize_text(name[:80])}'.")
    python = reference.form in ("file", "module")
    claimed = reference.elsewhere
    return GuestInfo(
        name=reference.name if python else ready.name or reference.name,
        source=reference.source,
        sha256=hashlib.sha256(msgspec.json.encode(ready)).hexdigest() if claimed else sha256,
        privileges=ready.privileges,
        robots=ready.robots,
        absent=ready.absent,
        persistent=ready.persistent or claimed,
        doc=sanitize_text(ready.doc)[: wire.TEXT_MAX],
        gpus=ready.gpus,
        manifest=ready.manifest if claimed else (),
        isolation=held,
    )
