"""Draws the tasks of a user's own suite and checks that they can be solved, in worker processes."""

import functools
from collections.abc import Iterator, Sequence

from hthor import houses
from hthor.eval.task_check import solvability
from hthor.tasks.generation import custom_suite
from hthor.tasks.generation.custom_suite import Recipe
from hthor.tasks.suites.suite_files import HouseSource
from hthor.types import TaskSpec

CODE_ROOT = "makers"


def make_tasks(
    recipe: Recipe, given: Sequence[HouseSource], *, jobs: int
) -> Iterator[tuple[int, tuple[TaskSpec, ...]]]:
    """The tasks of each house with the house's number, as they are ready. Closing the iterator ends the workers.

    Raises:
        HthorError: when a house has no room for so many tasks that can be done.
    """
    yield from solvability.run_in_workers(functools.partial(_column, recipe), given, jobs=jobs)


def _column(recipe: Recipe, source: HouseSource) -> tuple[TaskSpec, ...]:
    return custom_suite.make_tasks(recipe, houses.load(source.given), solvability.is_solvable)
