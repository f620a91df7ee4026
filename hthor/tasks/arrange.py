"""Spreading the six targets over a house as the scene priors say; knows nothing of goals, starts or files."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from hthor import catalog, seeds
from hthor.catalog import priors
from hthor.errors import HthorError
from hthor.tasks.ground import Ground
from hthor.tasks.placing import Rest, Shelves, gap_to, placed
from hthor.types import HouseSpec, Placement, Thing, Vec2

NEAR_M = 1.0
"""Two things are near each other within this distance on the plan."""
_TRIES = 60


def arrange(house: HouseSpec, root: int, bans: dict[str, str] | None = None) -> tuple[Placement, ...]:
    """A placement for each target, in the catalogue's order.

    Each target's triplet is drawn by weight among those whose reference the house has, then a pose that rests exactly
    on a surface, touches nothing, and can be reached and seen by the person's avatar, the fridge's door being open.
    Triplets that no pose was found for are dropped.

    Args:
        house: the floor plan.
        root: of all draws.
        bans: for a target, the kind of thing that it must not rest on or in.

    Raises:
        HthorError: when a target fits nowhere.
    """
    done: list[Placement] = []
    for number in seeds.shuffled(len(catalog.TARGETS), root, "order"):
        target = catalog.TARGETS[number]
        done.append(_place(house, target, seeds.derive(root, target), (bans or {}).get(target, ""), done))
    return tuple(sorted(done, key=lambda placement: catalog.TARGETS.index(placement.id)))


def _place(house: HouseSpec, target: str, root: int, ban: str, done: Sequence[Placement]) -> Placement:
    weights = {triplet: weight for triplet, weight in priors.weights(target).items() if weight > 0.0}
    while weights:
        triplets = list(weights)
        triplet = triplets[seeds.choice(list(weights.values()), root, "triplet", len(weights))]
        for rest, reference, attempt in _rests(house, root, *triplet, ban, done):
            u, v, turn = (2 * seeds.draw(root, *triplet, axis, attempt) - 1 for axis in ("u", "v", "yaw"))
            placement = placed(target, rest, u, v, math.pi * turn)
            if _suits(house, placement, rest, reference, done):
                return placement
        del weights[triplet]
    raise HthorError(f"house '{house.id}' has no place for the {target}: it needs a free surface within reach")


def _rests(
    house: HouseSpec, root: int, relation: str, reference: str, ban: str, done: Sequence[Placement]
) -> Iterator[tuple[Rest, Thing | Placement | None, int]]:
    """Surfaces to try, large ones more often, each with what the object must be near to, and the attempt's number."""
    rests = [rest for rest in Shelves.of(house).rests if rest.thing.kind != ban]
    if relation == "near":
        marks: list[Thing | Placement] = [thing for thing in house.things if thing.kind == reference]
        marks += [placement for placement in done if placement.kind == reference]
        pairs: list[tuple[Rest, Thing | Placement | None]] = [
            (rest, mark) for mark in marks for rest in rests if rest.thing.id != mark.id and _may_be_near(rest, mark)
        ]
        pairs = [(rest, mark) for rest, mark in pairs if not rest.surface.inside]
    else:
        pairs = [(rest, None) for rest in rests if rest.thing.kind == reference]
    areas = [rest.surface.half[0] * rest.surface.half[1] for rest, _ in pairs]
    for attempt in range(_TRIES if pairs else 0):
        yield (*pairs[seeds.choice(areas, root, relation, reference, "rest", attempt)], attempt)


def _suits(
    house: HouseSpec, placement: Placement, rest: Rest, mark: Thing | Placement | None, done: Sequence[Placement]
) -> bool:
    place = (placement.position[0], placement.position[1])
    if mark is not None and _distance(place, mark) > NEAR_M:
        return False
    if not Shelves.of(house).fits(rest, placement, done):
        return False
    ground = Ground.of(house)
    opened = frozenset({rest.thing.id}) if rest.surface.inside else frozenset[str]()
    floor = ground.space.component(*ground.space.nearest_free(house.start.x, house.start.y))
    return bool((ground.seeing(placement, opened) & ground.touching(placement) & floor).any())


def _distance(place: Vec2, mark: Thing | Placement) -> float:
    if isinstance(mark, Thing):
        return gap_to(place, mark)
    return math.hypot(place[0] - mark.position[0], place[1] - mark.position[1])


def _may_be_near(rest: Rest, mark: Thing | Placement) -> bool:
    x, y, _ = rest.centre
    return _distance((x, y), mark) <= NEAR_M + math.hypot(*rest.surface.half)
