"""Scene graphs: for each target, the relation of the priors that decides its place, drawn by weight."""

from collections.abc import Iterator, Mapping, Sequence, Set
from functools import cache
from typing import NamedTuple

from hthor import catalog, seeds
from hthor.catalog import priors
from hthor.catalog.priors import Triplet
from hthor.types import HouseSpec, Placement

CODE_PART = "tools"


def kinds_present(house: HouseSpec) -> frozenset[str]:
    """Kinds that a triplet may refer to in a house: those of its things, and the targets that every task brings."""
    return frozenset(thing.kind for thing in house.things) | frozenset(catalog.TARGETS)


def applicable_triplets(target: str, kinds: Set[str]) -> tuple[Triplet, ...]:
    """The triplets of a target whose reference is among ``kinds``, in the table's order.

    Raises:
        UnknownName: when ``target`` is not one of the six.
    """
    return tuple(row for row in _rows(target).values() if row.reference in kinds)


def draw_triplet(target: str, kinds: Set[str], root: int) -> Triplet:
    """One triplet of a target, drawn by weight from the triplets whose reference is among ``kinds``.

    Raises:
        UnknownName: when ``target`` is not one of the six.
        ValueError: when no reference of the target is among ``kinds``.
    """
    first = next(triplets_in_random_order(target, kinds, root), None)
    if first is None:
        raise ValueError(f"no reference object for '{target}' is among {sorted(kinds)}")
    return first


def triplets_in_random_order(target: str, kinds: Set[str], root: int) -> Iterator[Triplet]:
    """The triplets of a target, drawn by weight without replacement: the first is the sample, the others fallbacks."""
    rows, weights = _rows(target), {edge: weight for edge, weight in priors.weights(target).items() if weight > 0.0}
    while weights:
        edges = list(weights)
        edge = edges[seeds.choice(list(weights.values()), root, "triplet", len(weights))]
        if edge[1] in kinds:
            yield rows[edge]
        del weights[edge]


def sample_graph(kinds: Set[str], root: int, fixed: Triplet | None = None) -> dict[str, Triplet]:
    """A scene graph: a triplet for each target, drawn by weight; ``fixed`` replaces that of its target."""
    graph = {target: draw_triplet(target, kinds, seeds.derive(root, target)) for target in catalog.TARGETS}
    return graph if fixed is None else {**graph, fixed.target: fixed}


def placement_order(graph: Mapping[str, Triplet], root: int) -> list[str]:
    """The targets in random order, but each after the target that it has to be near, if the graph allows that.

    In a ring of targets that have to be near one another, the last target has to be near both its neighbours.
    """
    left = [catalog.TARGETS[number] for number in seeds.shuffled(len(catalog.TARGETS), root, "order")]
    done: list[str] = []
    while left:
        ready = (target for target in left if _waits_for(graph[target]) not in left)
        done.append(next(ready, None) or _ring(graph, left)[0])
        left.remove(done[-1])
    return done


def find_triplet(target: str, relation: str, reference: str) -> Triplet:
    """The row of the priors' table.

    Raises:
        KeyError: when the table has no such row. UnknownName: when ``target`` is not one of the six.
    """
    return _rows(target)[relation, reference]


class Relation(NamedTuple):
    """The relation of an object in a task: to a kind of thing or object, and the kind of thing that supports it."""

    relation: str
    reference: str
    support: str


def read_graph(objects: Sequence[Placement], house: HouseSpec) -> dict[str, Relation]:
    """The scene graph that placements record, by the objects' ids.

    An object that was placed near something has that relation; any other has the relation to its support.
    """
    kinds = {thing.id: thing.kind for thing in house.things} | {placed.id: placed.kind for placed in objects}
    return {placed.id: _relation(placed, kinds) for placed in objects}


def _relation(placed: Placement, kinds: Mapping[str, str]) -> Relation:
    support = kinds.get(placed.support, placed.support or "floor")
    if placed.near:
        return Relation("near", kinds.get(placed.near, placed.near), support)
    return Relation(placed.relation, support, support)


def triplet_words(row: Triplet) -> str:
    """A triplet as part of a task's id, such as ``apple-in-fridge``."""
    return f"{row.target}-{row.relation}-{row.reference}"


def _waits_for(row: Triplet) -> str:
    return row.reference if row.relation == "near" else ""


def _ring(graph: Mapping[str, Triplet], left: list[str]) -> list[str]:
    """Targets that wait for one another in a cycle; every target in ``left`` waits for another one in ``left``."""
    seen = [left[0]]
    while (following := _waits_for(graph[seen[-1]])) not in seen:
        seen.append(following)
    return [target for target in left if target in seen[seen.index(following) :]]


@cache
def _rows(target: str) -> dict[tuple[str, str], Triplet]:
    priors.weights(target)  # raises when there is no such target
    return {(row.relation, row.reference): row for row in priors.triplets() if row.target == target}
