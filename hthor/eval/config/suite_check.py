"""Suites that are fit to be played: a user's own is looked through before a run, once for each version of it."""

from __future__ import annotations

import hashlib
from pathlib import Path

from hthor import code_identity, installation, jsonio, tasks
from hthor.tasks.suite import Suite
from hthor.tasks.suites import library
from hthor.tasks.validate import validate


def checked_suite(name_or_path: str) -> Suite:
    """A suite by name, or from a file; no task of it is found wrong by its house's floor plan and the catalogue.

    That a file is sound is remembered in the user's cache by the hash of its tasks, of its houses and of hthor's code.

    Raises:
        UnknownName: when no suite has that name.
        TaskError: as `hthor.tasks.suite`, naming the tasks that cannot be run.
    """
    if name_or_path in tasks.suite_names() or not Path(name_or_path).exists():
        return tasks.load_suite(name_or_path)
    found = library.read_suite(name_or_path)
    mark = _mark(found, name_or_path)
    if not mark.exists():
        validate(found, name_or_path)
        jsonio.write(mark, b"")
    return found


def _mark(found: Suite, path: str) -> Path:
    """The file that is there when the suite was found sound."""
    own = {name: hashlib.sha256(data).hexdigest() for name, data in library.house_files(path).items()}
    return installation.cache() / "sound" / jsonio.sha256([found.sha256, own, code_identity.makers_sha256()])
