"""The values that the shell offers when the user presses the tab key: built-in names, and folders of runs.

Names are read from file names, and nothing heavy is imported, so that the tab key answers at once. Where no name fits,
the shell offers files, as most values may be files too.
"""

from __future__ import annotations

import os
import re
import typing
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import typer

VARIABLE = "_HTHOR_COMPLETE"
"""The environment variable that the shell sets when it asks for completions."""
LEVELS = ["auto", "L1", "L2", "L3"]
DETECTORS = ["ideal", "noisy", "own"]
CAMERAS = ["habitat", "own", "realsense", "square", "thor"]
_PACKAGE = Path(__file__).resolve().parents[1]
_DEPTH = 3
_MANY = 200
_ALIASES = ("tall", "small")


def _stems(folder: str, suffix: str) -> list[str]:
    files = (_PACKAGE / folder).glob(f"*.{suffix}")
    return sorted(path.stem for path in files if not path.stem.startswith("_"))


suites = partial(_stems, "tasks/suites/data", "json")
houses = partial(_stems, "houses/data", "json")
engines = partial(_stems, "eval/runner/engines", "py")


def agents() -> list[str]:
    """Built-in agents."""
    return sorted("none" if name == "silent" else name for name in _stems("agents", "py"))


def people() -> list[str]:
    """Populations, kinds of people, human models, and the words for several."""
    files = (
        *("study" if name == "paper" else name for name in _stems("humans/populations", "json")),
        *_stems("humans/population/kinds", "json"),
        *_stems("humans/models", "py"),
    )
    return sorted({*files, "literature", "kinds", "bracket"})


def kinds() -> list[str]:
    """Kinds of task, by their names and short names."""
    files = [_PACKAGE / "tasks/kinds" / f"{name}.py" for name in _stems("tasks/kinds", "py")]
    shorts = (re.search(r'^    short = "(\w+)"', file.read_text(encoding="utf-8"), re.MULTILINE) for file in files)
    return sorted({*(file.stem for file in files), *(found[1] for found in shorts if found)})


def robots() -> list[str]:
    """Robots' bodies."""
    return sorted({*_stems("world/robots", "py"), *_ALIASES})


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


def _runs(folder: Path, depth: int) -> Iterator[Path]:
    """Folders with a run, also those inside another run's folder, as controls are."""
    try:
        entries = sorted(entry.name for entry in os.scandir(folder) if entry.is_dir() and entry.name[0] != ".")
    except OSError:
        return
    for name in entries[:_MANY]:
        if (folder / name / "run.json").is_file():
            yield folder / name
        if depth > 1:
            yield from _runs(folder / name, depth - 1)


OFFERS: dict[str, list[str] | Callable[..., list[str]]] = {
    "agent": agents,
    **dict.fromkeys(("humans", "prior", "humans name"), people),
    **dict.fromkeys(("suite", "suites"), suites),
    "kind": kinds,
    **dict.fromkeys(("robot", "robots"), robots),
    **dict.fromkeys(("house", "files"), houses),
    **dict.fromkeys(("assets", "assets name"), packs),
    "engine": engines,
    **dict.fromkeys(("isolation", "require_isolation"), LEVELS),
    "detector": DETECTORS,
    "camera": CAMERAS,
    **dict.fromkeys(("run", "runs", "folders"), runs),
}
"""Offers by the parameter's name, preceded by the group's where the same name means something else elsewhere."""


def attach(app: typer.Typer, group: str = "") -> None:
    """Have every command of the app offer values for those parameters that have offers."""
    for command in app.registered_commands:
        if command.callback is None:
            continue
        hints = typing.get_type_hints(command.callback, include_extras=True)
        command.callback.__annotations__ = hints  # strings would be evaluated again, and lose the offers
        for name, hint in hints.items():
            if offer := OFFERS.get(f"{group} {name}") or OFFERS.get(name):
                for info in getattr(hint, "__metadata__", ()):
                    info.autocompletion = _fitting(offer)
    for below in app.registered_groups:
        if below.typer_instance is not None:
            attach(below.typer_instance, str(below.name))


def _fitting(offer: list[str] | Callable[..., list[str]]) -> Callable[[str], Any]:
    def complete(incomplete: str) -> list[str]:
        if offer is runs:
            return runs(incomplete)
        names = offer if isinstance(offer, list) else offer()
        return [name for name in names if name.startswith(incomplete)]

    return complete
