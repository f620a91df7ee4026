"""Custom suites: tasks of some kinds, generated in a given house. Equal recipes and houses give equal tasks."""

import functools
from typing import Literal

import msgspec
from msgspec import Struct

from hthor import plugins, seeds
from hthor.errors import HthorError
from hthor.tasks.generation import generate, standard
from hthor.tasks.generation.difficulty import Level
from hthor.tasks.generation.standard import IsPossible, accept_any
from hthor.tasks.generation.suite_specs import FIND, MOVE, SuiteSpec, TaskOrder, by_count
from hthor.types import Goal, HouseSpec, TaskSpec

VERSION = 1
"""Increased when the same recipe gives a different suite."""
SEARCHES = 0.26
"""The share of searches if no kind is given, as in the suite ``standard``."""
_ROOT = 4
_LAPS = 10
"""How often a task is drawn before its goal is abandoned in its house."""


class Recipe(Struct, frozen=True, kw_only=True):
    """A custom suite to be made: its name, how many ``tasks`` in each house, the names of their ``kinds`` (if empty,
    searches and deliveries as in ``standard``), their difficulty (empty for any), and the seed of all random draws.
    """

    name: str
    tasks: int
    kinds: tuple[str, ...] = ()
    difficulty: Level | Literal[""] = ""
    seed: int = 0


def make_tasks(recipe: Recipe, house: HouseSpec, possible: IsPossible = accept_any) -> tuple[TaskSpec, ...]:
    """The tasks of one house, no two of them alike; tasks that are not ``possible`` are drawn again.

    Raises:
        HthorError: when the house has no room for that many tasks, or the seed is negative.
    """
    root = seeds.derive(_ROOT, seeds.check_seed(recipe.seed))
    orders = functools.partial(_orders, recipe)
    spec = SuiteSpec(name=recipe.name, version=VERSION, root=root, houses=(), orders=orders)
    made = _House(spec, house, possible)
    for order in spec.orders(spec, house):
        made.add(order)
    return tuple(made.done)


def _orders(recipe: Recipe, spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
    """The tasks to be made in a house."""
    rows: list[TaskOrder] = []
    for kind, count in _counts(recipe):
        if not count:
            continue
        if kind in (FIND, MOVE):
            rows += by_count((kind, count))(spec, house)
            continue
        short = plugins.load("task kind", kind).short
        names = [f"{spec.name}/{house.id}/{short}-{number + 1:02d}" for number in range(count)]
        rows += [TaskOrder(name=name, kind=kind, share=seeds.draw(spec.root, name, "share")) for name in names]
    return [msgspec.structs.replace(row, level=recipe.difficulty) for row in rows]


def _counts(recipe: Recipe) -> list[tuple[str, int]]:
    """How many tasks of each kind a house has."""
    if not recipe.kinds:
        searches = round(SEARCHES * recipe.tasks)
        return [(FIND, searches), (MOVE, recipe.tasks - searches)]
    whole, rest = divmod(recipe.tasks, len(recipe.kinds))
    return [(kind, whole + (number < rest)) for number, kind in enumerate(recipe.kinds)]


class _House:
    """One house's tasks, made one after the other."""

    def __init__(self, spec: SuiteSpec, house: HouseSpec, possible: IsPossible) -> None:
        self._spec, self._house, self._possible = spec, house, possible
        self._hopeless: set[Goal] = set()
        self.done: list[TaskSpec] = []

    def add(self, order: TaskOrder) -> None:
        """Make one more task, with another goal if the ordered goal cannot be met in this house.

        Raises:
            HthorError: when no goal gives a task.
        """
        reason = "no goal of its kind can be met here"
        for goal in self._goals(order):
            for lap in range(_LAPS):
                try:
                    wanted = msgspec.structs.replace(order, goal=goal)
                    made = generate.make_ordered_task(self._spec, self._house, wanted, lap)
                except HthorError as error:
                    reason = str(error)
                    continue
                if any(standard.are_alike(made, other) for other in self.done):
                    reason = "what was drawn is like an earlier task"
                elif not self._possible(made, self._house):
                    reason = "what was drawn cannot be done"
                else:
                    self.done.append(made)
                    return
            if goal is not None:
                self._hopeless.add(goal)
        named = f"house '{self._house.id}' has no room for another task like '{order.name}'"
        raise HthorError(f"{named}: {reason}. Ask for fewer or for others.")

    def _goals(self, order: TaskOrder) -> list[Goal | None]:
        """The ordered goal, then the others of its kind, without goals that were abandoned before."""
        if order.goal is None:
            return [None]
        known = plugins.load("task kind", order.kind).goals(self._house)
        others = [known[number] for number in seeds.shuffled(len(known), self._spec.root, order.name, "others")]
        return [goal for goal in dict.fromkeys((order.goal, *others)) if goal not in self._hopeless]
