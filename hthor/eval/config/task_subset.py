"""A representative subset of a suite: always the same tasks, spread over its houses and task kinds."""

from collections import Counter
from collections.abc import Sequence

from hthor import seeds
from hthor.types import TaskSpec

_ROOT = seeds.derive(3, "selection")
"""Seed of every choice: a suite always gives the same tasks, independent of the run's seed."""


def choose_subset(tasks: Sequence[TaskSpec], count: int) -> tuple[TaskSpec, ...]:
    """``count`` of the tasks, in the suite's order.

    Every house, and within it every task kind, has about its share. A larger subset contains every smaller one, so
    that more tasks can be added to a result.
    """
    left = [tasks[place] for place in seeds.shuffled(len(tasks), _ROOT, "tasks")]
    houses, kinds = Counter(task.house for task in left), Counter(task.kind for task in left)
    pairs = Counter((task.house, task.kind) for task in left)
    taken: Counter[object] = Counter()

    def share_taken(task: TaskSpec) -> tuple[float, ...]:
        """The share of the task's house, kind and pair of both that is taken; the task with the least is next."""
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
