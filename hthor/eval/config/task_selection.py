"""The tasks of a run: those of a suite, or a part of it by task kind, house, difficulty or number."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import code_identity, houses, installation, jsonio, plugins, seeds, tasks
from hthor.errors import HthorError, UnknownName
from hthor.eval.config.run_config import KindRef
from hthor.houses import HouseLibrary
from hthor.tasks.kind import TaskKind
from hthor.tasks.suite import Suite, make_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import validate
from hthor.types import TaskSpec

_ROOT = seeds.derive(2, "programme")
"""Seed of the tasks that are generated for a kind without a suite: the same file always gives the same tasks."""
_SUBSET_ROOT = seeds.derive(3, "selection")
"""Seed of every subset: a suite always gives the same tasks, independent of the run's seed."""
_VERSION = 1


class TaskSelection(Struct, frozen=True, kw_only=True):
    """The tasks of a run.

    Attributes:
        suite: the tasks, under the name of the suite that they are from.
        kind: the task kind that the suite was narrowed to, None for all of them.
        kind_path: the file of a user's own kind.
        generated: whether the tasks were generated for this run.
        robots: the robots that all task kinds are made for; empty when the kinds differ.
        notes: sentences for the user.
        limit: how many tasks were chosen, None for all.
        houses: the houses, and ``difficulty`` the difficulty, that the suite was narrowed to.
    """

    suite: Suite
    kind: KindRef | None = None
    kind_path: str = ""
    generated: bool = False
    robots: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    limit: int | None = None
    houses: tuple[str, ...] = ()
    difficulty: str = ""


def select_tasks(suite: str, kind: str) -> TaskSelection:
    """The tasks of a suite, or those of one task kind.

    Args:
        suite: name or file of a suite; empty for the kind's own, for tasks generated now if it has none, or for "smoke"
            without a kind.
        kind: name or short name of a task kind, or the path of a Python file that defines one; empty for all kinds.

    Raises:
        UnknownName: when there is no such suite or kind.
        HthorError: when the suite has no task of the kind, or a user's kind does not work.
    """
    if kind.endswith(".py"):
        return _from_user_kind(kind, suite)
    if not kind:
        return _whole_suite(checked_suite(suite or "smoke"))
    known = find_kind(kind)
    if not suite and known.short not in tasks.suite_names():
        return _one_in_each_house(known)
    whole = checked_suite(suite or known.short)
    chosen = _only_kind(whole, known.name)
    if len(chosen.tasks) == len(whole.tasks):
        return _whole_suite(whole)
    return TaskSelection(suite=chosen, kind=KindRef(name=known.name), robots=tuple(known.crew))


def checked_suite(name_or_path: str) -> Suite:
    """A suite by name, or from a file whose tasks fit their houses' floor plans and the catalogue.

    A file is checked once: the user's cache remembers it by the hash of its tasks, its houses and hthor's code.

    Raises:
        UnknownName: when no suite has that name.
        TaskError: as in `hthor.tasks.suite`, or names the tasks that cannot be run.
    """
    if name_or_path in tasks.suite_names() or not Path(name_or_path).exists():
        return tasks.load_suite(name_or_path)
    suite = library.read_suite(name_or_path)
    own_houses = {name: hashlib.sha256(data).hexdigest() for name, data in library.house_files(name_or_path).items()}
    content = jsonio.sha256([suite.sha256, own_houses, code_identity.makers_sha256()])
    mark = installation.cache() / "sound" / content
    if not mark.exists():
        validate(suite, name_or_path)
        jsonio.write(mark, b"")
    return suite


def narrow_selection(whole: TaskSelection, names: Sequence[str], difficulty: str) -> TaskSelection:
    """The tasks in these houses and of this difficulty; all tasks where neither is given.

    The difficulty of a task is computed where the suite does not state it.

    Raises:
        UnknownName: when the suite has no task in a house.
        HthorError: when no task is left.
    """
    suite = whole.suite
    suite_houses = tuple(dict.fromkeys(task.house for task in suite.tasks))
    for name in names:
        if name not in suite_houses:
            raise UnknownName(f"house of the suite '{suite.name}'", name, suite_houses)
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
    part = f"{len(chosen)} of the {len(suite.tasks)} tasks of '{suite.name}', those {' and '.join(words)}"
    note = f"{part}, are played: no result for the leaderboard."
    return msgspec.structs.replace(
        whole,
        suite=suite.with_tasks(chosen),
        houses=tuple(name for name in suite_houses if name in names),
        difficulty=difficulty,
        notes=(*whole.notes, note),
    )


def _has_difficulty(task: TaskSpec, houses: HouseLibrary, difficulty: str) -> bool:
    from hthor.tasks.generation import difficulty as difficulties

    if not difficulty:
        return True
    return (task.difficulty or difficulties.level_of(task, houses.load(task.house))) == difficulty


def limit_selection(whole: TaskSelection, limit: int | None) -> TaskSelection:
    """A representative subset of ``limit`` tasks; all for None. Raises HthorError when there are fewer tasks."""
    if limit is None or limit == len(whole.suite.tasks):
        return whole
    if limit > len(whole.suite.tasks):
        raise HthorError(f"--limit {limit}: the suite '{whole.suite.name}' has {len(whole.suite.tasks)} tasks here.")
    suite = whole.suite
    some = suite.with_tasks(choose_subset(suite.tasks, limit))
    note = f"{limit} of the {len(suite.tasks)} tasks of '{suite.name}' are played: no result for the leaderboard."
    return msgspec.structs.replace(whole, suite=some, limit=limit, notes=(*whole.notes, note))


def choose_subset(tasks: Sequence[TaskSpec], count: int) -> tuple[TaskSpec, ...]:
    """A representative subset: ``count`` of the tasks, in the suite's order.

    Every house, and within it every task kind, has about its share. A larger subset contains every smaller one, so
    that more tasks can be added to a result.
    """
    left = [tasks[place] for place in seeds.shuffled(len(tasks), _SUBSET_ROOT, "tasks")]
    houses, kinds = Counter(task.house for task in left), Counter(task.kind for task in left)
    pairs = Counter((task.house, task.kind) for task in left)
    taken: Counter[object] = Counter()

    def share_taken(task: TaskSpec) -> tuple[float, ...]:
        """The shares already taken of the task's house, kind, and both together; the task with the lowest is next."""
        pair = (task.house, task.kind)
        return (
            (taken["house", task.house] + 0.5) / houses[task.house],
            (taken["kind", task.kind] + 0.5) / kinds[task.kind],
            (taken["pair", *pair] + 0.5) / pairs[pair],
        )

    chosen: set[str] = set()
    for _ in range(count):
        task = min(left, key=share_taken)
        left.remove(task)
        chosen.add(task.id)
        taken.update([("house", task.house), ("kind", task.kind), ("pair", task.house, task.kind)])
    return tuple(task for task in tasks if task.id in chosen)


def find_kind(name: str) -> TaskKind:
    """A task kind by its name or its short name; raises UnknownName when no kind has it."""
    names = plugins.names("task kind")
    kinds: dict[str, TaskKind] = {known: plugins.load("task kind", known) for known in names}
    shorts = {kind.short: kind for kind in kinds.values()}
    if name not in kinds and name not in shorts:
        hint = "Or give the path of a Python file that defines a kind, such as my_kind.py."
        raise UnknownName("kind of task", name, (*names, *shorts), hint)
    return kinds.get(name) or shorts[name]


def _whole_suite(suite: Suite) -> TaskSelection:
    robots = {tuple(plugins.load("task kind", name).crew) for name in sorted({task.kind for task in suite.tasks})}
    return TaskSelection(suite=suite, robots=robots.pop() if len(robots) == 1 else ())


def _from_user_kind(path: str, suite: str) -> TaskSelection:
    """The tasks of a user's kind: those of a suite, or one task in each of the houses that ship with hthor."""
    kind = _load_user_kind(path)
    if suite:
        chosen = TaskSelection(suite=_only_kind(checked_suite(suite), kind.name), robots=tuple(kind.crew))
    else:
        chosen = _one_in_each_house(kind, path)
    ref = KindRef(name=kind.name, sha256=plugins.sha256(path))
    return msgspec.structs.replace(chosen, kind=ref, kind_path=str(Path(path).resolve()))


def _only_kind(whole: Suite, kind: str) -> Suite:
    """The suite's tasks of one kind, under the suite's own name."""
    chosen = tuple(task for task in whole.tasks if task.kind == kind)
    if not chosen:
        kinds = ", ".join(sorted({task.kind for task in whole.tasks}))
        raise HthorError(f"the suite '{whole.name}' has no task of the kind '{kind}'; it has: {kinds}.")
    return whole.with_tasks(chosen)


def _one_in_each_house(kind: TaskKind, path: str = "") -> TaskSelection:
    """A task generated in each house that suits the kind, and for every other house a note why it has no task."""
    from hthor.tasks.generation import generate

    generated, missing = [], []
    for name in houses.names():
        try:
            generated.append(generate.make_task(houses.load(name), kind, None, _ROOT, name=f"{kind.short}/{name}"))
        except HthorError as error:
            missing.append(f"there is no task in {name}: {error}")
    if not generated:
        raise HthorError(f"{path or kind.name}: {missing[0]}")
    return TaskSelection(
        suite=make_suite(kind.short, _VERSION, tuple(generated)),
        kind=KindRef(name=kind.name),
        generated=True,
        robots=tuple(kind.crew),
        notes=tuple(missing),
    )


def _load_user_kind(path: str) -> TaskKind:
    kind: Any = plugins.load("task kind", path)
    if not isinstance(kind, TaskKind):
        raise HthorError(f"{path}: KIND must be an instance of a subclass of hthor.tasks.kind.TaskKind, got {kind!r}.")
    if kind.name != Path(path).stem:
        raise HthorError(f"{path}: the kind is called '{kind.name}'; its name must be the file's, '{Path(path).stem}'.")
    return kind
