"""Where an agent's own files are, and their names in its manifest."""

import os
import sys
from pathlib import Path

from msgspec import Struct

from hthor.guest.agent import reference
from hthor.guest.agent.reference import AgentReference
from hthor.guest.confinement import paths

_NEVER = ("__pycache__", ".git")


class AgentPaths(Struct, frozen=True, kw_only=True):
    """The folders of an agent's files.

    Attributes:
        root: the agent's folder, empty if it has none.
        base: the agent's part of ``root``: all of it, or its package or module among installed libraries.
        apart: folders in ``root`` that are not the agent's: installed libraries, this package, caches.
        readable: files and folders elsewhere that the user lets the agent read.
    """

    root: str
    base: str
    apart: tuple[str, ...] = ()
    readable: tuple[str, ...] = ()

    def owns(self, path: str) -> bool:
        """Whether a path is the agent's own folder or inside it."""
        if not self.base or not _below(path, self.base):
            return False
        parts = path[len(self.base) :].split(os.sep)
        return not any(part in _NEVER for part in parts) and not any(_below(path, folder) for folder in self.apart)

    def name(self, path: str) -> str | None:
        """A path's name in the manifest; None if it is not part of the agent."""
        for place in (os.path.normpath(path), os.path.realpath(path)):
            if self.owns(place):
                return os.path.relpath(place, self.root).replace(os.sep, "/")
            for readable in self.readable:
                if _below(place, readable):
                    return f"../{os.path.relpath(place, os.path.dirname(readable))}".replace(os.sep, "/")
        return None

    def find(self, name: str) -> Path:
        """The path of the file with this name in the manifest."""
        if name.startswith("../"):
            for readable in self.readable:
                if _below(name[3:], os.path.basename(readable)):
                    return Path(os.path.dirname(readable), name[3:])
        return Path(self.root, name)


def find_agent_paths(agent: AgentReference, readable: tuple[str, ...] = ()) -> AgentPaths:
    """The folders of an agent; ``readable`` as in `AgentPaths`."""
    base = root = agent.root
    if agent.module and any(_below(root, os.path.realpath(folder)) for folder in paths.library_folders()):
        base = os.path.join(root, agent.module.partition(".")[0])
        base = base if os.path.isdir(base) else f"{base}.py"
    strangers = [*_strangers(), os.path.join(root, "runs")]
    apart = [folder for folder in strangers if root and folder != root and _below(folder, root)]
    if agent.words:  # a command may name files anywhere; if none is its own, the agent is the program
        named = [str(path) for path in reference.own_files(agent.words)] or [agent.words[0]]
        readable += tuple(path for path in named if not (root and _below(path, root)))
    return AgentPaths(root=root, base=base, apart=tuple(sorted(set(apart))), readable=tuple(dict.fromkeys(readable)))


def _strangers() -> list[str]:
    """Folders whose files belong to no agent."""
    places = [sys.prefix, sys.base_prefix, sys.exec_prefix, *paths.library_folders(), str(paths.PACKAGE), "runs"]
    if compiled := os.environ.get("NUMBA_CACHE_DIR", ""):
        places.append(compiled)
    return [form for place in places for form in (os.path.abspath(place), os.path.realpath(place))]


def _below(path: str, folder: str) -> bool:
    return path == folder or path.startswith(folder.rstrip(os.sep) + os.sep)
