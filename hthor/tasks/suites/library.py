"""Suites by name or from a file: read, verified by their hash and, for a user's own, validated."""

import difflib
from pathlib import Path

from hthor import documents, jsonio
from hthor.errors import TaskError, UnknownName
from hthor.houses.library import OURS, HouseLibrary
from hthor.tasks.suite import Suite, SuiteFile
from hthor.types import TaskSpec

_FOLDER = Path(__file__).parent / "data"
_SHOWN = 8


def suite_names() -> tuple[str, ...]:
    """Names of the suites that come with hthor."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.json")))


def load_suite(name_or_path: str | Path) -> Suite:
    """A suite by name, or from a file, verified and validated.

    The suites that come with hthor were validated when they were made; their hash shows that nothing has changed since.
    A file's tasks are validated now. The path of a folder stands for the ``suite.json`` in it.

    Raises:
        UnknownName: when no suite has that name.
        TaskError: when the file cannot be read, was changed after it was made, or contains a task that cannot be run.
    """
    loaded = read_suite(name_or_path)
    path, shown = _locate(name_or_path)
    if path.parent != _FOLDER:
        from hthor.tasks.validate import validate

        validate(loaded, shown)
    return loaded


def read_suite(name_or_path: str | Path) -> Suite:
    """A suite by name, or from a file, verified by its hash but not validated.

    Raises:
        UnknownName: when no suite has that name.
        TaskError: when the file cannot be read, or was changed after it was made.
    """
    path, shown = _locate(name_or_path)
    file = documents.read(path, SuiteFile, TaskError, shown=shown)
    digest = jsonio.sha256(file.tasks)
    if digest != file.sha256:
        problem = f"the tasks hash to {digest}, the file says {file.sha256}, so it was changed after it was made"
        raise TaskError(
            shown, "sha256", f"{problem}; restore it, or rebuild it with python -m hthor.tasks.generation.generate"
        )
    folder = houses_folder(path)
    houses = HouseLibrary(folder=folder.resolve()) if folder.is_dir() else OURS
    return Suite(name=file.name, version=file.version, sha256=file.sha256, tasks=file.tasks, houses=houses)


def find_task(id: str, name_or_path: str | Path | None = None) -> tuple[Suite, TaskSpec]:
    """The suite and the task with this id, in the given suite or in any suite that comes with hthor.

    Raises:
        UnknownName: when there is no such task; names similar ids.
    """
    names = suite_names() if name_or_path is None else (name_or_path,)
    ids: list[str] = []
    for name in sorted(names, key=lambda name: str(name) != id.partition("/")[0]):
        loaded = read_suite(name)
        for task in loaded.tasks:
            if task.id == id:
                return loaded, task
        ids += [task.id for task in loaded.tasks]
    alike = difflib.get_close_matches(id, ids, n=_SHOWN, cutoff=0.6)
    raise UnknownName("task", id, alike or ids, "'hthor tasks list SUITE' lists them all.")


def house_files(name_or_path: str | Path) -> dict[str, bytes]:
    """The house files that belong to a suite, by name such as ``h1c0ffee.json``; empty for a suite of hthor's own.

    An excerpt of an asset database next to them is included.
    """
    path, _ = _locate(name_or_path)
    return {file.name: file.read_bytes() for file in sorted(houses_folder(path).glob("*.json"))}


def houses_folder(path: Path) -> Path:
    """The folder of the houses of this suite file: ``mine.houses`` for ``mine.json``, else ``houses`` next to it."""
    own = path.with_suffix(".houses")
    return own if own.is_dir() else path.with_name("houses")


def suite_path(name: str) -> Path:
    """The path of the suite of that name, whether it exists or not."""
    return _FOLDER / f"{name}.json"


def _locate(name_or_path: str | Path) -> tuple[Path, str]:
    if isinstance(name_or_path, str) and name_or_path in suite_names():
        return suite_path(name_or_path), name_or_path
    path = Path(name_or_path)
    if path.is_dir():
        path = path / "suite.json"
    if path.suffix != ".json" and not path.exists():
        raise UnknownName(
            "suite", str(name_or_path), suite_names(), "A path to a suite's file (.json) or folder works too."
        )
    return path, str(name_or_path)
