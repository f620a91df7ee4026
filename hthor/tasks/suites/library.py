"""Suites of tasks: frozen files, read and judged."""

from __future__ import annotations

import difflib
from pathlib import Path

from msgspec import Struct

from hthor import documents, houses, jsonio
from hthor.errors import TaskError, UnknownName
from hthor.types import TaskSpec

_FOLDER = Path(__file__).parent / "data"
_SHOWN = 8


class Suite(Struct, frozen=True, kw_only=True):
    """A named list of tasks. ``sha256`` is the hash of the tasks' canonical JSON."""

    name: str
    version: int
    sha256: str
    tasks: tuple[TaskSpec, ...]


def suites() -> tuple[str, ...]:
    """Names of the suites that come with hthor."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.json")))


def suite(name_or_path: str | Path) -> Suite:
    """A suite by name, or from a file, verified and validated.

    A suite of ours was validated when it was made, and its hash tells that nothing has changed since; one of the user's
    is validated now. Houses that lie beside the file, in `houses_of` it, are those of the suite: from now on
    `hthor.houses.load` finds them by name. The path of a folder stands for the ``suite.json`` in it.

    Raises:
        UnknownName: when no suite has that name.
        TaskError: when the file cannot be read, was changed after it was frozen, or holds a task that cannot be run.
    """
    found = read(name_or_path)
    path, shown = _locate(name_or_path)
    if path.parent != _FOLDER:
        from hthor.tasks.validate import validate

        validate(found, shown)
    return found


def read(name_or_path: str | Path) -> Suite:
    """A suite by name, or from a file, verified but not validated: every task of it is as it was frozen.

    Raises:
        UnknownName: when no suite has that name.
        TaskError: when the file cannot be read, or was changed after it was frozen.
    """
    path, shown = _locate(name_or_path)
    if (own := houses_of(path)).is_dir():
        houses.shelve(own)
    found = _decode(path, shown)
    digest = digest_of(found.tasks)
    if digest != found.sha256:
        problem = f"the tasks hash to {digest}, the file says {found.sha256}, so it was changed after it was frozen"
        raise TaskError(
            shown, "sha256", f"{problem}; restore it, or rebuild it with python -m hthor.tasks.generation.generate"
        )
    return found


def find(id: str, name_or_path: str | Path | None = None) -> tuple[Suite, TaskSpec]:
    """The task of that id, of one suite or of any of ours, and the suite it is in.

    Raises:
        UnknownName: when there is none; names the nearest.
    """
    shelf = suites() if name_or_path is None else (name_or_path,)
    ids: list[str] = []
    for name in sorted(shelf, key=lambda name: str(name) != id.partition("/")[0]):
        found = read(name)
        for task in found.tasks:
            if task.id == id:
                return found, task
        ids += [task.id for task in found.tasks]
    alike = difflib.get_close_matches(id, ids, n=_SHOWN, cutoff=0.6)
    raise UnknownName("task", id, alike or ids, "'hthor tasks list SUITE' lists them all.")


def own_houses(name_or_path: str | Path) -> dict[str, bytes]:
    """The house files that a suite brings with it, by name such as ``h1c0ffee.json``; empty for a suite of ours.

    The excerpt of an asset database that may lie beside them comes with them.
    """
    path, _ = _locate(name_or_path)
    return {file.name: file.read_bytes() for file in sorted(houses_of(path).glob("*.json"))}


def houses_of(path: Path) -> Path:
    """Where the houses of the suite in this file lie: ``mine.houses`` for ``mine.json``, else ``houses`` beside it."""
    own = path.with_suffix(".houses")
    return own if own.is_dir() else path.with_name("houses")


def frozen(name: str, version: int, tasks: tuple[TaskSpec, ...]) -> Suite:
    """A suite with the hash of its tasks."""
    return Suite(name=name, version=version, sha256=digest_of(tasks), tasks=tasks)


def digest_of(tasks: tuple[TaskSpec, ...]) -> str:
    """Hash of the tasks' canonical JSON, 64 hexadecimal digits."""
    return jsonio.sha256(tasks)


def encode(found: Suite) -> bytes:
    """The suite's file: one task a line, so that a change of one task is a change of one line."""
    head = jsonio.canonical({"name": found.name, "sha256": found.sha256, "version": found.version})
    lines = b",\n".join(jsonio.canonical(task) for task in found.tasks)
    return head[:-1] + b',"tasks":[\n' + lines + b"\n]}\n"


def path_of(name: str) -> Path:
    """Where the suite of that name lies, or would lie."""
    return _FOLDER / f"{name}.json"


def _locate(name_or_path: str | Path) -> tuple[Path, str]:
    if isinstance(name_or_path, str) and name_or_path in suites():
        return path_of(name_or_path), name_or_path
    path = Path(name_or_path)
    if path.is_dir():
        path = path / "suite.json"
    if path.suffix != ".json" and not path.exists():
        raise UnknownName("suite", str(name_or_path), suites(), "A path to a suite's file (.json) or folder works too.")
    return path, str(name_or_path)


def _decode(path: Path, shown: str) -> Suite:
    return documents.read(path, Suite, TaskError, shown=shown)
