"""Imports the libraries that an agent's file names, once for all its trials; never the file itself.

Only installed libraries and the parts of this package that agents may use are imported. Errors are ignored here: the
file's own import will raise them again.
"""

import ast
import contextlib
import gc
import importlib.util
import sys
from pathlib import Path

from hthor.guest.confinement import paths

_MINDS = "hthor.agents"
_MOST_BYTES = 1 << 20
"""Longest file that is parsed [bytes]."""
_SIDE_EFFECTS = ("__main__", "antigravity", "idlelib", "lib2to3", "this", "turtledemo")
"""Parts of the names of modules whose import has side effects; parts that begin with "test" count too."""
_OURS = ("hthor.types", "hthor.navigation", "hthor.agents", "hthor.geometry", "hthor.catalog", "hthor.rules")


def preload(path: Path, module: str = "") -> None:
    """Import the modules that the file will import, and freeze them so that forks share their memory.

    If the agent is imported by name, as ``module``, nothing of its own package is imported here.
    """
    own = module.partition(".")[0]
    wanted = [one for one in _named(path) if one[0].partition(".")[0] != own or own == "hthor"]
    sys.argv = [""]
    if any(name.startswith(_MINDS) for name in (module, *(one[0] for one in wanted))):
        wanted += [(name, []) for name in _behind()]
    for module, names in wanted:
        with contextlib.suppress(BaseException):
            for name in [module, *(f"{module}.{name}" for name in names if module == "hthor")]:
                if name.startswith(_OURS) or (_quiet(name) and _installed(name.partition(".")[0])):
                    found = importlib.import_module(name)
                    for part in names:
                        getattr(found, part, None)  # some packages import their submodules only on access
    gc.collect()
    gc.freeze()


def _behind() -> list[str]:
    """Modules that built-in agents import only when they begin, which would cost time in every trial."""
    files = [path for part in ("agents", "navigation") for path in sorted((paths.PACKAGE / part).rglob("*.py"))]
    return [
        f"hthor.{path.parent.name}.{path.stem}" for path in files if path.parent.name != "agents" or path.stem[0] == "_"
    ]


def _quiet(name: str) -> bool:
    """Whether importing a module has no side effects, judged by its name."""
    return not any(part in _SIDE_EFFECTS or part.startswith("test") for part in name.split("."))


def _installed(name: str) -> bool:
    """Whether a module comes with Python or is in a folder of installed libraries."""
    spec = importlib.util.find_spec(name)
    if spec is None or name == "hthor":
        return False
    places = [Path(sys.prefix), Path(sys.base_prefix), *map(Path, paths.library_folders())]
    return spec.origin in ("built-in", "frozen") or any(Path(spec.origin or "").is_relative_to(at) for at in places)


def _named(path: Path) -> list[tuple[str, list[str]]]:
    """Modules that a file imports by name at its top level, with the names taken from each."""
    try:
        if path.stat().st_size > _MOST_BYTES:  # no limit holds here for the memory and time that parsing takes
            return []
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    found: list[tuple[str, list[str]]] = []
    for node in tree.body:
        if isinstance(node, ast.Import):
            found += [(alias.name, []) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.append((node.module, [alias.name for alias in node.names]))
    return found
