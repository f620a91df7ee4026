"""Specifications of suites: how many tasks of which kinds in which houses.

A suite specification lists task orders for each house; an order determines a task except for the random draws.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

from msgspec import Struct

from hthor import catalog, plugins, seeds
from hthor.catalog.priors import Triplet
from hthor.errors import HthorError
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.generation.difficulty import Level
from hthor.tasks.kind import TaskKind
from hthor.types import WALKERS, Goal, HouseSpec

SCENES = ("alder", "birch", "cedar", "elder", "hazel", "juniper", "linden", "maple", "rowan", "willow")
"""The ten scenes of the benchmark."""
FIND, MOVE = "object_goal_navigation", "mobile_manipulation"
WALK = "visual_language_navigation"
ROBOTS = 4
"""Number of robots' start poses in every task; the first is for the first robot."""


class TaskOrder(Struct, frozen=True, kw_only=True):
    """One task to be made. ``share`` [0, 1] says how hard it will be, from easy starts (0) to hard ones (1).

    ``goal`` is None if the kind draws it. ``fixed`` is a triplet that must hold for the target; ``level`` is the
    required stratum of difficulty, empty for any.
    """

    name: str
    kind: str
    share: float
    goal: Goal | None = None
    fixed: Triplet | None = None
    level: Level | Literal[""] = ""


class SuiteSpec(Struct, frozen=True, kw_only=True):
    """A suite to be made in ``houses``, every draw from ``root``.

    ``orders`` lists a house's tasks. ``robots`` is the number of robots' start poses in a task, ``candidates`` how many
    arrangements are compared by difficulty. ``serial`` is explained in
    `hthor.tasks.arrangement.target_arrangement.arrange`. ``record_difficulty`` says whether tasks record their
    difficulty. ``redrawn`` says how often a task was drawn again because ``hthor tasks check`` found that it cannot be
    done in the simulated world: small things hide the target, or the way takes too long. ``phases`` says whether tasks
    begin with the phases of their kind.
    """

    name: str
    version: int
    root: int
    houses: tuple[str, ...]
    orders: Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]
    robots: int = ROBOTS
    candidates: int = 2
    serial: bool = False
    record_difficulty: bool = True
    redrawn: tuple[tuple[str, int], ...] = ()
    phases: bool = True


def by_count(*counts: tuple[str, int]) -> Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]:
    """Orders for the given number of tasks of each kind per house, the kinds spread evenly over the list."""

    def orders(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
        shelves: list[tuple[float, int, TaskOrder]] = []
        shift = (seeds.draw(spec.root, house.id, "shift") - 0.5) / max(count for _, count in counts)
        for rank, (name, count) in enumerate(counts):
            kind: TaskKind = plugins.load("task kind", name)
            goals = _goals(kind, house, count, seeds.derive(spec.root, house.id, name))
            levels = seeds.shuffled(count, spec.root, house.id, name, "levels")
            for number, goal in enumerate(goals):
                task = f"{spec.name}/{house.id}/{kind.short}-{number + 1:02d}"
                order = TaskOrder(name=task, kind=name, share=(levels[number] + 0.5) / count, goal=goal)
                shelves.append(((number + 0.5) / count + rank * shift, rank, order))
        return [order for _, _, order in sorted(shelves, key=lambda shelf: shelf[:2])]

    return orders


def by_kind(kind: str, count: int, stem: str = "") -> Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]:
    """Orders for ``count`` tasks per house, of a kind that draws goals and arrangements itself.

    Their names begin with ``stem``, by default with the suite's name. Tasks with the same name and root are the same.
    """

    def orders(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
        names = [f"{stem or spec.name}/{house.id}/{number + 1:02d}" for number in range(count)]
        return [TaskOrder(name=name, kind=kind, share=seeds.draw(spec.root, name, "share")) for name in names]

    return orders


def by_target(kind: str, *targets: str) -> Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]:
    """Orders for one task per house and target, of a kind whose goals depend on the house alone."""

    def orders(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
        made: TaskKind = plugins.load("task kind", kind)
        found = []
        for number, target in enumerate(targets, 1):
            name = f"{spec.name}/{house.id}/{number:02d}"
            goals = [goal for goal in made.goals(house) if goal.target == target]
            if not goals:
                raise HthorError(f"house '{house.id}' has nothing for a task of kind '{kind}' for '{target}'")
            goal = goals[seeds.choice([1.0] * len(goals), spec.root, name, "goal")]
            share = seeds.draw(spec.root, name, "share")
            found.append(TaskOrder(name=name, kind=kind, share=share, goal=goal))
        return found

    return orders


def by_level(kind: str, *hands: tuple[tuple[Level, float], ...]) -> Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]:
    """A house's tasks of one kind, each with a given stratum of difficulty, in an order drawn for the house.

    Args:
        hands: strata and shares (as `TaskOrder.share`) of a house's tasks; houses use them in turn.
    """

    def orders(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
        made: TaskKind = plugins.load("task kind", kind)
        hand = hands[spec.houses.index(house.id) % len(hands)]
        goals = _goals(made, house, len(hand), seeds.derive(spec.root, house.id, kind))
        rows = [hand[place] for place in seeds.shuffled(len(hand), spec.root, house.id, "levels")]
        stem = f"{spec.name}/{house.id}/{made.short}"
        return [
            TaskOrder(name=f"{stem}-{number:02d}", kind=kind, share=share, goal=goal, level=row)
            for number, (goal, (row, share)) in enumerate(zip(goals, rows, strict=True), 1)
        ]

    return orders


def together(
    *parts: Callable[[SuiteSpec, HouseSpec], list[TaskOrder]],
) -> Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]:
    """The orders of several functions for each house, one after the other."""

    def orders(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
        return [order for part in parts for order in part(spec, house)]

    return orders


def errands(share: float, destination: str) -> Callable[[SuiteSpec, HouseSpec], list[TaskOrder]]:
    """Orders for one search and one delivery to the ``destination`` per house; ``share`` as in `TaskOrder`."""

    def orders(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
        found = []
        for name in (FIND, MOVE):
            kind: TaskKind = plugins.load("task kind", name)
            goals = [goal for goal in kind.goals(house) if goal.destination in ("", destination)]
            if not goals:
                raise HthorError(f"house '{house.id}' has nothing for a task of kind '{name}' for '{destination}'")
            task = f"{spec.name}/{house.id}/{kind.short}"
            goal = goals[seeds.choice([1.0] * len(goals), spec.root, task, "goal")]
            found.append(TaskOrder(name=task, kind=name, share=share, goal=goal))
        return found

    return orders


def each_triplet(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
    """A search for each target with each triplet that is possible in the house."""
    kinds = scene_graph.kinds_present(house)
    return [
        _exact(spec, house, FIND, Goal(target=target, relation="find"), row, scene_graph.triplet_words(row))
        for target in catalog.TARGETS
        for row in scene_graph.applicable_triplets(target, kinds)
    ]


def each_template(spec: SuiteSpec, house: HouseSpec) -> list[TaskOrder]:
    """Each task template with each possible place of its target, except its destination."""
    kind: TaskKind = plugins.load("task kind", MOVE)
    kinds = scene_graph.kinds_present(house)
    return [
        _exact(spec, house, kind.name, goal, row, f"{goal.target}-to-{goal.destination}/{row.relation}-{row.reference}")
        for goal in kind.goals(house)
        for row in scene_graph.applicable_triplets(goal.target, kinds)
        if (row.relation, row.reference) != (goal.relation, goal.destination)
    ]


def _exact(spec: SuiteSpec, house: HouseSpec, kind: str, goal: Goal, row: Triplet, words: str) -> TaskOrder:
    name = f"{spec.name}/{house.id}/{words}"
    return TaskOrder(name=name, kind=kind, share=seeds.draw(spec.root, name, "share"), goal=goal, fixed=row)


def _goals(kind: TaskKind, house: HouseSpec, count: int, root: int) -> list[Goal]:
    """``count`` goals in random order: each of the kind's goals once before any is repeated."""
    known = kind.goals(house)
    if not known:
        raise HthorError(f"house '{house.id}' has nothing for a task of kind '{kind.name}'")
    order: list[Goal] = []
    for lap in range(math.ceil(count / len(known))):
        order += [known[index] for index in seeds.shuffled(len(known), root, "goals", lap)]
    return order[:count]


_EASY: tuple[tuple[Level, float], ...] = (("easy", 0.05), ("easy", 0.15))
SUITE_SPECS = {
    spec.name: spec
    for spec in (
        SuiteSpec(
            name="smoke",
            version=4,
            root=20240608,
            houses=SCENES,
            orders=by_count((FIND, 2), (MOVE, 4)),
            robots=2,
            candidates=6,
            serial=True,
            record_difficulty=False,
        ),
        SuiteSpec(
            name="paper",
            version=2,
            root=20240611,
            houses=SCENES,
            orders=by_level(MOVE, (*_EASY, ("medium", 0.25)), (*_EASY, ("hard", 0.6))),
            candidates=6,
        ),
        SuiteSpec(
            name="navigation",
            version=2,
            root=20240609,
            houses=SCENES,
            orders=each_triplet,
            redrawn=(
                ("navigation/elder/remote_control-on-sofa", 1),
                ("navigation/hazel/book-on-sofa", 1),
                ("navigation/juniper/remote_control-on-sofa", 1),
            ),
        ),
        SuiteSpec(
            name="manipulation",
            version=2,
            root=20240610,
            houses=SCENES,
            orders=each_template,
            redrawn=(("manipulation/birch/tomato-to-fridge/near-apple", 1),),
        ),
        SuiteSpec(name="collect", version=2, root=20240612, houses=SCENES, orders=by_kind("multi_robot_collection", 2)),
        SuiteSpec(name="rearrange", version=2, root=20240613, houses=SCENES, orders=by_kind("room_rearrangement", 2)),
        SuiteSpec(
            name="rearrange-record",
            version=1,
            root=20240613,
            houses=SCENES,
            orders=by_kind("room_rearrangement", 2, stem="rearrange"),
            phases=False,
        ),
        SuiteSpec(name="tidy", version=2, root=20240614, houses=SCENES, orders=by_kind("tidying_up", 2)),
        SuiteSpec(name="carry", version=2, root=20240615, houses=SCENES, orders=by_kind("collaborative_carrying", 2)),
        SuiteSpec(
            name="vln",
            version=1,
            root=20240616,
            houses=SCENES,
            orders=by_target(WALK, *WALKERS),
        ),
        SuiteSpec(
            name="calibration",
            version=1,
            root=20240617,
            houses=("alder", "hazel", "juniper"),
            orders=together(by_target(WALK, "person_1"), errands(0.2, "fridge")),
            candidates=4,
        ),
    )
}
"""The suites that this package makes, by name."""
