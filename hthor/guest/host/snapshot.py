"""An agent's manifest: made when a run begins, and compared with the disk whenever a trial begins and ends.

The agent says which files it has opened, while it comes up and in a beginning that is only tried. The host adds what
the sources name and what the user made readable, and hashes all of it itself.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from hthor import code_identity, rules
from hthor.errors import AgentError
from hthor.guest.agent import command, digests, manifest, source_scan
from hthor.guest.agent.agent_paths import Grounds
from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.agent.reference import Reference
from hthor.guest.confinement import hiding
from hthor.guest.host.guest import Guest
from hthor.guest.protocol.faults import GuestFault
from hthor.types import BodySpec, Briefing

_SKIPPED = (".git", "runs", "__pycache__")
_RUN = "run.json"
_MOST_READABLE = 20_000


def settle(guest: Guest, name: str) -> Manifest:
    """The manifest of an agent; its guest is brought up, and of no further use.

    Args:
        name: what a result calls it.

    Raises:
        AgentError: when it cannot be loaded, or a file cannot be read.
    """
    info, agent, grounds = guest.load(), guest.reference, guest.grounds
    if agent.url:
        return Manifest(name=name, source=info.source, sha256=info.sha256, files=info.manifest, claimed=True)
    if not info.absent and not agent.words:
        _try_beginning(guest, info.privileges)
    args = {key: _shown(value, grounds) for key, value in guest.inputs.args.items()}
    files = files_of(agent, guest.inputs, grounds, guest.take_opened())
    return manifest.of(name, info.source, args, files, _library(files, grounds))


def _library(files: Iterable[File], grounds: Grounds) -> str:
    """Hash of what the Python files among these import of hthor, and of all that needs."""
    python = [grounds.find(file.path) for file in files if file.path.endswith(".py")]
    read = [path for path in python if code_identity.is_python(path)]
    return code_identity.ours().sha256((), files=read) if read else ""


def files_of(agent: Reference, given: AgentInputs, grounds: Grounds, opened: Iterable[str]) -> tuple[File, ...]:
    """The files of an agent, with their hashes, sorted.

    Args:
        opened: names of files that it has said it opened.

    Raises:
        AgentError: when a file cannot be read.
    """
    first = [str(path) for path in _first(agent)]
    first += [value for value in given.args.values() if os.path.isabs(value) and os.path.isfile(value)]
    first += [str(path) for path in _real(opened, grounds)]
    hidden = _hidden(agent.root, agent.path)
    named = {path for path in source_scan.closure(first, grounds) if not _below_any(path, hidden)}
    paths = {*named, *_readable(grounds)}
    return tuple(sorted({_file(path, grounds) for path in paths}))


def later(names: Iterable[str], known: Manifest, grounds: Grounds, agent: str = "") -> tuple[File, ...]:
    """Files that an agent has opened and that are not in its manifest.

    Args:
        agent: the agent's own file.

    Raises:
        AgentError: when one of them cannot be read.
    """
    new = list(_real(set(names) - {file.path for file in known.files}, grounds))
    hidden = _hidden(grounds.root, agent) if new else []
    return tuple(sorted({_file(str(path), grounds) for path in new if not _below_any(str(path), hidden)}))


def check(known: Manifest, grounds: Grounds) -> None:
    """See that an agent's files are as they were when its run began.

    Raises:
        AgentError: names the first that is not.
    """
    if known.claimed:
        return
    held = {file.path: file for file in known.files}
    for path in _readable(grounds):
        name = grounds.name(path)
        if name is not None and name not in held:
            raise AgentError(changed(path, "is new: it was not there when its run began"))
    examine(held.values(), grounds)


def examine(files: Iterable[File], grounds: Grounds, *, since: str = "while its run was going on") -> None:
    """See that these files are as their hashes say.

    Raises:
        AgentError: names the first that is not.
    """
    for file in files:
        path = grounds.find(file.path)
        try:
            same = digests.read(path)[0] == file.sha256
        except OSError:
            raise AgentError(changed(str(path), f"was removed {since}")) from None
        if not same:
            raise AgentError(changed(str(path), f"was changed {since}"))


def changed(path: str, what: str) -> str:
    """What to tell a user whose agent is not the one that a run began with."""
    return (
        f"{path} {what}. Change it back and repeat the command to finish this run, or evaluate the new version in a "
        "run of its own."
    )


def _first(agent: Reference) -> list[Path]:
    """The files that are the agent by its name alone."""
    if agent.words:
        return command.own_files(agent.words) or [Path(agent.words[0])]
    return [Path(agent.path)]


def _try_beginning(guest: Guest, privileges: tuple[str, ...]) -> None:
    """Let the agent begin a trial that is never played, for the files that it opens. How that ends is no matter."""
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


def _real(names: Iterable[str], grounds: Grounds) -> Iterator[Path]:
    """The files of these names, without what is no file of the agent's, whoever claims that."""
    for name in sorted(set(names)):
        path = grounds.find(name)
        if grounds.name(str(path)) == name and path.is_file():
            yield path


def _readable(grounds: Grounds) -> Iterator[str]:
    """Every file that the user lets the agent read beyond its own folder."""
    for place in grounds.readable:
        if os.path.isfile(place):
            yield place
            continue
        hidden, count = _hidden(place), 0
        for folder, inner, names in os.walk(place):
            inner[:] = sorted(
                name for name in inner if name not in _SKIPPED and not os.path.isfile(os.path.join(folder, name, _RUN))
            )
            for name in sorted(names):
                path = os.path.join(folder, name)
                if not os.path.isfile(path) or _below_any(path, hidden):
                    continue
                count += 1
                if count > _MOST_READABLE:
                    raise AgentError(
                        f"--readable {place} has more than {_MOST_READABLE} files, all of which would be part of the "
                        "agent. Name the folders or files in there that it needs."
                    )
                yield path


def _hidden(folder: str, agent: str = "") -> list[str]:
    """What in a folder isolation hides from every agent. It is no part of one, though at L1 it could be read."""
    return [str(path) for path in hiding.below(Path(folder).resolve(), agent)] if folder else []


def _below_any(path: str, folders: Iterable[str]) -> bool:
    return any(Path(path).is_relative_to(folder) for folder in folders)


def _file(path: str, grounds: Grounds) -> File:
    name = grounds.name(path) or f"../{os.path.basename(path)}"
    try:
        sha256, size = digests.read(Path(path))
    except OSError as error:
        raise AgentError(f"cannot read the agent's file {path}: {error.strerror}.") from None
    return File(path=name, sha256=sha256, bytes=size)


def _shown(value: str, grounds: Grounds) -> str:
    """An argument as a result shows it: a path as the manifest has it, without the folders of this machine."""
    if not os.path.isabs(value) or not os.path.exists(value):
        return value
    return grounds.name(value) or value
