"""Finds files that an agent may not read in its own folder: runs, logs, suites, populations, boards and salts of hthor.

They are recognized by their content, whatever their names and places. The search is bounded: folders that it did not
reach are hidden as well.
"""

import os
import re
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path

_NEVER = (".git", "runs")
_RUN = ("run.json", "trials.jsonl", "sessions.jsonl")
"""A folder with one of these files, written by hthor, is hidden with everything in it."""
_FAULTS = "faults"
_OURS = re.compile(
    rb'"schema":\s?"hthor\.(?!checkpoint/)|"floorPolygon"|"sha256":\s?"[0-9a-f]{64}",\s?"version":\s?\d+,\s?"tasks":'
)
"""Marks of hthor's documents: a schema, other than that of a robot's own weights; the rooms of a house; the head of a
suite.
"""
_LINE = re.compile(rb'"(human_sha256|rules_sha256)"|"check":"[0-9a-f]{8}"\}\n')
"""Marks of a log's lines."""
_SALT = re.compile(rb"[0-9a-f]{64}\s*")
_SALT_BYTES = range(64, 68)
_READ_BYTES, _ENTRIES_MAX, _BYTES_MAX = 1 << 18, 250_000, 1 << 28
_FRESH_S = 30.0
"""A folder is searched again after this time: new runs may have been written there."""
_known: dict[tuple[str, str], tuple[float, tuple[Path, ...]]] = {}


def hidden_below(root: Path, agent: str = "") -> tuple[Path, ...]:
    """Files and folders below ``root`` that no agent may read.

    In the folders that contain ``agent``, the agent's own file, only hthor's files are hidden.
    """
    key, now = (str(root), agent), time.monotonic()
    if key not in _known or now - _known[key][0] > _FRESH_S:
        _known[key] = now, tuple(_Walk(agent).hidden(root))
    return _known[key][1]


class _Walk:
    """One search of a folder, breadth first."""

    def __init__(self, agent: str) -> None:
        self._agent = Path(agent) if agent else None
        self._entries, self._bytes = 0, 0

    def hidden(self, root: Path) -> Iterator[Path]:
        """Files and folders to hide in a folder and below."""
        left = deque([root])
        while left:
            folder = left.popleft()
            if self._entries > _ENTRIES_MAX or self._bytes > _BYTES_MAX:
                yield folder
                continue
            try:
                with os.scandir(folder) as entries:
                    found = sorted(entries, key=lambda one: one.name)
            except OSError:
                continue
            self._entries += len(found)
            yield from self._members(folder, found, left, top=folder == root)

    def _members(self, folder: Path, found: list[os.DirEntry[str]], left: deque[Path], *, top: bool) -> Iterator[Path]:
        documents = [Path(one.path) for one in found if one.is_file(follow_symlinks=False) and self._is_ours(one)]
        names = {path.name for path in documents}
        holds_agent = self._agent is not None and self._agent.is_relative_to(folder)
        if names.intersection(_RUN) and not holds_agent and not top:
            yield folder
            return
        yield from documents
        tables = {path.with_suffix(".npz") for path in documents}
        yield from (Path(one.path) for one in found if Path(one.path) in tables)
        for one in found:
            if one.is_dir(follow_symlinks=False):
                of_run = one.name == _FAULTS and names.intersection(_RUN)
                if of_run or (top and one.name in _NEVER):
                    yield Path(one.path)
                else:
                    left.append(Path(one.path))

    def _is_ours(self, entry: os.DirEntry[str]) -> bool:
        """Whether this is one of hthor's files that no agent may read."""
        try:
            if entry.name.endswith((".json", ".jsonl")):
                pattern = _OURS if entry.name.endswith(".json") else _LINE
                return pattern.search(self._head(entry.path)) is not None
            if entry.stat(follow_symlinks=False).st_size in _SALT_BYTES:
                return _SALT.fullmatch(self._head(entry.path)) is not None
        except OSError:  # an agent cannot read it either
            return False
        return False

    def _head(self, path: str) -> bytes:
        with open(path, "rb") as file:
            head = file.read(_READ_BYTES)
        self._bytes += len(head)
        return head
