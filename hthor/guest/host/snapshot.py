"""Makes an agent's manifest when a run begins: its guest starts, and begins a trial that is never run."""

import os
from collections.abc import Iterable

from hthor import code_identity, rules
from hthor.guest.agent import agent_files, manifest
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.host.channel import GuestFault
from hthor.guest.host.guest import Guest
from hthor.types import BodySpec, Briefing


def take_manifest(guest: Guest, name: str) -> Manifest:
    """The manifest of an agent that results call ``name``. This starts its guest, which is not to be used afterwards.

    Raises:
        AgentError: when it cannot be loaded, or a file cannot be read.
    """
    info, agent, paths = guest.load(), guest.reference, guest.paths
    if agent.elsewhere:
        return Manifest(name=name, source=info.source, sha256=info.sha256, files=info.manifest, claimed=True)
    if not info.absent and not agent.words:
        _try_beginning(guest, info.privileges)
    args = {key: _shown(value, paths) for key, value in guest.inputs.args.items()}
    files = agent_files.list_files(agent, guest.inputs, paths, guest.take_opened())
    return manifest.make_manifest(name, info.source, args, files, _library(files, paths))


def _library(files: Iterable[File], paths: AgentPaths) -> str:
    """Hash of the modules of hthor that the Python files among these import, directly or not."""
    python = [paths.find(file.path) for file in files if file.path.endswith(".py")]
    read = [path for path in python if code_identity.is_python(path)]
    return code_identity.ours().sha256((), files=read) if read else ""


def _try_beginning(guest: Guest, privileges: tuple[str, ...]) -> None:
    """Let the agent begin a trial that is never run, to learn which files it opens. It may fail."""
    house = None
    if "house_map" in privileges:
        from hthor import houses

        house = houses.load("alder")
    body = BodySpec(
        name="scout",
        title="scout",
        radius=0.18,
        height=0.95,
        eye=0.9,
        fov=(2.0, 1.57),
        speed=1.0,
        turn_rate=2.0,
        sight_range=rules.DETECTOR_RANGE_M,
        scan_range=5.0,
        scan_beams=61,
        pitch_limit=rules.PITCH_LIMIT_RAD,
        capabilities=frozenset({"navigate"}),
    )
    briefing = Briefing(
        seat="robot",
        instruction="Find an apple.",
        target="apple",
        destination="",
        relation="find",
        body=body,
        tick_s=rules.TICK_S,
        time_limit=90.0,
        privileges=privileges,
        house=house,
        kind="object_goal_navigation",
        crew={"robot": body},
    )
    try:
        guest.begin(briefing)
    except GuestFault:
        return
    guest.finish()


def _shown(value: str, paths: AgentPaths) -> str:
    """An argument as results show it: a path as in the manifest, without the folders of this machine."""
    if not os.path.isabs(value) or not os.path.exists(value):
        return value
    return paths.name(value) or value
