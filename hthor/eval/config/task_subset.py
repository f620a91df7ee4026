"""Some tasks of a suite that stand for the whole: always the same ones, spread over its houses and kinds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from hthor import seeds
from hthor.types import TaskSpec

_ROOT = seeds.derive(3, "selection")
"""Of all choices: the same suite always gives the same tasks, whatever the run's seed."""


def choose_subset(tasks: Sequence[TaskSpec], count: int) -> tuple[TaskSpec, ...]:
    """So many tasks, in the suite's order.

    Every house, and in it every kind of task, has about its share. A larger choice contains every
    smaller one, so that more tasks can be added to a result.
    """
    left = [tasks[place] for place in seeds.shuffled(len(tasks), _ROOT, "tasks")]
    houses, kinds = Counter(task.house for task in left), Counter(task.kind for task in left)
    pairs = Counter((task.house, task.kind) for task in left)
    taken: Counter[object] = Counter()

    def due(task: TaskSpec) -> tuple[float, ...]:
        """How well served the task's house and kind are already; the least is next."""
        pair = (task.house, task.kind)
        return (
            (taken["house", task.house] + 0.5) / houses[task.house],
            (taken["kind", task.kind] + 0.5) / kinds[task.kind],
            (taken["pair", *pair] + 0.5) / pairs[pair],
        )

    chosen: set[str] = set()
    for _ in range(count):
        task = min(left, key=due)
        left.remove(task)
        chosen.add(task.id)
        taken.update([("house", task.house), ("kind", task.kind), ("pair", task.house, task.kind)])
    return tuple(task for task in tasks if task.id in chosen)
