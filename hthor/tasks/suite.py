"""A suite: a named, versioned and hashed list of tasks, with the houses that they take place in."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

from msgspec import Struct

from hthor import jsonio
from hthor.houses.library import OURS, HouseLibrary
from hthor.types import TaskSpec


class SuiteFile(Struct, frozen=True, kw_only=True):
    """The content of a suite's file; ``sha256`` is the hash of the tasks' canonical JSON, 64 hexadecimal digits."""

    name: str
    version: int
    sha256: str
    tasks: tuple[TaskSpec, ...]


class Suite(SuiteFile, frozen=True, kw_only=True):
    """A named list of tasks. ``houses`` finds their houses by name; it has a folder if the suite has its own houses."""

    houses: HouseLibrary = OURS

    def with_tasks(self, tasks: tuple[TaskSpec, ...]) -> Suite:
        """The suite with only these of its tasks, and their hash."""
        return make_suite(self.name, self.version, tasks, self.houses)


def make_suite(name: str, version: int, tasks: tuple[TaskSpec, ...], houses: HouseLibrary = OURS) -> Suite:
    """A suite with the hash of its tasks."""
    return Suite(name=name, version=version, sha256=jsonio.sha256(tasks), tasks=tasks, houses=houses)


def encode_suite(suite: Suite) -> bytes:
    """The suite's file: one task per line, so that a change of one task is a change of one line."""
    head = jsonio.canonical({"name": suite.name, "sha256": suite.sha256, "version": suite.version})
    lines = b",\n".join(jsonio.canonical(task) for task in suite.tasks)
    return head[:-1] + b',"tasks":[\n' + lines + b"\n]}\n"


def in_turn(columns: Sequence[Sequence[TaskSpec]]) -> Iterable[TaskSpec]:
    """The tasks of several houses in turns, one per house, so that successive tasks are in different houses."""
    rows = itertools.zip_longest(*columns)
    return (task for row in rows for task in row if task is not None)
