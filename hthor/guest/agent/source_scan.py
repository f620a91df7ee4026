"""Finds the files that an agent's sources name, without running them.

A file that is imported late, or opened by a library in C, is not recorded while the agent starts.
"""

import ast
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from hthor.guest.agent.agent_paths import AgentPaths

_MOST_BYTES = 4 << 20
"""Longest file that is searched [bytes]."""
_LONGEST = 300
_WORD = re.compile(rb"[A-Za-z0-9_@+.~-][A-Za-z0-9_@+.~/-]{0,299}")
_DEEPEST = 3
"""Depth of nested folders whose names a source gives one by one."""


def referenced_files(first: Iterable[str], paths: AgentPaths) -> set[str]:
    """These files, and every file of the agent's own that they name, and so on. All paths are absolute."""
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
    """Strings in a source that can be names of files, and the modules that it imports anywhere, with their level."""
    try:
        tree = ast.parse(data)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set(), set()
    words: set[str] = set()
    modules: set[tuple[int, str]] = set()
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # doc strings name no files
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
    """Files that an import reads: those of the module and of its parent packages."""
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
    """Files that are named, in these folders or in their subfolders that are named too."""
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
