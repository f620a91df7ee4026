"""Values for shell completion: names of what ships, read from file names, and folders of runs.

Imports nothing heavy, so that the tab key answers at once.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_DEPTH = 3
_MANY = 200
_ALIASES = ("tall", "small")


def agents() -> list[str]:
    """Built-in minds."""
    return sorted("none" if name == "silent" else name for name in _stems("agents", "py"))


def people() -> list[str]:
    """Populations, kinds of people, human models, and the words for several."""
    files = (
        *("study" if name == "paper" else name for name in _stems("humans/populations", "json")),
        *_stems("humans/population/kinds", "json"),
        *_stems("humans/models", "py"),
    )
    return sorted({*files, "literature", "kinds", "bracket"})


def suites() -> list[str]:
    """The suites that ship."""
    return _stems("tasks/suites/data", "json")


def kinds() -> list[str]:
    """Kinds of task, by their names and short names."""
    files = [_PACKAGE / "tasks/kinds" / f"{name}.py" for name in _stems("tasks/kinds", "py")]
    shorts = (re.search(r'^    short = "(\w+)"', file.read_text(encoding="utf-8"), re.MULTILINE) for file in files)
    return sorted({*(file.stem for file in files), *(found[1] for found in shorts if found)})


def robots() -> list[str]:
    """Robots' bodies."""
    return sorted({*_stems("world/robots", "py"), *_ALIASES})


def houses() -> list[str]:
    """The houses that ship."""
    return _stems("houses/data", "json")


def engines() -> list[str]:
    """Where trials can be played."""
    return _stems("eval/runner/engines", "py")


def levels() -> list[str]:
    """Levels of isolation."""
    return ["auto", "L1", "L2", "L3"]


def detectors() -> list[str]:
    """Robots' detectors."""
    return ["ideal", "noisy", "own"]


def cameras() -> list[str]:
    """Robots' cameras."""
    return ["habitat", "own", "realsense", "square", "thor"]


def packs() -> list[str]:
    """Furniture packs in the user's cache."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return sorted(path.parent.name for path in cache.glob("hthor/packs/*/pack.json"))


def runs(incomplete: str = "") -> list[str]:
    """Folders of runs, in and below the folder that is being typed, or below the usual one."""
    typed = Path(os.path.dirname(incomplete)) if incomplete else Path()
    roots = [typed] if incomplete else [Path(), Path("runs")]
    found = {str(folder) for root in roots for folder in _runs(root, _DEPTH if root.name else 1)}
    return sorted(found)[:_MANY]


def _stems(folder: str, suffix: str) -> list[str]:
    files = (_PACKAGE / folder).glob(f"*.{suffix}")
    return sorted(path.stem for path in files if not path.stem.startswith("_"))


def _runs(folder: Path, depth: int) -> Iterator[Path]:
    """Folders with a run, and in those, too: a control lies in its run's folder."""
    try:
        entries = sorted(entry.name for entry in os.scandir(folder) if entry.is_dir() and entry.name[0] != ".")
    except OSError:
        return
    for name in entries[:_MANY]:
        if (folder / name / "run.json").is_file():
            yield folder / name
        if depth > 1:
            yield from _runs(folder / name, depth - 1)
