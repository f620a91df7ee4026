"""Imports an agent's own modules from their sources alone, never from compiled files that lie beside them.

A compiled file can be older than its source, or of another: then what runs would not be what was hashed.
"""

from __future__ import annotations

import sys
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, FileFinder, SourceFileLoader
from types import CodeType
from typing import Any

from hthor.guest.agent.agent_paths import Grounds


class SourceLoader(SourceFileLoader):
    """Compiles a module anew whenever it is imported."""

    def get_code(self, fullname: str) -> CodeType:
        """The module's code."""
        path = self.get_filename(fullname)
        code: CodeType = self.source_to_code(self.get_data(path), path)
        return code


def only_from(grounds: Grounds) -> None:
    """From now on this process imports what lies in an agent's folder from sources and extension modules."""
    make = FileFinder.path_hook((ExtensionFileLoader, EXTENSION_SUFFIXES), (SourceLoader, [".py"]))

    def hook(path: str) -> Any:
        if path != grounds.root and not grounds.owns(path):
            raise ImportError("not the agent's own", path=path)
        return make(path)

    sys.path_hooks.insert(0, hook)
    for path in [path for path in sys.path_importer_cache if path == grounds.root or grounds.owns(path)]:
        del sys.path_importer_cache[path]
