"""The suite ``standard``: 2000 tasks in the ten scenes and the ten unseen houses.

``python -m hthor.tasks.generation.standard`` writes ``suites/data/standard.json`` again, with the same bytes while
houses, catalogue, rules and task generation are the same. An argument names another file to write.
"""

import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Literal

from hthor import houses, jsonio
from hthor.errors import HthorError
from hthor.tasks.generation import generate
from hthor.tasks.generation.suite_specs import SCENES, SuiteSpec, by_count
from hthor.tasks.kind import target_of
from hthor.tasks.suite import Suite, encode_suite, in_turn, make_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import validate
from hthor.types import HouseSpec, TaskSpec

UNSEEN = ("aspen", "beech", "cherry", "fir", "holly", "larch", "oak", "pine", "spruce", "yew")
"""The ten houses that are not among the scenes."""
ALIKE_M = 1.0
"""Tasks with the same goal and the same place of the target differ if their starts are at least this far apart."""
_LAPS = 50
REDRAWN = {
    "standard/maple/navigation-12": 1,
    "standard/spruce/manipulation-17": 1,
    "standard/spruce/manipulation-26": 1,
    "standard/willow/manipulation-72": 1,
}
"""How many draws of a task are skipped because ``hthor tasks check`` found that they cannot be done."""

SPEC = SuiteSpec(
    name="standard",
    version=2,
    root=20240620,
    houses=(*SCENES, *UNSEEN),
    orders=by_count(("object_goal_navigation", 26), ("mobile_manipulation", 74)),
)
"""100 tasks per house; of these, 26 are searches and 74 deliveries, the ratio of the paper's 565 and 1583."""


IsPossible = Callable[[TaskSpec, HouseSpec], bool]
"""Whether a task can be done in its house."""


def accept_any(_task: TaskSpec, _house: HouseSpec) -> bool:
    """Accept every task, without a check."""
    return True


def build_suite() -> Suite:
    """The suite, validated; made by one process per CPU.

    Raises:
        HthorError: when a house has no room for one of its tasks.
    """
    with ProcessPoolExecutor(len(os.sched_getaffinity(0)), get_context("spawn")) as pool:
        columns = list(pool.map(house_tasks, SPEC.houses))
    suite = make_suite(SPEC.name, SPEC.version, tuple(in_turn(columns)))
    validate(suite, SPEC.name)
    return suite


def house_tasks(name: str) -> tuple[TaskSpec, ...]:
    """The tasks in the house of this name."""
    return tuple(make_tasks(SPEC, houses.load(name), "seen" if name in SCENES else "new"))


def make_tasks(
    spec: SuiteSpec, house: HouseSpec, split: Literal["seen", "new"], possible: IsPossible = accept_any
) -> Iterator[TaskSpec]:
    """One house's tasks of a suite, no two of them alike; tasks that are not ``possible`` are drawn again.

    Raises:
        HthorError: when the house has no room for one of its tasks, or for that many different ones.
    """
    done: list[TaskSpec] = []
    for order in spec.orders(spec, house):
        for lap in range(REDRAWN.get(order.name, 0), _LAPS):
            made = generate.make_ordered_task(spec, house, order, lap, split)
            if not any(are_alike(made, other) for other in done) and possible(made, house):
                done.append(made)
                yield made
                break
        else:
            raise HthorError(f"house '{house.id}' has no room for another task like '{order.name}'; ask for fewer")


def are_alike(one: TaskSpec, two: TaskSpec) -> bool:
    """Whether two tasks ask for the same thing from the same place: their goals are equal, their targets are on the
    same thing of the same house, and the person's starts are less than `ALIKE_M` apart.
    """
    if (one.house, one.goal) != (two.house, two.goal):
        return False
    if target_of(one.goal, one.objects).support != target_of(two.goal, two.objects).support:
        return False
    here, there = one.human_start, two.human_start
    return math.dist((here.x, here.y), (there.x, there.y)) < ALIKE_M


def main(arguments: Sequence[str]) -> int:
    """Write the suite."""
    path = Path(arguments[0]) if arguments else library.suite_path(SPEC.name)
    try:
        jsonio.write(path, encode_suite(build_suite()))
    except HthorError as error:
        sys.stderr.write(f"{error}\n")
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
