"""Lists an agent's files with their hashes when a run begins, and compares them with the disk for every trial.

The agent reports the files that it has opened. The host adds the files that its sources name and those that the user
made readable, and computes all hashes itself.
"""

import ast
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from hthor.errors import AgentError
from hthor.guest.agent import manifest, reference
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.agent.reference import AgentReference
from hthor.guest.confinement import hidden_paths

_SKIPPED = (".git", "runs", "__pycache__")
_RUN = "run.json"
_MOST_READABLE = 20_000
_MOST_BYTES = 4 << 20
"""Longest file that is searched [bytes]."""
_LONGEST = 300
_WORD = re.compile(rb"[A-Za-z0-9_@+.~-][A-Za-z0-9_@+.~/-]{0,299}")
_DEEPEST = 3
"""Greatest depth of a file in nested folders that a source names one by one."""


def list_files(
    agent: AgentReference, inputs: AgentInputs, paths: AgentPaths, opened: Iterable[str]
) -> tuple[File, ...]:
    """The files of an agent, with their hashes, sorted; ``opened`` are the files that it has reported as opened.

    Raises:
        AgentError: when a file cannot be read.
    """
    first = [str(path) for path in _first(agent)]
    first += [value for value in inputs.args.values() if os.path.isabs(value) and os.path.isfile(value)]
    first += [str(path) for path in _real(opened, paths)]
    hidden = _hidden(agent.root, agent.path)
    named = {path for path in referenced_files(first, paths) if not _below_any(path, hidden)}
    return tuple(sorted({_file(path, paths) for path in {*named, *_readable(paths)}}))


def unlisted_files(names: Iterable[str], known: Manifest, paths: AgentPaths, agent: str = "") -> tuple[File, ...]:
    """Files that an agent has opened and that are not in its manifest; ``agent`` is the path of its main file.

    Raises:
        AgentError: when such a file cannot be read.
    """
    new = list(_real(set(names) - {file.path for file in known.files}, paths))
    hidden = _hidden(paths.root, agent) if new else []
    return tuple(sorted({_file(str(path), paths) for path in new if not _below_any(str(path), hidden)}))


def check_unchanged(known: Manifest, paths: AgentPaths) -> None:
    """Check that an agent's files have not changed since its run began.

    Raises:
        AgentError: when a file has changed; the message names the first.
    """
    if known.claimed:
        return
    held = {file.path: file for file in known.files}
    for path in _readable(paths):
        name = paths.name(path)
        if name is not None and name not in held:
            raise AgentError(change_message(path, "is new: it was not there when its run began"))
    check_hashes(held.values(), paths)


def check_hashes(files: Iterable[File], paths: AgentPaths, *, since: str = "while its run was going on") -> None:
    """Check these files against their hashes.

    Raises:
        AgentError: when a file has changed; the message names the first.
    """
    for file in files:
        path = paths.find(file.path)
        try:
            same = manifest.hash_file(path)[0] == file.sha256
        except OSError:
            raise AgentError(change_message(str(path), f"was removed {since}")) from None
        if not same:
            raise AgentError(change_message(str(path), f"was changed {since}"))


def change_message(path: str, what: str) -> str:
    """The message to a user whose agent has changed since its run began."""
    return (
        f"{path} {what}. Change it back and repeat the command to finish this run, or evaluate the new version in a "
        "run of its own."
    )


def _first(agent: AgentReference) -> list[Path]:
    """The files that the agent's reference names."""
    if agent.words:
        return reference.own_files(agent.words) or [Path(agent.words[0])]
    return [Path(agent.path)]


def _real(names: Iterable[str], paths: AgentPaths) -> Iterator[Path]:
    """The files with these names that belong to the agent; other names that it reports are ignored."""
    for name in sorted(set(names)):
        path = paths.find(name)
        if paths.name(str(path)) == name and path.is_file():
            yield path


def _readable(paths: AgentPaths) -> Iterator[str]:
    """Every file that the user lets the agent read beyond its own folder."""
    for place in paths.readable:
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
    """Paths that isolation hides from every agent in a folder. They belong to no agent, even if L1 shows them."""
    return [str(path) for path in hidden_paths.hidden_below(Path(folder).resolve(), agent)] if folder else []


def _below_any(path: str, folders: Iterable[str]) -> bool:
    return any(Path(path).is_relative_to(folder) for folder in folders)


def _file(path: str, paths: AgentPaths) -> File:
    name = paths.name(path) or f"../{os.path.basename(path)}"
    try:
        sha256, size = manifest.hash_file(Path(path))
    except OSError as error:
        raise AgentError(f"cannot read the agent's file {path}: {error.strerror}.") from None
    return File(path=name, sha256=sha256, bytes=size)


def referenced_files(first: Iterable[str], paths: AgentPaths) -> set[str]:
    """These files and the agent's own files that they name, directly or through other files, as absolute paths."""
    found: set[str] = set()
    left = sorted(set(first))
    while left:
        path = left.pop()
        if path in found:
            continue
        found.add(path)
        if paths.owns(path):
            left += sorted({*_named(path, paths)} - found)
    return found


def _named(path: str, paths: AgentPaths) -> Iterator[str]:
    try:
        if os.path.getsize(path) > _MOST_BYTES:
            return
        data = Path(path).read_bytes()
    except OSError:
        return
    if path.endswith(".py"):
        words, modules = _python(data)
    else:
        words, modules = {word.decode() for word in _WORD.findall(data)} if b"\0" not in data[:4096] else set(), set()
    folder = os.path.dirname(path)
    for level, name in sorted(modules):
        yield from _modules(level, name, folder, paths)
    yield from _files(words, os.path.splitext(path)[1], (paths.root, folder), paths)


def _python(data: bytes) -> tuple[set[str], set[tuple[int, str]]]:
    """Strings in a source that can be names of files, and all modules that it imports, with their import levels."""
    try:
        tree = ast.parse(data)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set(), set()
    words: set[str] = set()
    modules: set[tuple[int, str]] = set()
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings name no files
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules |= {(0, alias.name) for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            modules |= {(node.level, f"{base}.{alias.name}".strip(".")) for alias in node.names}
            modules.add((node.level, base))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            words.add(node.value)
    return words, modules


def _modules(level: int, name: str, folder: str, paths: AgentPaths) -> Iterator[str]:
    """Files that an import reads: the files of the module and of its parent packages."""
    base = paths.root
    if level:
        base = folder
        for _ in range(level - 1):
            base = os.path.dirname(base)
    parts = [part for part in name.split(".") if part]
    for depth in range(len(parts) + 1):
        stem = os.path.join(base, *parts[:depth])
        for path in (os.path.join(stem, "__init__.py"), f"{stem}.py"):
            if (depth or level) and paths.owns(path) and os.path.isfile(path):
                yield path


def _files(words: Iterable[str], suffix: str, bases: Iterable[str], paths: AgentPaths) -> Iterator[str]:
    """Files among these words, in the folders ``bases`` or in subfolders of them that are also among the words."""
    usable = sorted(word for word in words if word and len(word) <= _LONGEST and "\0" not in word and "\n" not in word)
    folders = set(bases)
    tried: set[str] = set()
    for _ in range(_DEEPEST):
        fresh = folders - tried
        tried |= fresh
        for base in sorted(fresh):
            for word in usable:
                path = os.path.normpath(os.path.join(base, word))
                if not paths.owns(path):
                    continue
                if os.path.isdir(path):
                    folders.add(path)
                    continue
                for one in (path, f"{path}{suffix}" if suffix and suffix != ".py" else path):
                    if os.path.isfile(one):
                        yield one
