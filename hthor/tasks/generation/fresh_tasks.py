"""New tasks like those of a suite, from the same specification but another root, so that nobody can know them."""

from collections.abc import Callable, Iterator, Sequence

import msgspec

from hthor import houses, seeds
from hthor.errors import HthorError, UnknownName
from hthor.tasks.generation import generate, standard
from hthor.tasks.generation.suite_specs import SUITE_SPECS, SuiteSpec
from hthor.tasks.suite import Suite, make_suite
from hthor.types import TaskSpec

_VERSION = 1
_LAPS = 50
ArePossible = Callable[[Sequence[TaskSpec]], Sequence[bool]]
"""Whether each of these tasks can be done."""


def make_fresh_suite(name: str, root: int, count: int, possible: ArePossible) -> Suite:
    """A suite of ``count`` new tasks by the recipe of one of hthor's own suites, with which it shares no draw.

    Houses, kinds of task, goals and difficulty follow the specification; arrangements and starts are new. A task that
    cannot be done is drawn again.

    Args:
        name: a suite of hthor's own. root: root of all draws.

    Raises:
        UnknownName: when no recipe has that name.
        HthorError: when the recipe does not give that many tasks.
    """
    spec = _spec(name)
    again = msgspec.structs.replace(spec, root=seeds.derive(spec.root, "fresh", root), redrawn=())
    made: dict[int, TaskSpec] = {}
    for lap in range(_LAPS):
        open_ = [number for number in range(count) if number not in made]
        drafts = list(_drafts(again, open_, lap))
        sound = possible([task for _, task in drafts])
        made |= {number: task for (number, task), good in zip(drafts, sound, strict=True) if good}
        if len(made) == count:
            tasks = tuple(made[number] for number in sorted(made))
            return make_suite(f"{name}-fresh", _VERSION, tasks)
    missing = f"{count - len(made)} of {count} fresh tasks like those of '{name}'"
    raise HthorError(f"{missing} could not be drawn; ask for fewer")


def _spec(name: str) -> SuiteSpec:
    plans = {**SUITE_SPECS, standard.SPEC.name: standard.SPEC}
    if name not in plans:
        raise UnknownName("recipe of tasks", name, tuple(sorted(plans)))
    return plans[name]


def _drafts(spec: SuiteSpec, numbers: Sequence[int], lap: int) -> Iterator[tuple[int, TaskSpec]]:
    """A task for each of these numbers, spread over all houses and orders; left out if its house has no room."""
    shelves = [(house, order) for house in spec.houses for order in spec.orders(spec, houses.load(house))]
    order_of = seeds.shuffled(len(shelves), spec.root, "orders")
    for number in numbers:
        house, order = shelves[order_of[number % len(shelves)]]
        own = msgspec.structs.replace(spec, root=seeds.derive(spec.root, "task", number, lap))
        try:
            task = generate.make_ordered_task(own, houses.load(house), order)
        except HthorError:
            continue
        yield number, msgspec.structs.replace(task, id=f"fresh/{number:04d}")
