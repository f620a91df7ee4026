"""What is played: the tasks that a suite and a kind stand for together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import houses, plugins, seeds, tasks
from hthor.errors import HthorError, UnknownName
from hthor.eval.config import suite_check, task_subset
from hthor.eval.config.run_config import KindRef
from hthor.houses import HouseLibrary
from hthor.tasks.kind import TaskKind
from hthor.tasks.suite import Suite, make_suite
from hthor.types import TaskSpec

_ROOT = seeds.derive(2, "programme")
"""Of all draws of tasks for a user's own kind: the same file always gives the same tasks."""
_VERSION = 1


class TaskSelection(Struct, frozen=True, kw_only=True):
    """The tasks of a run.

    ``kind`` is what the suite was narrowed to, None for all of it; ``path`` the file of a user's own kind, and
    ``drawn`` whether the tasks were made for this run; ``crew`` the robots' bodies that all the tasks' kinds agree on,
    empty when they do not. ``houses`` and ``difficulty`` are what else the suite was narrowed to. ``limit`` is how many
    of the tasks were chosen, None where all of them are there.
    """

    suite: Suite
    kind: KindRef | None = None
    path: str = ""
    drawn: bool = False
    crew: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    limit: int | None = None
    houses: tuple[str, ...] = ()
    difficulty: str = ""


def select_tasks(suite: str, kind: str) -> TaskSelection:
    """The tasks that are meant.

    Args:
        suite: name or file of a suite, empty for the kind's own, or "smoke" without a kind.
        kind: name or short name of a kind of task, or the path of a Python file that defines one; empty for all kinds.

    Raises:
        UnknownName: when there is no such suite or kind.
        HthorError: when the two do not fit together, or a user's kind does not work.
    """
    if kind.endswith(".py"):
        return _from_user_kind(kind, suite)
    if not kind:
        return _whole_suite(suite_check.checked_suite(suite or "smoke"))
    known = find_kind(kind)
    if not suite and known.short not in tasks.suite_names():
        raise HthorError(f"there is no suite of tasks of the kind '{known.name}'; name one that has some with --suite.")
    whole = suite_check.checked_suite(suite or known.short)
    chosen = _only_kind(whole, known.name)
    if len(chosen.tasks) == len(whole.tasks):
        return _whole_suite(whole)
    return TaskSelection(suite=chosen, kind=KindRef(name=known.name), crew=tuple(known.crew))


def narrow_selection(whole: TaskSelection, names: Sequence[str], difficulty: str) -> TaskSelection:
    """The programme with only its tasks in these houses and of this difficulty; all of them where neither is given.

    What a suite does not tell of the difficulty of its tasks is worked out.

    Raises:
        UnknownName: when the suite has no task in a house.
        HthorError: when no task is left.
    """
    suite, there = whole.suite, tuple(dict.fromkeys(task.house for task in whole.suite.tasks))
    for name in names:
        if name not in there:
            raise UnknownName(f"house of the suite '{suite.name}'", name, there)
    chosen = tuple(
        task
        for task in suite.tasks
        if (not names or task.house in names) and _has_difficulty(task, suite.houses, difficulty)
    )
    if not chosen:
        where = f" in {', '.join(names)}" if names else ""
        raise HthorError(
            f"the suite '{suite.name}' has no {difficulty} task{where}; see 'hthor tasks list {suite.name}'."
        )
    if len(chosen) == len(suite.tasks):
        return whole
    words = [f"in {', '.join(dict.fromkeys(names))}"] if names else []
    words += [f"of difficulty {difficulty}"] if difficulty else []
    few = f"{len(chosen)} of the {len(suite.tasks)} tasks of '{suite.name}', those {' and '.join(words)}"
    note = f"{few}, are played: no result for the leaderboard."
    return msgspec.structs.replace(
        whole,
        suite=suite.with_tasks(chosen),
        houses=tuple(name for name in there if name in names),
        difficulty=difficulty,
        notes=(*whole.notes, note),
    )


def _has_difficulty(task: TaskSpec, houses: HouseLibrary, difficulty: str) -> bool:
    from hthor.tasks.generation import difficulty as difficulties

    if not difficulty:
        return True
    return (task.difficulty or difficulties.level_of(task, houses.load(task.house))) == difficulty


def limit_selection(whole: TaskSelection, limit: int | None) -> TaskSelection:
    """The programme with only so many of its tasks, chosen by `hthor.eval.config.task_subset`; all of them for None.

    Raises:
        HthorError: when there are not so many.
    """
    if limit is None or limit == len(whole.suite.tasks):
        return whole
    if limit > len(whole.suite.tasks):
        raise HthorError(f"--limit {limit}: the suite '{whole.suite.name}' has {len(whole.suite.tasks)} tasks here.")
    suite = whole.suite
    some = suite.with_tasks(task_subset.choose_subset(suite.tasks, limit))
    note = f"{limit} of the {len(suite.tasks)} tasks of '{suite.name}' are played: no result for the leaderboard."
    return msgspec.structs.replace(whole, suite=some, limit=limit, notes=(*whole.notes, note))


def find_kind(name: str) -> TaskKind:
    """A kind of task by its name or its short name.

    Raises:
        UnknownName: when none is called so.
    """
    names = plugins.names("task kind")
    kinds: dict[str, TaskKind] = {known: plugins.load("task kind", known) for known in names}
    shorts = {kind.short: kind for kind in kinds.values()}
    if name not in kinds and name not in shorts:
        hint = "Or give the path of a Python file that defines a kind, such as my_kind.py."
        raise UnknownName("kind of task", name, (*names, *shorts), hint)
    return kinds.get(name) or shorts[name]


def _whole_suite(suite: Suite) -> TaskSelection:
    crews = {tuple(plugins.load("task kind", name).crew) for name in sorted({task.kind for task in suite.tasks})}
    return TaskSelection(suite=suite, crew=crews.pop() if len(crews) == 1 else ())


def _from_user_kind(path: str, suite: str) -> TaskSelection:
    """The tasks of a user's kind: those of a suite, or one in each of the houses that come with hthor."""
    kind = _load_user_kind(path)
    found, missing = (
        (_only_kind(suite_check.checked_suite(suite), kind.name), ()) if suite else _generated_tasks(kind, path)
    )
    return TaskSelection(
        suite=found,
        kind=KindRef(name=kind.name, sha256=plugins.sha256(path)),
        path=str(Path(path).resolve()),
        drawn=not suite,
        crew=tuple(kind.crew),
        notes=missing,
    )


def _only_kind(whole: Suite, kind: str) -> Suite:
    """The suite's tasks of one kind, under the suite's own name."""
    chosen = tuple(task for task in whole.tasks if task.kind == kind)
    if not chosen:
        there = ", ".join(sorted({task.kind for task in whole.tasks}))
        raise HthorError(f"the suite '{whole.name}' has no task of the kind '{kind}'; it has: {there}.")
    return whole.with_tasks(chosen)


def _generated_tasks(kind: TaskKind, path: str) -> tuple[Suite, tuple[str, ...]]:
    """A task in each house that has what it takes, and why the others have none."""
    from hthor.tasks.generation import generate

    made, missing = [], []
    for name in houses.names():
        try:
            made.append(generate.make_task(houses.load(name), kind, None, _ROOT, name=f"{kind.short}/{name}"))
        except HthorError as error:
            missing.append(f"there is no task in {name}: {error}")
    if not made:
        raise HthorError(f"{path}: {missing[0]}")
    return make_suite(kind.short, _VERSION, tuple(made)), tuple(missing)


def _load_user_kind(path: str) -> TaskKind:
    kind: Any = plugins.load("task kind", path)
    if not isinstance(kind, TaskKind):
        raise HthorError(f"{path}: KIND must be an instance of a subclass of hthor.tasks.kind.TaskKind, got {kind!r}.")
    if kind.name != Path(path).stem:
        raise HthorError(f"{path}: the kind is called '{kind.name}'; its name must be the file's, '{Path(path).stem}'.")
    return kind
